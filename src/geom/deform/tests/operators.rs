use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::{deformation, difference, is_near, operator, ready, street, vector};
use crate::geom::deform::{Control, Deformation, Deformers, Frame, Opening, Operator, Space, cofactor};

#[test]
fn a_bent_rod_is_an_arc_and_its_ends_stay_straight() {
    let (k, y) = (0.05, [-10.0, 20.0]);
    let bend = Operator::Bend { curvature: k, y, about: 0.0, base: 0.0 };
    let center = DVec3::new(0.0, 0.0, 1.0 / k);
    for i in 0..=300 {
        let p = DVec3::new(0.0, -10.0 + 0.1 * f64::from(i), 0.0);
        let bent = bend.value(p);
        assert!((bent.distance(center) - 1.0 / k).abs() < 1e-12);
        let angle = bent.y.atan2(1.0 / k - bent.z);
        assert!((angle - k * p.y).abs() < 1e-12, "lengths stay");
        assert!((bend.determinant(p + DVec3::Z * 3.0) - (1.0 - k * 3.0)).abs() < 1e-15);
    }
    let beyond = [25.0, 30.0, 40.0].map(|y| bend.value(DVec3::new(0.0, y, 0.0)));
    assert!((beyond[1] - beyond[0]).cross(beyond[2] - beyond[0]).length() < 1e-12);
    assert!(((beyond[2] - beyond[0]).length() - 15.0).abs() < 1e-12);
    assert_eq!(bend.determinant(DVec3::new(0.0, 25.0, 3.0)), 1.0);
    // However weak, it has no 1/k in it.
    let weak = Operator::Bend { curvature: 1e-200, y, about: 3.0, base: 0.0 };
    assert!(weak.value(DVec3::new(1.0, 7.0, 2.0)).distance(DVec3::new(1.0, 7.0, 2.0)) < 1e-15);
}

#[test]
fn tapers_and_twists_do_what_their_names_say() {
    let taper = Operator::Taper { z: [0.0, 10.0], factors: [1.0, 0.5] };
    assert_eq!(taper.value(DVec3::new(4.0, -2.0, 5.0)), DVec3::new(3.0, -1.5, 5.0));
    assert_eq!(taper.value(DVec3::new(4.0, -2.0, 15.0)), DVec3::new(2.0, -1.0, 15.0));
    assert_eq!(taper.determinant(DVec3::new(4.0, -2.0, 5.0)), 0.75 * 0.75);
    let twist = Operator::Twist { z: [0.0, 10.0], angles: [0.0, std::f64::consts::PI] };
    assert!(twist.value(DVec3::new(4.0, 0.0, 5.0)).distance(DVec3::new(0.0, 4.0, 5.0)) < 1e-15);
    assert_eq!(twist.determinant(DVec3::new(4.0, 0.0, 5.0)), 1.0);
    let shear = Operator::Shear { slope: DVec2::new(0.5, -1.0), base: 2.0 };
    assert_eq!(shear.value(DVec3::new(1.0, 1.0, 6.0)), DVec3::new(3.0, -3.0, 6.0));
    assert_eq!(Operator::heights(3.0, 2.0).value(DVec3::new(1.0, 1.0, 6.0)), DVec3::new(1.0, 1.0, 14.0));
    let out = Operator::call_out(DVec3::X, 2.0, DVec3::Z * 50.0);
    let shown = out.iter().fold(DVec3::new(3.0, 1.0, 0.0), |p, operator| operator.value(p));
    assert_eq!(shown, DVec3::new(5.0, 2.0, 50.0));
}

#[test]
fn a_panorama_keeps_what_is_near_and_lifts_what_is_far() {
    let panorama = Operator::panorama(50.0, 250.0, 0.5, 30.0);
    let near = DVec3::new(7.0, 49.0, -12.0);
    assert_eq!(panorama.value(near), near);
    let [a, b] = [300.0, 400.0].map(|y| panorama.value(DVec3::new(0.0, y, -30.0)));
    let rise = b - a;
    assert!((rise.z.atan2(rise.y) - 0.5).abs() < 1e-12 && (rise.length() - 100.0).abs() < 1e-9);
}

#[test]
fn a_straight_street_opens_by_its_formula() {
    let opening = Opening { line: vec![DVec2::new(-200.0, 0.0), DVec2::new(200.0, 0.0)], ..street() };
    let open = Operator::Open(opening.clone());
    let shown = |d: f64| open.value(DVec3::new(3.0, d, 7.0));
    let smooth = |t: f64| 3.0 * t * t - 2.0 * t * t * t;
    for i in -250..250 {
        let d = 0.1 * f64::from(i);
        let q = d.abs() / 5.0;
        let fade = 1.0 - smooth(((d.abs() - 5.0) / 15.0).clamp(0.0, 1.0));
        let push = 4.0 * if q <= 1.0 { 0.5 * (3.0 * q - q * q * q) } else { fade };
        assert!((shown(d).y - (d + push * d.signum())).abs() < 1e-12, "{d}");
        assert!((shown(d).z - (-3.0 + 10.0 * (1.0 - 0.4 * fade))).abs() < 1e-12 && (shown(d).x - 3.0).abs() < 1e-12);
        assert!(shown(d + 0.1).y > shown(d).y, "nothing folds");
    }
    assert_eq!(shown(20.5), DVec3::new(3.0, 20.5, 7.0));
    // Points on a straight route say nothing.
    let line = [-200.0, -3.0, 1.0, 1.0, 60.0, 200.0].map(|x| DVec2::new(x, 0.0)).to_vec();
    let parts = Operator::Open(Opening { line, ..opening });
    let p = DVec3::new(0.5, 4.0, 9.0);
    assert!(parts.value(p).distance(open.value(p)) < 1e-12);
}

