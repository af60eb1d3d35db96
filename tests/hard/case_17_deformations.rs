//! Case 17: tapers to nothing, bends whose lengths go to zero, ten full twists, chains. Property: what is used folds nothing, at very many
//! places; whoever asked for more is told, and nobody else; it goes back. Oracle: determinants by finite differences in f64, and
//! determinants that are known.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DQuat, DVec2, DVec3};
use veduta::{
    geom::{
        Aabb,
        deform::{Control, ControlPlane, Deformation, Deformer, Frame, Operator, Profile, Space, Strength},
    },
    lens::deform::{ControlProfile, Step},
    view::Camera,
};

use crate::{
    bodies::{ORIGIN, block, studio_of},
    deformed::{Bent, deformers, determinant, direction, distances, drawn, is_weakened},
    lenses::share,
    oracle::Numbers,
    studio,
};

/// Step of differences, metres.
const STEP: f64 = 1e-4;

fn around(middle: DVec3, half: f64) -> Aabb {
    Aabb { min: middle - half, max: middle + half }
}

/// A place of a box, as often as not near a face of it.
fn place_in(bounds: &Aabb, numbers: &mut Numbers) -> DVec3 {
    let mut part = || match numbers.below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => share(numbers),
    };
    let inner = Aabb { min: bounds.min + 3.0 * STEP, max: bounds.max - 3.0 * STEP };
    inner.min + inner.size() * DVec3::new(part(), part(), part())
}

/// The least determinant at places of a box, none at a kink.
fn least(deformer: &Deformer, bounds: &Aabb, count: u32, numbers: &mut Numbers) -> f64 {
    let mut seen = 0;
    let mut least = f64::INFINITY;
    for _ in 0..count {
        let place = place_in(bounds, numbers);
        if let Some(found) = determinant(|p| deformer.value(p), place, STEP) {
            least = least.min(found);
            seen += 1;
        }
    }
    assert!(2 * seen > count, "{seen} of {count} places are at no kink");
    least
}

/// What is taken somewhere goes back to where it was.
fn check_back(deformer: &Deformer, bounds: &Aabb, count: u32, numbers: &mut Numbers) {
    for _ in 0..count {
        let place = place_in(bounds, numbers);
        let shown = deformer.value(place);
        let back = deformer.inverse(shown);
        let Some(back) = back else { panic!("{place} does not come back: {:?}", deformer.deformation()) };
        let off = deformer.value(back).distance(shown);
        assert!(off < 1e-8 * (1.0 + shown.length()), "{place} back at {back}, shown {off} off");
        // As near as what is pressed together says.
        assert!(back.distance(place) < 1e-3, "{place} back at {back}: {:?}", deformer.deformation());
    }
}

fn everywhere(chain: Vec<Operator>) -> Deformation {
    Deformation { frame: Frame::WORLD, space: Space::World, chain, control: Control::Everywhere }
}

fn under(profile: Profile, half: f64, chain: Vec<Operator>) -> Deformation {
    let corner = DVec3::new(-half, -half, 0.0);
    let plane = ControlPlane { corner, size: DVec2::splat(2.0 * half), profile, band: None };
    Deformation { control: Control::Plane(plane), ..everywhere(chain) }
}

