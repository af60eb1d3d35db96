//! Case 12, deformations: slivers of 1 mm × 1 km that are bent, and corners that are carried behind the eye, or are behind it at rest.
//! Property: distances and normals are numbers, nothing is shown beside the body, and there are few triangles. Oracle: the pixels that
//! the truly deformed body covers, in f64.

use glam::{DVec2, DVec3};
use veduta::{
    lens::deform::{ControlProfile, Step},
    view::Camera,
};

use crate::{
    bodies::{ORIGIN, block, place, studio_of},
    case_12_layers::beam,
    deformed::{Bent, Pixels, direction, distances, drawn, is_weakened, patch},
    lenses::{share, view},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [160, 120];
/// How far what is shown may be beside the body: its edges a quarter of a pixel, and what the oracle's parts are too flat.
const REACH_PX: f64 = 1.5;

/// Slivers side by side: 6 mm wide.
const SLIVERS: i64 = 6;

/// What is shown and what is not, none of it beside the body.
fn check(shown: &[f32], body: &Pixels, what: &str) -> [u64; 2] {
    let mut seen = [0, 0];
    for (i, d) in shown.iter().enumerate() {
        assert!(!d.is_finite() || body.is_in[i], "{what}: pixel {i} at {d} m shows something beside the body");
        seen[usize::from(!d.is_finite())] += 1;
    }
    seen
}

#[test]
fn slivers_that_are_bent_are_shown_where_they_are() {
    let mut studio = studio_of(&[beam(SLIVERS, 300)]);
    let middle = ORIGIN + DVec3::new(0.003, 0.0, 0.15);
    let over = |size: DVec3, steps: Vec<Step>, control: ControlProfile| {
        let center = ORIGIN + DVec3::new(0.003, 0.0, 0.5 * size.z);
        Bent::upright(center, size, steps, control)
    };
    let everywhere = || ControlProfile::Everywhere;
    // None makes slivers much thinner than they are.
    let lift = DVec3::new(2.0, 3.0, 40.0);
    let lenses = [
        over(DVec3::new(10.0, 1000.0, 20.0), vec![Step::Bend { angle: 5.0 }], everywhere()),
        over(DVec3::new(10.0, 1000.0, 1.0), vec![Step::Twist { angle: 0.3 }], everywhere()),
        over(DVec3::new(10.0, 1000.0, 0.3), vec![Step::Taper { factor: 2.0 }], everywhere()),
        over(DVec3::new(80.0, 80.0, 20.0), vec![Step::Translate { by: lift }], ControlProfile::Bump),
        over(DVec3::new(10.0, 10.0, 1.0), vec![Step::Scale { factors: DVec3::new(3.0, 0.2, 50.0) }], everywhere()),
    ];
    // Its four sides.
    let along = DVec3::Y * 1000.0;
    let corner = ORIGIN - 0.5 * along;
    let (across, up) = (DVec3::X * 0.001 * SLIVERS as f64, DVec3::Z * 0.3);
    let mut sides = Vec::new();
    for (from, to) in [(DVec3::ZERO, across), (up, across), (DVec3::ZERO, up), (across, up)] {
        sides.extend(patch(corner + from, along, to, [1500, if to == up { 8 } else { 1 }]));
    }
    let mut numbers = Numbers(612);
    let (mut shown, mut most, mut behind) = (0, 0, 0);
    for (number, lens) in lenses.iter().enumerate() {
        // Every other look, and in a thorough run each.
        for i in (0..8).filter(|i| studio::is_tried(number + i, 2)) {
            // A look along what is bent, from beside it.
            let on = |part: f64| lens.value(middle + DVec3::Y * 480.0 * (2.0 * part - 1.0));
            let part = share(&mut numbers);
            let away = [1.5, 10.0, 120.0][i % 3];
            let eye = on(part) + direction(&mut numbers) * away;
            let target = if i < 3 { on(part) } else { on(share(&mut numbers)) };
            let camera = Camera { near_m: 0.05, ..Camera::looking(eye, target, 0.9) };
            let view = view(camera, SIZE);
            let picture = drawn(&mut studio, &studio::scene(camera, vec![lens.lens("bent")]), SIZE);
            let what = format!("{:?} from {eye} to {target}", lens.steps);
            assert!(!is_weakened(&picture), "{what}");
            let mut body = Pixels::new(SIZE);
            for side in &sides {
                body.add(&view, side.map(|p| lens.value(p)), REACH_PX);
            }
            shown += check(distances(&picture), &body, &what)[0];
            behind += u32::from(sides.iter().any(|side| view.depth(lens.value(side[0])) < 0.0));
            let deformed = picture.statistics.frame.deformed.expect("something is deformed");
            most = most.max(deformed.triangles);
        }
    }
    let (least, least_behind) = if studio::is_thorough() { (800, 6) } else { (300, 3) };
    assert!(shown > least && behind > least_behind, "{shown} pixels, {behind} looks with something behind the eye");
    // A nearer look, a finer mesh.
    assert!(most < 600_000, "{most} triangles");
}

#[test]
fn corners_that_are_carried_behind_the_eye_fill_nothing_else() {
    // A slab of 120 m: twelve triangles. A hill grows out of it, past the eye; or all of it, or a part, goes behind.
    let half = 60_000;
    let mut studio = studio_of(&[block([-half, -half, 0], [half, half, 4_000])]);
    let corner = ORIGIN - DVec3::new(60.0, 60.0, 0.0);
    let side = 120.0;
    let (x, y, z) = (DVec3::X * side, DVec3::Y * side, DVec3::Z * 4.0);
    let mut faces = patch(corner, x, y, [160, 160]);
    faces.extend(patch(corner + z, x, y, [160, 160]));
    for (from, along) in [(DVec3::ZERO, x), (y, x), (DVec3::ZERO, y), (x, y)] {
        faces.extend(patch(corner + from, along, z, [160, 8]));
    }
    let mut numbers = Numbers(712);
    let (mut seen, mut most, mut behind) = ([0, 0], 0, 0);
    for i in 0..12 {
        let at = ORIGIN + DVec3::new(50.0 * (share(&mut numbers) - 0.5), 50.0 * (share(&mut numbers) - 0.5), 10.0);
        let (steps, control) = match i % 4 {
            0 => (vec![Step::Translate { by: DVec3::Z * 120.0 }], ControlProfile::Bump),
            1 => (vec![Step::Scale { factors: DVec3::new(3.0, 3.0, 9.0) }], ControlProfile::Everywhere),
            2 => (vec![Step::Shear { slope: DVec2::new(20.0, -10.0) }], ControlProfile::Everywhere),
            _ => (vec![Step::Translate { by: DVec3::new(0.0, 0.0, 90.0) }], ControlProfile::Smooth { border: 0.4 }),
        };
        let lens = Bent::upright(at, DVec3::new(80.0, 80.0, 20.0), steps, control);
        let eye =
            at + DVec3::new(90.0, 90.0, 60.0) * (direction(&mut numbers) * DVec3::new(0.4, 0.4, 0.2) + DVec3::Z * 0.7);
        // Straight down, and aside.
        let target = eye + DVec3::new(0.0, 0.01, -1.0) + direction(&mut numbers) * if i % 3 == 0 { 0.0 } else { 2.0 };
        let camera = Camera { near_m: 0.1, ..Camera::looking(eye, target, [0.9, 1.8][i % 2]) };
        let view = view(camera, SIZE);
        let picture = drawn(&mut studio, &studio::scene(camera, vec![lens.lens("bent")]), SIZE);
        let what = format!("{:?} from {eye} to {target}", lens.steps);
        assert!(!is_weakened(&picture), "{what}");
        let mut body = Pixels::new(SIZE);
        for face in &faces {
            body.add(&view, face.map(|p| lens.value(p)), REACH_PX);
        }
        let [shown, other] = check(distances(&picture), &body, &what);
        seen = [seen[0] + shown, seen[1] + other];
        let is_carried = |p: DVec3| view.depth(p) > 0.0 && view.depth(lens.value(p)) < 0.0;
        behind += u32::from(faces.iter().any(|face| is_carried(face[0])));
        most = most.max(picture.statistics.frame.deformed.map_or(0, |deformed| deformed.triangles));
    }
    assert!(seen.iter().all(|count| *count > 8_000), "{seen:?}");
    assert!(behind >= 3, "{behind} looks with something carried behind the eye");
    assert!(most < 400_000, "{most} triangles");
}

#[test]
fn slivers_thinner_than_the_grid_of_the_rasteriser_hide_nothing_that_is_nearer() {
    // Slivers of 1 mm, pressed to a twentieth; and a block between them and the eye, a quarter of a metre away.
    let eye = DVec3::new(84998.94497645044, 447196.09827382, 2.3686859546917463);
    let target = DVec3::new(85000.02, 447196.7938834307, 3.15);
    let at = (eye + 0.25 * (target - eye) - ORIGIN).to_array().map(|c| (1000.0 * c).round() as i64);
    let near = block([at[0], at[1] - 100, at[2] - 100], [at[0] + 5, at[1] + 100, at[2] + 100]);
    let sides = patch(place([at[0], at[1] - 90, at[2] - 90]), DVec3::Y * 0.18, DVec3::Z * 0.18, [1, 1]);
    let mut studio = studio_of(&[near, beam(40, 300)]);
    let camera = Camera { near_m: 0.05, ..Camera::looking(eye, target, 0.9) };
    let center = ORIGIN + DVec3::new(0.02, 0.0, 0.15);
    let taper = vec![Step::Taper { factor: 0.05 }];
    let lens = Bent::upright(center, DVec3::new(10.0, 1000.0, 0.3), taper, ControlProfile::Everywhere);
    let picture = drawn(&mut studio, &studio::scene(camera, vec![lens.lens("pressed")]), SIZE);
    let mut block = Pixels::new(SIZE);
    for side in sides {
        block.add(&view(camera, SIZE), side.map(|p| lens.value(p)), 0.0);
    }
    let ids = picture.object_id.as_ref().expect("objects were asked for");
    let covered = block.is_in.iter().filter(|is_in| **is_in).count();
    let through = (0..ids.len()).filter(|&i| block.is_in[i] && ids[i] != 1).count();
    assert!(covered > 1_000 && through == 0, "{through} of {covered} pixels show what is behind");
    distances(&picture);
}
