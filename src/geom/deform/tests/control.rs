use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::{control, deformation, profile, ready, vector};
use crate::geom::{
    aabb::Aabb,
    deform::{Control, ControlPlane, Deformation, Frame, Operator, Profile, Space, Texels},
};

/// What a rise by κ metres shows of it, over the unit square.
fn kappa(profile: Profile) -> impl Fn(f64, f64) -> f64 {
    let control = ControlPlane { corner: DVec3::ZERO, size: DVec2::ONE, profile, band: None };
    let deformer = ready(Deformation {
        frame: Frame::WORLD,
        space: Space::World,
        chain: vec![Operator::Translate(DVec3::Z)],
        control: Control::Plane(control),
    });
    move |s, t| deformer.value(DVec3::new(s, t, 0.0)).z
}

#[test]
fn texels_are_met_at_their_middles_and_mixed_between() {
    let values = vec![0.25, 1.0, 0.5, 0.0, 0.75, 0.5];
    let shown = kappa(Profile::Texels(Texels::new(3, 2, values.clone()).unwrap()));
    for (i, value) in values.iter().enumerate() {
        let (s, t) = ((0.5 + (i % 3) as f64) / 3.0, (0.5 + (i / 3) as f64) / 2.0);
        assert!((shown(s, t) - f64::from(*value)).abs() < 1e-15);
        assert_eq!(shown(s, 0.0), 0.0);
        assert_eq!(shown(s, 1.0), 0.0);
    }
    assert!((shown(1.0 / 3.0, 0.5) - 0.5).abs() < 1e-15, "the mean of four");
    assert!((shown(0.5, 0.125) - 0.5).abs() < 1e-15, "half of the texel, half way to the border");
    assert_eq!(Texels::new(2, 2, vec![0.0; 3]), None);
    assert_eq!(Texels::new(1, 1, vec![1.5]), None);
    assert_eq!(Texels::new(1, 1, vec![f32::NAN]), None);
}

#[test]
fn profiles_have_their_shapes() {
    let linear = kappa(Profile::Linear { border: 0.25 });
    assert_eq!([linear(0.5, 0.5), linear(0.125, 0.5), linear(0.125, 0.875)], [1.0, 0.5, 0.25]);
    let smooth = kappa(Profile::Smooth { border: 0.5 });
    assert_eq!([smooth(0.5, 0.5), smooth(0.25, 0.5), smooth(0.125, 0.5)], [1.0, 0.5, 0.15625]);
    let bump = kappa(Profile::Bump);
    assert_eq!([bump(0.5, 0.5), bump(0.75, 0.5), bump(0.0, 0.0)], [1.0, 0.5625, 0.0]);
    let ring = kappa(Profile::Ring { inner: 0.25, outer: 0.75 });
    assert_eq!([ring(0.5, 0.5), ring(0.6, 0.5), ring(0.9, 0.5)], [0.0; 3]);
    let wall = (0.5 * (0.75_f64.powi(2) + 0.25_f64.powi(2))).sqrt();
    assert!((ring(0.5 + 0.5 * wall, 0.5) - 1.0).abs() < 1e-14);
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn nothing_tears_along_the_border(profile in profile(), along in 0.0..=1.0f64) {
        let shown = kappa(profile);
        for (s, t) in [(0.0, along), (1.0, along), (along, 0.0), (along, 1.0)] {
            prop_assert!(shown(s, t).abs() < 1e-14);
            let inner = |x: f64| x.clamp(1e-6, 1.0 - 1e-6);
            prop_assert!(shown(inner(s), inner(t)) < 1e-3);
        }
    }

    #[test]
    fn places_outside_the_support_keep_every_bit(deformation in deformation(5e5), shift in vector(80.0)) {
        let deformer = ready(deformation);
        let place = deformer.deformation().frame.pivot + shift;
        let world = deformer.support().in_world();
        if !world.meets(&Aabb { min: place, max: place }) {
            prop_assert!(!deformer.support().contains(place));
            prop_assert_eq!(deformer.value(place).to_array().map(f64::to_bits), place.to_array().map(f64::to_bits));
        }
    }

    #[test]
    fn deformed_boxes_hold_what_was_in_them(
        deformation in deformation(5e4), (middle, half) in (vector(30.0), vector(15.0)),
        parts in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 50),
    ) {
        let deformer = ready(deformation);
        let middle = deformer.deformation().frame.pivot + middle;
        let bounds = Aabb { min: middle - half.abs(), max: middle + half.abs() };
        let moved = deformer.deformed_bounds(&bounds);
        for part in parts {
            let place = middle + DVec3::from(part) * half;
            let shown = deformer.value(place);
            // θ itself is rounded, the box is not.
            let room = DVec3::splat(1e-9);
            prop_assert!(shown.cmpge(moved.min - room).all() && shown.cmple(moved.max + room).all(), "{} {:?}", shown, moved);
        }
    }

    #[test]
    fn heights_come_and_go_in_their_band(control in control(), z in -80.0..80.0f64) {
        let Control::Plane(plane) = control else { return Ok(()) };
        let Some(band) = plane.band else { return Ok(()) };
        let middle = plane.corner.truncate() + 0.5 * plane.size;
        let deformer = ready(Deformation {
            frame: Frame::WORLD,
            space: Space::World,
            chain: vec![Operator::Translate(DVec3::Z)],
            control: Control::Plane(ControlPlane { profile: Profile::Bump, ..plane.clone() }),
        });
        let rise = deformer.value(middle.extend(z)).z - z;
        let delta = z - plane.corner.z;
        let is_inside = (band.low..=band.high).contains(&delta);
        let most = if is_inside { 1.0 + 1e-12 } else { 0.0 };
        prop_assert!((0.0..=most).contains(&rise));
        if (band.low + band.fade..=band.high - band.fade).contains(&delta) {
            prop_assert!((rise - 1.0).abs() < 1e-12);
        }
    }
}
