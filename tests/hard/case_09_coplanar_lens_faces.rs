//! Case 9: a face of a lens in the plane of a facade, a roof or the ground. The rule: a body is closed, its border belongs to
//! it, whichever side the body is on, and so it stays when the camera moves by less than a pixel. Oracle: the facade's plane
//! is known, and where the lens's face is on it.

use std::{f64::consts::PI, sync::Arc};

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::{Shape, shape::FlatFigure},
    gpu::Gpu,
    render::{
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::CitySpec,
    view::Camera,
};

use crate::{lenses::view, studio};

const SIZE: [u32; 2] = [120, 90];

/// A face of the cube from 0 to 10 m: a point of it, its normal, and two directions in it.
struct Face {
    at: DVec3,
    normal: DVec3,
    along: [DVec3; 2],
}

fn faces() -> [Face; 3] {
    let face = |at, normal, u, v| Face { at, normal, along: [u, v] };
    [
        face(DVec3::new(0.0, 5.0, 5.0), -DVec3::X, DVec3::Y, DVec3::Z),
        face(DVec3::new(5.0, 0.0, 5.0), -DVec3::Y, DVec3::X, DVec3::Z),
        face(DVec3::new(5.0, 5.0, 10.0), DVec3::Z, DVec3::X, DVec3::Y),
    ]
}

/// Whether a place on the face, so far along both directions, is in the lens; and how far it is from where that changes.
type Part = Box<dyn Fn(f64, f64) -> f64>;

/// Shapes with a face on this one: outside the cube (`side` 1) or inside it (-1); and the signed distance of places on the
/// face to the part that the lens has of it.
fn shapes(face: &Face, side: f64) -> Vec<(&'static str, Shape, Part)> {
    let out = side * face.normal;
    let [u, v] = face.along;
    let depth = 3.0;
    let middle = face.at + 0.5 * depth * out;
    let rectangle = |a: f64, b: f64| -> Part { Box::new(move |x: f64, y: f64| (x.abs() - a).max(y.abs() - b)) };
    let disc = |r: f64| -> Part { Box::new(move |x: f64, y: f64| x.hypot(y) - r) };
    let corner = |i: i32| {
        let sign = |bit: i32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        face.at + sign(0) * 2.5 * u + sign(1) * 1.7 * v + if i >> 2 == 0 { DVec3::ZERO } else { depth * out }
    };
    let plane = |normal: DVec3, through: DVec3| [normal.x, normal.y, normal.z, normal.dot(through)];
    let rotation = DQuat::from_mat3(&glam::DMat3::from_cols(u, v, u.cross(v)));
    let mut list = vec![
        ("box", Shape::Box { center: middle, size: DVec3::new(5.0, 3.4, depth), rotation }, rectangle(2.5, 1.7)),
        ("cylinder", Shape::Cylinder { center: middle, radius: 2.2, height: depth, axis: out }, disc(2.2)),
        (
            "frustum",
            Shape::Frustum { center: middle, radius: 2.4, top_radius: 1.0, height: depth, axis: out },
            disc(2.4),
        ),
        ("cone", Shape::Frustum { center: middle, radius: 2.4, top_radius: 0.0, height: depth, axis: out }, disc(2.4)),
        ("convex", Shape::Convex { points: (0..8).map(corner).collect() }, rectangle(2.5, 1.7)),
        (
            "polytope",
            Shape::Polytope {
                planes: vec![
                    plane(-3.0 * out, face.at),
                    plane(0.2 * out, face.at + depth * out),
                    plane(u, face.at + 2.5 * u),
                    plane(-u, face.at - 2.5 * u),
                    plane(v, face.at + 1.7 * v),
                    plane(-v, face.at - 1.7 * v),
                ],
            },
            rectangle(2.5, 1.7),
        ),
    ];
    // What is seen through a figure begins at its plane, whichever way that faces.
    let half = DVec2::new(2.5, 1.7);
    for (name, figure, part) in [
        ("disc", FlatFigure::Disc { radius: 2.2 }, disc(2.2)),
        ("rectangle", FlatFigure::Rectangle { size: 2.0 * half }, rectangle(2.5, 1.7)),
        (
            "polygon",
            FlatFigure::Polygon {
                points: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| half * DVec2::from(c)).to_vec(),
            },
            rectangle(2.5, 1.7),
        ),
    ] {
        let rotation = if side > 0.0 { rotation } else { rotation * DQuat::from_rotation_x(PI) };
        list.push((name, Shape::Flat { center: face.at, rotation, figure }, part));
    }
    if face.normal == DVec3::Z {
        // Level, its top or its bottom on the roof; round at its ends.
        let points = vec![middle - 2.0 * u, middle + 2.0 * u];
        let part: Part = Box::new(|x: f64, y: f64| (x.abs() - 2.0).max(0.0).hypot(y) - 1.0);
        list.push(("corridor", Shape::Corridor { points, width: 2.0, height: depth }, part));
    }
    list
}

