//! Deformations against finite differences, geometry one knows, and brute force.

mod certificate;
mod control;
mod operators;

use glam::{DMat3, DQuat, DVec2, DVec3};
use proptest::prelude::*;

use crate::geom::deform::{
    Band, Control, ControlPlane, Deformation, Deformer, Frame, Opening, Operator, Profile, Space, Texels,
};

/// A street with two corners, some 90 m.
pub(crate) fn street() -> Opening {
    let line = [(-30.0, -10.0), (0.0, 0.0), (14.0, 20.0), (40.0, 24.0)];
    Opening {
        line: line.map(|(x, y)| DVec2::new(x, y)).to_vec(),
        half_width: 5.0,
        reach: 20.0,
        aside: 4.0,
        height: 0.6,
        base: -3.0,
    }
}

pub(crate) fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from)
}

/// Any operator, mild over some 20 m around zero.
pub(crate) fn operator() -> impl Strategy<Value = Operator> {
    let ends = || (-20.0..0.0, 2.0..20.0).prop_map(|(low, length): (f64, f64)| [low, low + length]);
    let factors = || prop::array::uniform2(0.4..1.8);
    prop_oneof![
        vector(9.0).prop_map(Operator::Translate),
        (prop::array::uniform3(0.4..1.8), vector(9.0))
            .prop_map(|(factors, about)| Operator::Scale { factors: factors.into(), about }),
        (prop::array::uniform2(-1.0..1.0), -5.0..5.0)
            .prop_map(|(slope, base)| Operator::Shear { slope: slope.into(), base }),
        (ends(), factors()).prop_map(|(z, factors)| Operator::Taper { z, factors }),
        (ends(), prop::array::uniform2(-3.0..3.0)).prop_map(|(z, angles)| Operator::Twist { z, angles }),
        (-0.02..0.02, ends(), -5.0..5.0, -5.0..5.0).prop_map(|(curvature, y, about, base)| Operator::Bend {
            curvature,
            y,
            about,
            base
        }),
        (0.0..5.0, 0.4..1.5).prop_map(|(aside, height)| Operator::Open(Opening { aside, height, ..street() })),
    ]
}

pub(crate) fn frame(far: f64) -> impl Strategy<Value = Frame> {
    (vector(far), vector(1.0), -3.0..3.0).prop_map(|(pivot, axis, angle)| Frame {
        pivot,
        axes: DMat3::from_quat(DQuat::from_axis_angle(axis.normalize_or(DVec3::Z), angle)),
    })
}

pub(crate) fn profile() -> impl Strategy<Value = Profile> {
    prop_oneof![
        (0.1..=0.5).prop_map(|border| Profile::Linear { border }),
        (0.1..=0.5).prop_map(|border| Profile::Smooth { border }),
        Just(Profile::Bump),
        (0.0..0.4, 0.2..0.6).prop_map(|(inner, width)| Profile::Ring { inner, outer: inner + width }),
        ((1_usize..9), (1_usize..9)).prop_flat_map(|(width, height)| {
            prop::collection::vec(0.0..=1.0f32, width * height)
                .prop_map(move |values| Profile::Texels(Texels::new(width, height, values).expect("in 0..=1")))
        }),
    ]
}

pub(crate) fn control() -> impl Strategy<Value = Control> {
    let band = (-30.0..0.0, 10.0..40.0, 1.0..9.0).prop_map(|(low, length, fade): (f64, f64, f64)| Band {
        low,
        high: low + length,
        fade,
    });
    let plane = (vector(3.0), prop::array::uniform2(20.0..60.0), profile(), prop::option::of(band)).prop_map(
        |(shift, size, profile, band)| {
            let size = DVec2::from(size);
            Control::Plane(ControlPlane { corner: shift - 0.5 * size.extend(0.0), size, profile, band })
        },
    );
    prop_oneof![1 => Just(Control::Everywhere), 4 => plane]
}

pub(crate) fn deformation(far: f64) -> impl Strategy<Value = Deformation> {
    (frame(far), prop::collection::vec(operator(), 0..4), control()).prop_map(|(frame, chain, control)| Deformation {
        frame,
        space: Space::World,
        chain,
        control,
    })
}

pub(crate) fn ready(deformation: Deformation) -> Deformer {
    Deformer::new(deformation).expect("numbers that can be used")
}

/// Central differences; `None` at a kink, where two steps disagree.
pub(crate) fn difference(value: impl Fn(DVec3) -> DVec3, at: DVec3) -> Option<DMat3> {
    let by = |step: f64| {
        let column = |axis: DVec3| (value(at + step * axis) - value(at - step * axis)) / (2.0 * step);
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    };
    let (fine, coarse) = (by(1e-4), by(3e-4));
    is_near(&fine, &coarse, 1e-5).then_some(fine)
}

pub(crate) fn is_near(a: &DMat3, b: &DMat3, error: f64) -> bool {
    let size = 1.0 + b.to_cols_array().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    (*a - *b).to_cols_array().iter().all(|d| d.abs() <= error * size)
}
