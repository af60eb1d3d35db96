use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::{deformation, difference, ready, street, vector};
use crate::geom::{
    aabb::Aabb,
    deform::{
        Control, ControlPlane, Deformation, Frame, Interval, Opening, Operator, Profile, Proof, Space, Strength,
        number::Number,
    },
};

fn around(middle: DVec3, half: f64) -> Aabb {
    Aabb { min: middle - half, max: middle + half }
}

fn everywhere(chain: Vec<Operator>) -> Deformation {
    Deformation { frame: Frame::WORLD, space: Space::World, chain, control: Control::Everywhere }
}

fn under(profile: Profile, chain: Vec<Operator>) -> Deformation {
    let control = ControlPlane { corner: DVec3::new(-20.0, -20.0, 0.0), size: DVec2::splat(40.0), profile, band: None };
    Deformation { control: Control::Plane(control), ..everywhere(chain) }
}

/// The strength that is used, for a deformation of which the one that folds is known; nothing beyond that, and not much less.
fn is_found(deformation: &Deformation, bounds: &Aabb, folds_at: f64, share: f64) -> Strength {
    let strength = deformation.safe_strength(bounds).unwrap();
    assert!(strength.used <= folds_at && strength.used >= share * folds_at, "{} of {folds_at}", strength.used);
    assert_eq!(strength.reason.is_some(), strength.used < 1.0);
    assert_eq!(strength.deformer.deformation(), &deformation.at_strength(strength.used));
    strength
}

#[test]
fn folding_is_found_where_it_begins() {
    let city = around(DVec3::ZERO, 50.0);
    // k·z = 1 at the top of the box.
    let bend = Operator::Bend { curvature: 0.1, y: [-30.0, 30.0], about: 0.0, base: 0.0 };
    let bent = is_found(&everywhere(vec![bend]), &city, 0.2, 0.99);
    assert!(matches!(bent.reason, Some(Proof::Folds { determinant, .. }) if determinant <= 0.0));
    // A taper through 0.
    let taper = |end: f64| Operator::Taper { z: [0.0, 40.0], factors: [1.0, end] };
    is_found(&everywhere(vec![taper(-1.0)]), &city, 0.5, 0.99);
    is_found(&everywhere(vec![taper(1e-3)]), &city, 1.0, 1.0);
    is_found(&everywhere(vec![Operator::heights(-3.0, 0.0)]), &city, 0.25, 0.99);
    // Ten full twists fold nothing; mixed with what is not twisted, half a turn does.
    let turns = |turns: f64| Operator::Twist { z: [0.0, 40.0], angles: [0.0, turns * std::f64::consts::TAU] };
    is_found(&everywhere(vec![turns(10.0), taper(0.1)]), &city, 1.0, 1.0);
    is_found(&under(Profile::Linear { border: 0.5 }, vec![turns(10.0)]), &city, 0.05, 0.4);
}

#[test]
fn controls_fold_where_they_are_too_steep() {
    let city = around(DVec3::ZERO, 50.0);
    // Along x a linear slope of 1 in 20 m: folds when moved by more.
    let slide = under(Profile::Linear { border: 0.5 }, vec![Operator::Translate(DVec3::X * 40.0)]);
    is_found(&slide, &city, 0.5, 0.95);
    // The steepest of 3q² − 2q³ is 1.5 of that.
    let slide = under(Profile::Smooth { border: 0.5 }, vec![Operator::Translate(DVec3::X * 40.0)]);
    is_found(&slide, &city, 1.0 / 3.0, 0.95);
    // Upwards nothing folds.
    is_found(&under(Profile::Bump, vec![Operator::Translate(DVec3::Z * 400.0)]), &city, 1.0, 1.0);
}

#[test]
fn streets_open_as_far_as_they_can() {
    let line = vec![DVec2::new(-60.0, 0.0), DVec2::new(60.0, 0.0)];
    let open = |aside: f64| everywhere(vec![Operator::Open(Opening { line: line.clone(), aside, ..street() })]);
    is_found(&open(20.0), &around(DVec3::ZERO, 20.0), 0.5, 0.9);
    // With its ends, or with corners, less is proven; what is seen is between that and what folds.
    let with_ends = open(20.0).safe_strength(&around(DVec3::ZERO, 80.0)).unwrap();
    assert!(with_ends.used > 0.02 && with_ends.used <= with_ends.seen && with_ends.seen <= 0.5, "{with_ends:?}");
    let corners = everywhere(vec![Operator::Open(street())]).safe_strength(&around(DVec3::ZERO, 80.0)).unwrap();
    assert!(corners.used <= corners.seen && corners.seen > 0.5, "{corners:?}");
    assert!(matches!(corners.reason, Some(Proof::Unknown { .. })), "{corners:?}");
}

#[test]
fn what_is_unbounded_is_not_proven_by_chance() {
    let endless = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let bend = everywhere(vec![Operator::Bend { curvature: 0.1, y: [0.0, 9.0], about: 0.0, base: 0.0 }]);
    assert_eq!(ready(bend).prove(&endless), Proof::Unknown { least: 0.0 });
    assert_eq!(ready(everywhere(vec![Operator::Translate(DVec3::X)])).prove(&endless), Proof::Proven);
    let nowhere = Deformation { chain: vec![Operator::Translate(DVec3::NAN)], ..everywhere(Vec::new()) };
    assert!(nowhere.safe_strength(&endless).is_err());
}

proptest! {
    #![proptest_config(crate::seeds::cases(12))]

    #[test]
    fn what_is_proven_folds_nowhere_and_goes_back(
        deformation in deformation(300.0), places in prop::collection::vec(vector(30.0), 40),
    ) {
        let bounds = around(deformation.frame.pivot, 30.0);
        let Strength { deformer, used, seen, .. } = deformation.safe_strength(&bounds).unwrap();
        // Of openings with corners nothing may be proven; of all else something is.
        let opens = deformation.chain.iter().any(|operator| matches!(operator, Operator::Open(_)));
        prop_assert!((used > 0.0 || opens) && seen >= used);
        for shift in places {
            let place = bounds.center() + shift;
            let shown = deformer.value(place);
            let back = deformer.inverse(shown);
            prop_assert!(back.is_some(), "{} {:?}", place, deformer.deformation());
            prop_assert!(back.unwrap().distance(place) < 1e-6, "{:?} {} {:?}", back, place, deformer.deformation());
            if let Some(slope) = difference(|p| deformer.value(p), place) {
                prop_assert!(slope.determinant() > -1e-6);
            }
        }
    }

    #[test]
    fn intervals_hold_what_is_computed_in_them(a in -9.0..9.0f64, b in -9.0..9.0f64, w in 0.0..3.0f64, u in 0.0..=1.0f64, v in 0.0..=1.0f64) {
        let (x, y) = (Interval::new(a, a + w), Interval::new(b, b + w));
        let (p, q) = ((a + u * w).min(a + w), (b + v * w).min(b + w));
        prop_assert!((x + y).contains(p + q) && (x - y).contains(p - q) && (x * y).contains(p * q));
        prop_assert!(x.sin_cos().0.contains(p.sin()) && x.sin_cos().1.contains(p.cos()));
        prop_assert!(x.sinc().contains(p.sinc()) && x.square().contains(p * p) && x.root().contains(p.root()));
        prop_assert!(x.inverse().contains(p.recip()) || p == 0.0);
        let (unit, part) = (Number::clamp(x, 0.0, 1.0), p.clamp(0.0, 1.0));
        prop_assert!(unit.smooth().contains(part.smooth()) && unit.smooth_slope().contains(part.smooth_slope()));
    }
}