#[test]
fn limits_are_used_up_to_themselves_and_not_beyond() {
    let bounds = around(DVec3::ZERO, 50.0);
    let mut numbers = Numbers(617);
    let mut check = |deformation: &Deformation, folds_at: f64, share: f64, what: &str| -> Strength {
        let found = deformation.safe_strength(&bounds).expect("numbers");
        assert!(found.used <= folds_at.min(1.0) && found.used >= share * folds_at.min(1.0), "{what}: {}", found.used);
        assert_eq!(found.used < 1.0, found.reason.is_some(), "{what}");
        let least = least(&found.deformer, &bounds, 20_000, &mut numbers);
        assert!(least > 0.0, "{what}: {least}");
        check_back(&found.deformer, &bounds, 300, &mut numbers);
        found
    };
    // det = 1 − kz: at the top of the box k·50 is 1, all but, and more.
    for over in [-0.5, -1e-3, -1e-6, 1e-6, 1e-3, 0.5, 9.0] {
        let k = (1.0 + over) / 50.0;
        for k in [k, -k] {
            let bend = Operator::Bend { curvature: k, y: [-0.9 / k.abs(), 1.1 / k.abs()], about: 0.0, base: 0.0 };
            check(
                &everywhere(vec![bend]),
                if over < 0.0 { 1.0 } else { 1.0 / (1.0 + over) },
                0.99,
                &format!("k = {k}"),
            );
        }
    }
    // det = r²: a taper to almost nothing, to nothing, and through it.
    for end in [0.5, 1e-2, 1e-4, 0.0, -1e-3, -1.0, -9.0] {
        let taper = Operator::Taper { z: [-20.0, 30.0], factors: [1.0, end] };
        let folds_at = if end > 0.0 { 1.0 } else { 1.0 / (1.0 - end) };
        check(&everywhere(vec![taper]), folds_at, 0.99, &format!("a taper to {end}"));
    }
    // Ten full twists fold nothing; under a control that passes ½ no place may be turned by π, which is at the top.
    let turns = |count: f64| Operator::Twist { z: [-50.0, 50.0], angles: [0.0, count * TAU] };
    let all = check(&everywhere(vec![turns(10.0)]), 1.0, 1.0, "ten twists");
    let mut numbers = Numbers(618);
    for _ in 0..20_000 {
        let found = determinant(|p| all.deformer.value(p), place_in(&bounds, &mut numbers), STEP);
        assert!(found.is_none_or(|found| (found - 1.0).abs() < 1e-6), "{found:?}");
    }
    for profile in [Profile::Bump, Profile::Linear { border: 0.5 }, Profile::Smooth { border: 0.3 }] {
        let deformation = under(profile, 30.0, vec![turns(10.0)]);
        let found = deformation.safe_strength(&bounds).expect("numbers");
        assert!(found.reason.is_some() && found.used * 10.0 * TAU < PI && found.used > 1e-3, "{}", found.used);
        let least = least(&found.deformer, &bounds, 20_000, &mut numbers);
        assert!(least > 0.0, "{least}");
        check_back(&found.deformer, &bounds, 300, &mut numbers);
    }
}

/// Any operator, wild over some 30 m.
fn operator(numbers: &mut Numbers) -> Operator {
    let kind = numbers.below(6);
    let mut between = |low: f64, high: f64| low + (high - low) * share(numbers);
    let low = between(-20.0, 0.0);
    let z = [low, low + between(5.0, 30.0)];
    match kind {
        0 => Operator::Translate(DVec3::new(between(-9.0, 9.0), between(-9.0, 9.0), between(-20.0, 20.0))),
        1 => {
            let factors = DVec3::new(between(-0.5, 3.0), between(0.05, 3.0), between(0.05, 4.0));
            Operator::Scale { factors, about: DVec3::new(between(-5.0, 5.0), 0.0, 0.0) }
        }
        2 => Operator::Shear { slope: DVec2::new(between(-2.0, 2.0), between(-2.0, 2.0)), base: between(-5.0, 5.0) },
        3 => Operator::Taper { z, factors: [between(0.1, 2.0), between(-1.0, 2.0)] },
        4 => Operator::Twist { z, angles: [between(-9.0, 9.0), between(-9.0, 9.0)] },
        _ => {
            let curvature = between(-0.09, 0.09);
            let length = 2.5 / curvature.abs().max(0.05);
            Operator::Bend { curvature, y: [-0.5 * length, 0.5 * length], about: 0.0, base: between(-5.0, 5.0) }
        }
    }
}

#[test]
fn chains_fold_nothing_once_they_are_clamped() {
    let mut numbers = Numbers(717);
    let (mut clamped, mut whole, mut none) = (0, 0, 0);
    for i in 0..20 {
        let chain: Vec<Operator> = (0..1 + numbers.below(3)).map(|_| operator(&mut numbers)).collect();
        let half = 10.0 + 20.0 * share(&mut numbers);
        let made = match i % 5 {
            0 => everywhere(chain),
            1 => under(Profile::Linear { border: 0.4 }, half, chain),
            2 => under(Profile::Smooth { border: 0.5 }, half, chain),
            3 => under(Profile::Bump, half, chain),
            _ => under(Profile::Ring { inner: 0.1, outer: 0.9 }, half, chain),
        };
        let pivot = if i % 2 == 0 { ORIGIN } else { DVec3::ZERO };
        let axes = DMat3::from_quat(DQuat::from_axis_angle(direction(&mut numbers), 3.0 * share(&mut numbers)));
        let made = Deformation { frame: Frame { pivot, axes }, ..made };
        let bounds = around(pivot, 25.0);
        let found = made.safe_strength(&bounds).expect("numbers");
        assert_eq!(found.used < 1.0, found.reason.is_some());
        assert_eq!(found.deformer.deformation(), &made.at_strength(found.used));
        // Coordinates of cities cost the differences nine digits of sixteen.
        let least = least(&found.deformer, &bounds, 4_000, &mut numbers);
        let noise = if i % 2 == 0 { 1e-3 } else { 0.0 };
        assert!(least > -noise, "{least} at {}: {made:?}", found.used);
        check_back(&found.deformer, &bounds, 60, &mut numbers);
        match found.used {
            1.0 => whole += 1,
            0.0 => none += 1,
            _ => clamped += 1,
        }
    }
    assert!(clamped >= 5 && whole >= 3 && none <= 4, "{clamped} clamped, {whole} not, {none} not used");
}

