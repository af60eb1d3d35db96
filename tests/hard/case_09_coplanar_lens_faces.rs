//! Case 9: a face of a lens in the plane of a facade, a roof or the ground. The rule: a body is closed, its border belongs to
//! it, whichever side the body is on, and so it stays when the camera moves by less than a pixel. Oracle: the facade's plane
//! is known, and where the lens's face is on it.

use glam::{DQuat, DVec3};
use veduta::{geom::Shape, view::Camera};

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
                            // The rim: as far as the rounding of D moves a place along the wall.
                            let rim = 8.0 * 2_f64.powi(-23) * t * ray.direction.length() * 2.0;
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