#[test]
fn a_face_in_the_plane_of_a_wall_or_a_roof_holds_it_in_every_frame() {
    let mut studio = studio::studio(&[studio::citydata("cube.city.json")]);
    let (mut on_face, mut beside) = (0, 0);
    for face in faces() {
        let [u, v] = face.along;
        let from = |slant: f64, away: f64| face.at + away * (face.normal + slant * (u + 0.6 * v));
        let cameras = [
            Camera::looking(from(0.0, 9.0), face.at, 0.8),
            Camera::looking(from(0.7, 20.0), face.at + 0.3 * u, 0.4),
            // Nearly along the wall, and from half a kilometre and three away.
            Camera::looking(from(9.0, 1.5), face.at, 0.5),
            Camera::looking(from(1.0, 500.0), face.at, 0.015),
            Camera::looking(from(0.4, 3000.0), face.at, 0.003),
            studio::orthographic(from(0.5, 40.0), face.at, 9.0),
        ];
        for camera in cameras {
            for side in [1.0, -1.0] {
                let (names, rest): (Vec<_>, Vec<_>) =
                    shapes(&face, side).into_iter().map(|(n, s, p)| (n, (s, p))).unzip();
                let (shapes, parts): (Vec<Shape>, Vec<Part>) = rest.into_iter().unzip();
                let lenses = names.iter().zip(shapes).map(|(n, s)| studio::lens(n, vec![s], "sepia")).collect();
                let mut scene = studio::scene(camera, lenses);
                for frame in 0..12 {
                    // Additive recurrences: no two frames see the plane from the same place.
                    let step = |by: f64| (f64::from(frame) * by).fract() - 0.5;
                    let still = view(camera, SIZE);
                    let pixel = still.pixel_m(still.depth(face.at));
                    let jitter = pixel * (step(0.754_878) * u + step(0.569_840) * v + step(0.618_034) * face.normal);
                    let camera = Camera { eye: camera.eye + jitter, target: camera.target + jitter, ..camera };
                    scene.camera = Some(camera);
                    let drawn = studio::picture(&mut studio, &scene, SIZE);
                    let view = view(camera, SIZE);
                    let normals = drawn.normal.as_ref().expect("normals");
                    let is_on = |i: usize| glam::Vec3::from(normals[i]).as_dvec3().dot(face.normal) > 0.99;
                    for (k, (name, part)) in names.iter().zip(&parts).enumerate() {
                        let bits = studio::bits(&drawn, k);
                        for i in (0..bits.len()).filter(|i| is_on(*i)) {
                            let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
                            let t = (face.at - ray.origin).dot(face.normal) / ray.direction.dot(face.normal);
                            let p = ray.at(t) - face.at;
                            let outside_by = part(p.dot(u), p.dot(v));
                            // The rim: as far as the rounding of D and the adapter's grid move a place along the wall.
                            let slant = ray.direction.length() / ray.direction.dot(face.normal).abs();
                            let rim = 8.0 * 2_f64.powi(-23) * t * ray.direction.length() * 2.0
                                + studio::off_face(&view, t) * slant;
                            if outside_by.abs() > rim {
                                let expected = outside_by < 0.0;
                                on_face += u64::from(expected);
                                beside += u64::from(!expected);
                                assert_eq!(
                                    bits[i], expected,
                                    "{name}, side {side} of {}, from {}, frame {frame}, pixel {i}: {outside_by} m",
                                    face.normal, camera.eye
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(on_face > 1_000_000 && beside > 1_000_000, "{on_face} on the face, {beside} beside it");
}

#[test]
fn a_face_holds_what_a_rasterisers_grid_puts_before_it_and_no_more() {
    let face = &faces()[2];
    let cameras = [
        Camera::looking(face.at + DVec3::new(2.0, -3.0, 20.0), face.at, 0.8),
        studio::orthographic(face.at + DVec3::new(9.0, 4.0, 30.0), face.at, 14.0),
    ];
    // Corners that an adapter draws up to half a pixel from their places.
    let snapping = 0.5;
    let mut gpu = Gpu::open().unwrap();
    gpu.snapping = snapping;
    let plain = studio::studio(&[studio::citydata("cube.city.json")]);
    let mut coarse =
        Studio::new(gpu, Arc::clone(&plain.model), &CitySpec { ground: false, ..CitySpec::default() }).unwrap();
    for camera in cameras {
        let still = view(camera, SIZE);
        let pixel = still.pixel_m(still.depth(face.at));
        for (share, expected) in [(0.7, true), (1.3, false)] {
            // Lenses whose faces are under the roof, or whose planes are behind it, by so much.
            let below =
                Face { at: face.at - share * snapping * pixel * face.normal, normal: face.normal, along: face.along };
            let (names, rest): (Vec<_>, Vec<_>) = shapes(&below, -1.0).into_iter().map(|(n, s, p)| (n, (s, p))).unzip();
            let (shapes, parts): (Vec<Shape>, Vec<Part>) = rest.into_iter().unzip();
            let lenses = names.iter().zip(shapes).map(|(n, s)| studio::lens(n, vec![s], "sepia")).collect();
            let scene = studio::scene(camera, lenses);
            for backend in [Backend::Specialised, Backend::Uber] {
                let request = Request { aovs: studio::ALL, backend, ..Request::plain(SIZE) };
                let drawn = coarse.render(&scene, &request).expect("a picture");
                let normals = drawn.normal.as_ref().expect("normals");
                for (k, (name, part)) in names.iter().zip(&parts).enumerate() {
                    let bits = studio::bits(&drawn, k);
                    let mut asked = 0;
                    for i in (0..bits.len()).filter(|i| normals[*i][2] > 0.99) {
                        let ray = still.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
                        let t = (face.at - ray.origin).dot(face.normal) / ray.direction.dot(face.normal);
                        let p = ray.at(t) - face.at;
                        // Well inside the part: at its rim the grid would move it along the face, too.
                        if part(p.dot(face.along[0]), p.dot(face.along[1])) < -2.0 * pixel {
                            asked += 1;
                            assert_eq!(bits[i], expected, "{name} {share} of the grid below, {backend:?}, pixel {i}");
                        }
                    }
                    assert!(asked > 50, "{name}: {asked} pixels");
                }
            }
        }
    }
}