#[test]
fn pictures_tell_whom_they_weakened_and_nobody_else() {
    let mut studio = studio_of(&[block([-20_000, -20_000, 0], [20_000, 20_000, 40_000])]);
    let twist = |turns: f64| Step::Twist { angle: turns * TAU };
    let scale = |x: f64| Step::Scale { factors: DVec3::new(x, 1.0, 1.0) };
    let slide = |x: f64| Step::Translate { by: DVec3::X * x };
    let (smooth, all) = (ControlProfile::Smooth { border: 0.5 }, ControlProfile::Everywhere);
    // Over 60 m × 60 m × 40 m: a bend by a is k = a/60, and k·40 = 1 at 1.5. Smooth slopes of 30 m have 1.5/30 at their steepest. A scale
    // by 1 + s is 1 + s(S + xS'): with q = 1 − x/30 that is 1 + s(3q² − 2q³ − 6q(1 − q)²), −0.63 s at worst.
    let cases = [
        (vec![twist(10.0)], all.clone(), false),
        (vec![twist(-10.0)], all.clone(), false),
        (vec![twist(10.0)], smooth.clone(), true),
        (vec![twist(0.05)], smooth.clone(), false),
        (vec![Step::Bend { angle: 1.49 }], all.clone(), false),
        (vec![Step::Bend { angle: 1.51 }], all.clone(), true),
        (vec![Step::Bend { angle: -3.0 }], all.clone(), false),
        (vec![Step::Taper { factor: 0.01 }], all.clone(), false),
        (vec![Step::Taper { factor: 0.3 }], smooth.clone(), false),
        (vec![slide(18.0)], smooth.clone(), false),
        (vec![slide(20.5)], smooth.clone(), true),
        (vec![slide(2100.0)], all.clone(), false),
        (vec![scale(2.4)], smooth.clone(), false),
        (vec![scale(2.8)], smooth.clone(), true),
        (vec![Step::Taper { factor: 0.1 }, twist(3.0), Step::Shear { slope: DVec2::new(0.5, -2.0) }], all, false),
        (vec![Step::Taper { factor: 0.1 }, twist(3.0), slide(5.0)], smooth, true),
    ];
    let camera = Camera::looking(ORIGIN + DVec3::new(60.0, -110.0, 60.0), ORIGIN + DVec3::Z * 20.0, 0.9);
    let bounds = Aabb { min: ORIGIN - DVec3::new(20.0, 20.0, 0.0), max: ORIGIN + DVec3::new(20.0, 20.0, 40.0) };
    let mut numbers = Numbers(817);
    for (steps, control, expected) in cases {
        let what = format!("{steps:?}, {control:?}");
        let lens = Bent::upright(ORIGIN + DVec3::Z * 20.0, DVec3::new(60.0, 60.0, 40.0), steps, control);
        let scene = studio::scene(camera, vec![lens.lens("bent")]);
        let picture = drawn(&mut studio, &scene, [96, 72]);
        distances(&picture);
        assert_eq!(is_weakened(&picture), expected, "{what}");
        let used = studio.deformers(&scene, [96, 72]).expect("deformers");
        let asked = deformers(std::slice::from_ref(&lens));
        assert_eq!(used.0[0] == asked.0[0], !expected, "{what}");
        let least = least(&used.0[0], &bounds, 4_000, &mut numbers);
        assert!(least > -1e-3, "{what}: {least}");
        if !expected {
            continue;
        }
        // Whoever is told is told how much is used.
        let warnings = &picture.statistics.warnings;
        let told = warnings.iter().find(|told| told["code"] == "deformation-weakened").expect("a warning");
        let permille = told["count"].as_u64().expect("a count") as f64;
        let (own, full) = (&used.0[0].deformation().chain[0], &asked.0[0].deformation().chain[0]);
        let part = match (own, full) {
            (Operator::Twist { angles, .. }, Operator::Twist { angles: full, .. }) => angles[1] / full[1],
            (Operator::Bend { curvature, .. }, Operator::Bend { curvature: full, .. }) => curvature / full,
            (Operator::Translate(way), Operator::Translate(full)) => way.x / full.x,
            (Operator::Scale { factors, .. }, Operator::Scale { factors: full, .. }) => {
                (factors.x - 1.0) / (full.x - 1.0)
            }
            (Operator::Taper { factors, .. }, Operator::Taper { factors: full, .. }) => {
                (factors[1] - 1.0) / (full[1] - 1.0)
            }
            other => panic!("{other:?}"),
        };
        assert!((1000.0 * part - permille).abs() < 1.001, "{what}: {part}, told {permille}");
    }
}
