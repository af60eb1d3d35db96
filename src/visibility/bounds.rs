//! Tests of boxes (Trapp §3.3.1).

use glam::DVec3;

use crate::{
    geom::{Aabb, Ray, bvh::HalfSpace, shaft::segment_meets_box},
    visibility::{
        set::Set,
        test::{Reference, Test},
        units::{Poi, Units, Viewer},
    },
};

/// The units whose boxes a test of boxes holds for, with `margin` metres added to its reach; `None` for other tests.
pub(super) fn units_of(test: &Test, units: &Units, viewer: &Viewer, pois: &[Poi], margin: f64) -> Option<Set> {
    let mut found = Set::new(units.len());
    let eye = viewer.eye;
    let mut keep = |unit: u32, holds: &dyn Fn(&Aabb) -> bool| {
        let bounds = &units.boxes[unit as usize];
        if holds_point(bounds, eye) || holds(bounds) {
            found.insert(unit);
        }
    };
    match test {
        Test::Spherical { radius, reference } => {
            let r = (radius + margin).max(0.0);
            units.tree.in_box(&around(eye, DVec3::splat(r)), |unit| keep(unit, &|b| is_near(b, eye, *reference, r)));
        }
        Test::ViewerHeight { radius, reference, up } => {
            let r = (radius + margin).max(0.0);
            let holds = |b: &Aabb| is_near(b, eye, *reference, r) && meets_plane(b, eye, *up, margin);
            units.tree.in_box(&around(eye, DVec3::splat(r)), |unit| keep(unit, &holds));
        }
        Test::Cylindrical { radius, up } => {
            let r = (radius + margin).max(0.0);
            let (u, v) = up.any_orthonormal_pair();
            let sides = [u, -u, v, -v].map(|side| HalfSpace::through(eye - r * side, side));
            let holds = |b: &Aabb| {
                let to = b.center() - eye;
                (to - to.dot(*up) * *up).length() < r
            };
            units.tree.in_half_spaces(&sides, |unit, _| keep(unit, &holds));
        }
        Test::Ground { radius } => {
            let r = (radius + margin).max(0.0);
            let holds = |b: &Aabb| {
                let plan = |p: DVec3| p.truncate();
                plan(eye).clamp(plan(b.min), plan(b.max)).distance_squared(plan(eye)) <= r * r
            };
            units.tree.in_box(&around(eye, DVec3::new(r, r, HIGHEST_M)), |unit| keep(unit, &holds));
        }
        Test::ViewAxis => {
            // Of an eye within it, whatever is looked at.
            units.tree.in_box(&around(eye, DVec3::ZERO), |unit| keep(unit, &|_| false));
            for poi in pois.iter().map(|&poi| units.box_of(poi)).filter(|b| !b.is_empty()) {
                let target = poi.center();
                let start = viewer.start_for(target);
                let ray = Ray { origin: start, direction: target - start };
                let holds = |b: &Aabb| segment_meets_box([start, target], &grown(b, margin));
                if margin == 0.0 {
                    units.tree.along_ray(&ray, 1.0, |unit, end| {
                        keep(unit, &holds);
                        end
                    });
                } else {
                    let way = grown(&Aabb::from_points([start, target]), margin.max(0.0));
                    units.tree.in_box(&way, |unit| keep(unit, &holds));
                }
            }
        }
        _ => return None,
    }
    Some(found)
}

/// Higher than anything stands, metres.
const HIGHEST_M: f64 = 1e9;

fn around(at: DVec3, half: DVec3) -> Aabb {
    Aabb { min: at - half, max: at + half }
}

/// The box with its faces moved out by `by` metres, or in, no further than to its middle.
pub(super) fn grown(bounds: &Aabb, by: f64) -> Aabb {
    let by = DVec3::splat(by).max(-0.5 * bounds.size());
    Aabb { min: bounds.min - by, max: bounds.max + by }
}

fn holds_point(bounds: &Aabb, p: DVec3) -> bool {
    p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()
}

/// Whether the reference point is less than `r` from the eye.
fn is_near(bounds: &Aabb, eye: DVec3, reference: Reference, r: f64) -> bool {
    let (low, high) = ((eye - bounds.min).abs(), (eye - bounds.max).abs());
    let to = match reference {
        Reference::Centre => bounds.center() - eye,
        Reference::Nearest => eye.clamp(bounds.min, bounds.max) - eye,
        // Axis by axis, as corners are.
        Reference::AnyCorner => low.min(high),
        Reference::AllCorners => low.max(high),
    };
    to.length_squared() < r * r
}

/// Whether the plane through the eye comes within `margin` of the box: |(c − LF) · LU| ≤ Σ eᵢ |LUᵢ|.
fn meets_plane(bounds: &Aabb, eye: DVec3, up: DVec3, margin: f64) -> bool {
    (bounds.center() - eye).dot(up).abs() <= (0.5 * bounds.size()).dot(up.abs()) + margin
}
