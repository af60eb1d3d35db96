//! Case 21, deformations of what is large: a small lens in the middle of a triangle of 10 km, over its edge, over its corner, and with its
//! border through it. Property: the lens is found, and shown where it is, at every pixel. Oracle: the height in closed form.

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    lens::deform::{ControlProfile, Step},
    view::Camera,
};

use crate::{
    bodies::{ORIGIN, studio_of},
    deformed::{Bent, Pixels, distances, drawn, patch},
    lenses::view,
    studio,
};

const SIZE: [u32; 2] = [240, 180];
/// How far what is shown may be from where it should be, pixels: edges a quarter, what is between them twice that.
const OFF_PX: f64 = 0.75;

/// Half of a side of the terrain, millimetres.
const HALF: i64 = 5_000_000;

/// Height of the ground over its plane where a lens of this size has its middle, and how steep it is at most.
fn height(control: &ControlProfile, size: DVec2, rise: f64, at: DVec2) -> (f64, f64) {
    let unit = 2.0 * at / size;
    match control {
        ControlProfile::Bump => {
            let rest = (1.0 - unit.length_squared()).max(0.0);
            (rise * rest * rest, rise.abs() * 1.54 / (0.5 * size.min_element()))
        }
        ControlProfile::Linear { border } => {
            let part = |u: f64| (0.5 * (1.0 - u.abs()) / border).clamp(0.0, 1.0);
            (rise * part(unit.x) * part(unit.y), 1.42 * rise.abs() / (border * size.min_element()))
        }
        _ => unreachable!("a bump or a plateau"),
    }
}

#[test]
fn a_small_lens_on_a_large_triangle_is_shown_right() {
    // Two triangles with a diagonal between them.
    let ring = |corners: [[i64; 2]; 3]| corners.map(|[x, y]| [x * HALF, y * HALF, 0]).to_vec();
    let mut studio = studio_of(&[vec![ring([[-1, -1], [1, -1], [1, 1]]), ring([[-1, -1], [1, 1], [-1, 1]])]]);
    let bump = ControlProfile::Bump;
    let plateau = ControlProfile::Linear { border: 0.05 };
    // In the middle of a triangle, beside the middle, over the diagonal, over a corner of both; of 20 m, and of one.
    let places = [
        (DVec2::new(1234.5, -2345.6), &bump, DVec2::new(20.0, 20.0), 9.0),
        (DVec2::new(-1666.0, 1666.0), &bump, DVec2::new(1.0, 1.0), 0.5),
        (DVec2::new(101.0, 103.0), &bump, DVec2::new(20.0, 14.0), 6.0),
        (DVec2::new(4999.0, 4998.0), &bump, DVec2::new(20.0, 20.0), 9.0),
        (DVec2::new(3000.3, 1.7), &plateau, DVec2::new(20.0, 16.0), 4.0),
        (DVec2::new(-700.0, -705.0), &plateau, DVec2::new(30.0, 30.0), -5.0),
    ];
    let mut raised = 0;
    for (i, (at, control, size, rise)) in places.into_iter().enumerate() {
        let base = ORIGIN + at.extend(0.0);
        let rotation = DQuat::from_rotation_z(0.5 * i as f64);
        let steps = vec![Step::Translate { by: DVec3::Z * rise }];
        let lens =
            Bent { center: base + DVec3::Z * 5.0, size: size.extend(10.0), rotation, steps, control: control.clone() };
        let reach = size.max_element();
        let (from, from_far) = (DVec3::new(0.6, -1.1, 0.9) * reach, DVec3::new(-7.0, 40.0, 25.0) * reach);
        for (way, fov) in [(from, 0.9), (from_far, 0.03), (DVec3::new(0.0, -0.01, 1.6) * reach, 0.9)] {
            let camera = Camera::looking(base + way, base + DVec3::Z * 0.3 * rise, fov);
            let view = view(camera, SIZE);
            let picture = drawn(&mut studio, &studio::scene(camera, vec![lens.lens("hill")]), SIZE);
            let what = format!("{at}, {control:?} from {way}");
            let deformed = picture.statistics.frame.deformed.expect("something is deformed");
            assert!(deformed.met >= 1 && deformed.triangles < 200_000, "{what}: {deformed:?}");
            let depths = distances(&picture);
            let mut own = 0;
            for (p, d) in depths.iter().enumerate().filter(|(_, d)| d.is_finite()) {
                let ray = view.pixel_ray(p as u32 % SIZE[0], p as u32 / SIZE[0]);
                let shown = ray.at(f64::from(*d)) - base;
                let rest = rotation.inverse() * shown;
                let (expected, slope) = height(control, size, rise, rest.truncate());
                // A shift aside of a pixel is one of the height by the slope.
                let off = OFF_PX
                    * view.pixel_m(f64::from(*d))
                    * (1.0 + if expected == 0.0 && shown.z.abs() < 1e-3 { 0.0 } else { slope });
                assert!((shown.z - expected).abs() < off + 2e-3, "{what}: pixel {p}: {} for {expected}", shown.z);
                own += u32::from(expected.abs() > 0.2 * rise.abs());
            }
            assert!(own > 500, "{what}: {own} pixels of the hill");
            raised += own;
            // All of the hill that is on the terrain is there: no hole in it.
            let mut hills = [-1.0, 0.0, 1.0].map(|px| (px, Pixels::new(SIZE)));
            let (u, v) = (rotation * DVec3::X * size.x, rotation * DVec3::Y * size.y);
            let is_terrain = |face: &[DVec3; 3]| {
                let far = |p: DVec3| (p - ORIGIN).abs().max_element();
                face.iter().all(|p| far(*p) < 0.001 * HALF as f64 - 0.5)
            };
            for face in patch(base - 0.5 * (u + v), u, v, [200, 200]).iter().filter(|face| is_terrain(face)) {
                // Where it is seen edge on it may be a pixel higher or lower.
                for (px, hill) in &mut hills {
                    let shifted = |p: DVec3| lens.value(p) + DVec3::Z * (*px * view.pixel_m(view.depth(lens.value(p))));
                    hill.add(&view, face.map(shifted), 0.0);
                }
            }
            let is_hill = |p: usize| hills.iter().all(|(_, hill)| hill.is_in[p]);
            let holes = (0..depths.len()).filter(|&p| is_hill(p) && !depths[p].is_finite()).count();
            assert!(holes == 0, "{what}: {holes} holes");
        }
    }
    assert!(raised > 60_000, "{raised}");
}