#[test]
fn without_strength_every_bit_stays() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let strategy = (deformation(5e5), vector(40.0));
    runner
        .run(&strategy, |(deformation, shift)| {
            let place = deformation.frame.pivot + shift;
            prop_assert_eq!(
                ready(deformation.at_strength(0.0)).value(place).to_array().map(f64::to_bits),
                place.to_array().map(f64::to_bits)
            );
            prop_assert_eq!(deformation.at_strength(1.0), deformation);
            Ok(())
        })
        .unwrap();
}

#[test]
fn frames_follow_the_camera() {
    let eye = Frame::upright(DVec3::new(10.0, 20.0, 30.0), DVec3::new(1.0, 0.0, -0.5)).unwrap();
    assert_eq!(eye.axes * DVec3::Y, DVec3::X, "y is forward");
    assert_eq!(eye.axes * DVec3::X, DVec3::NEG_Y);
    let deformation = Deformation {
        frame: Frame::WORLD,
        space: Space::Camera,
        chain: vec![Operator::panorama(50.0, 250.0, 0.5, 30.0)],
        control: Control::Everywhere,
    };
    assert!(crate::geom::deform::Deformer::new(deformation.clone()).is_err());
    let shown = ready(deformation.in_world(&eye));
    let near = DVec3::new(55.0, 1.0, 2.0);
    assert_eq!(shown.value(near), near);
    assert!(shown.value(DVec3::new(400.0, 20.0, 0.0)).z > 50.0);
    assert_eq!(Frame::upright(DVec3::ZERO, DVec3::NEG_Z), None);
    assert_eq!(Frame::new(DVec3::ZERO, DVec3::X, DVec3::X * 2.0), None);
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn operators_have_the_derivatives_that_differences_give(operator in operator(), p in vector(30.0)) {
        let Some(slope) = difference(|p| operator.value(p), p) else { return Ok(()) };
        prop_assert!(is_near(&operator.jacobian(p), &slope, 1e-6), "{} {}", operator.jacobian(p), slope);
        prop_assert!((operator.determinant(p) - slope.determinant()).abs() < 1e-5 * (1.0 + slope.determinant()));
    }

    #[test]
    fn operators_go_back(operator in operator(), p in vector(30.0)) {
        let back = operator.inverse(operator.value(p)).expect("a mild operator");
        prop_assert!(back.distance(p) < 1e-9, "{} {}", back, p);
    }

    #[test]
    fn long_bends_go_back(k in 0.01..0.3f64, z in -20.0..0.9f64, turn in 0.0..0.99f64, part in -0.5..1.5f64, is_mirrored in any::<bool>()) {
        let sign = if is_mirrored { -1.0 } else { 1.0 };
        let length = std::f64::consts::TAU * turn / k;
        let bend = Operator::Bend { curvature: sign * k, y: [-0.4 * length, 0.6 * length], about: 0.0, base: 0.0 };
        let p = DVec3::new(2.0, length * (part - 0.4), sign * z / k);
        let bent = bend.value(p);
        // Straight ends may run into what is bent: then another place may come there, but one does.
        let back = bend.inverse(bent).expect("a place");
        prop_assert!(bend.value(back).distance(bent) < 1e-7 * (1.0 + bent.length()));
        if (0.0..=1.0).contains(&part) {
            prop_assert!(back.distance(p) < 1e-6 * (1.0 + p.length()), "{} {}", back, p);
        }
    }

    #[test]
    fn jacobians_and_normals_are_those_of_differences(
        deformation in deformation(300.0), shift in vector(25.0), normal in vector(1.0),
    ) {
        let deformer = ready(deformation);
        let place = deformer.deformation().frame.pivot + shift;
        let Some(slope) = difference(|p| deformer.value(p), place) else { return Ok(()) };
        let jacobian = deformer.jacobian(place);
        prop_assert!(is_near(&jacobian, &slope, 1e-5), "{} {}", jacobian, slope);
        prop_assume!(slope.determinant() > 0.05);
        // A small piece of a surface across the normal, moved.
        let normal = normal.normalize_or(DVec3::Z);
        let (u, v) = normal.any_orthonormal_pair();
        let turned = (slope * u).cross(slope * v).normalize_or_zero();
        let shown = (cofactor(&jacobian) * normal).normalize_or_zero();
        prop_assert!(shown.distance(turned) < 1e-3, "{} {}", shown, turned);
    }

    #[test]
    fn several_compose_bottom_first(first in deformation(20.0), second in deformation(20.0), p in vector(30.0)) {
        let both = Deformers(vec![ready(first), ready(second)]);
        let one_by_one = both.0[1].value(both.0[0].value(p));
        prop_assert_eq!(both.value(p), one_by_one);
        if let Some(slope) = difference(|p| both.value(p), p) {
            prop_assert!(is_near(&both.jacobian(p), &slope, 1e-4));
        }
        if both.supports().all(|support| !support.contains(p)) {
            prop_assert_eq!(both.value(p), p);
        }
    }
}
