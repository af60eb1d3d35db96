//! A face of a lens in the plane of a wall or of a roof.

use glam::{DQuat, DVec3, Vec3};

use crate::{
    geom::Shape,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{block, numbered, of_solids},
        looks::{bit, column_row, lens, orthographic, picture, scene, view},
    },
    render::picture::{RenderError, Studio},
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "coplanar lens faces",
    case: "9",
    property: "a wall or a roof in the plane of a lens's face is in the lens, whichever side the lens is on, and stays so while \
               the camera jitters",
    oracle: "the known plane, and the face's outline in it, in f64",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [120, 90];
/// Half the sides of the boxes' faces, and the radius of the cylinders', metres.
const HALF: [f64; 2] = [2.5, 1.7];
const RADIUS: f64 = 2.2;

/// A face of the cube from 0 to 10 m: a point of it, its normal, and two directions in it.
struct Face {
    at: DVec3,
    normal: DVec3,
    along: [DVec3; 2],
}

impl Face {
    /// A box and a cylinder that stand on it, outside the cube (`side` 1) or inside it (-1).
    fn shapes(&self, side: f64) -> [Shape; 2] {
        let axis = side * self.normal;
        let [u, v] = self.along;
        let center = self.at + 1.5 * axis;
        let rotation = DQuat::from_mat3(&glam::DMat3::from_cols(u, v, u.cross(v)));
        let size = DVec3::new(2.0 * HALF[0], 2.0 * HALF[1], 3.0);
        [Shape::Box { center, size, rotation }, Shape::Cylinder { center, radius: RADIUS, height: 3.0, axis }]
    }
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = of_solids(DVec3::ZERO, &numbered([block([0, 0, 0], [10_000, 10_000, 10_000])]))?;
    let faces = [
        Face { at: DVec3::new(0.0, 5.0, 5.0), normal: -DVec3::X, along: [DVec3::Y, DVec3::Z] },
        Face { at: DVec3::new(5.0, 5.0, 10.0), normal: DVec3::Z, along: [DVec3::X, DVec3::Y] },
    ];
    for face in faces {
        let [u, v] = face.along;
        let from = |slant: f64, away: f64| face.at + away * (face.normal + slant * (u + 0.6 * v));
        let cameras = [
            Camera::looking(from(0.0, 9.0), face.at, 0.8),
            // Nearly along the wall, and from three kilometres away.
            Camera::looking(from(9.0, 1.5), face.at, 0.5),
            Camera::looking(from(0.4, 3000.0), face.at, 0.003),
            orthographic(from(0.5, 40.0), face.at, 9.0),
        ];
        for camera in cameras {
            for side in [1.0, -1.0] {
                ask_face(found, &mut studio, &face, camera, side)?;
            }
            if !found.goes_on() {
                return Ok(());
            }
        }
    }
    Ok(())
}

fn ask_face(
    found: &mut Findings,
    studio: &mut Studio,
    face: &Face,
    camera: Camera,
    side: f64,
) -> Result<(), RenderError> {
    let [u, v] = face.along;
    let lenses: Vec<_> = face.shapes(side).map(|shape| lens("face", shape, "sepia")).into();
    let still = view(camera, SIZE)?;
    let pixel = still.pixel_m(still.depth(face.at));
    for frame in 0..4 {
        // Additive recurrences: no two frames see the plane from the same place.
        let step = |by: f64| (f64::from(frame) * by).fract() - 0.5;
        let jitter = pixel * (step(0.754_878) * u + step(0.569_840) * v + step(0.618_034) * face.normal);
        let camera = Camera { eye: camera.eye + jitter, target: camera.target + jitter, ..camera };
        let drawn = picture(studio, &scene(camera, lenses.clone()), SIZE)?;
        let view = view(camera, SIZE)?;
        for (i, normal) in drawn.normal.iter().flatten().enumerate() {
            if Vec3::from(*normal).as_dvec3().dot(face.normal) <= 0.99 {
                continue;
            }
            let [x, y] = column_row(SIZE, i);
            let ray = view.pixel_ray(x, y);
            let t = (face.at - ray.origin).dot(face.normal) / ray.direction.dot(face.normal);
            let p = ray.at(t) - face.at;
            let (a, b) = (p.dot(u), p.dot(v));
            // As far as the rounding of D and the adapter's grid move a place along the wall.
            let slant = ray.direction.length() / ray.direction.dot(face.normal).abs();
            let rim =
                8.0 * 2_f64.powi(-23) * t * ray.direction.length() * 2.0 + found.snapping * view.pixel_m(t) * slant;
            let outside_by = [(a.abs() - HALF[0]).max(b.abs() - HALF[1]), a.hypot(b) - RADIUS];
            for (number, outside_by) in outside_by.into_iter().enumerate().filter(|(_, by)| by.abs() > rim) {
                found.ask(bit(&drawn, number, i) == (outside_by < 0.0), || {
                    format!("lens {number}, side {side}, from {}, pixel {x},{y}: {outside_by} m outside", camera.eye)
                });
            }
        }
    }
    Ok(())
}
