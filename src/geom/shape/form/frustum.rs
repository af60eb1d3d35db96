//! Cones, cut or not.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        build,
        form::body::{BOUNDING_SIDES, Body, Rows, RowsEye, ends},
        mesh::Mesh,
        motion::Motion,
        span::{Parted, Side, across, both, cone, slab},
    },
    triangle::{clipped, distance_to_origin},
};

/// A cone, or what is left of one without its tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Frustum {
    /// The middle of its axis, metres.
    pub center: DVec3,
    /// Where the axis begins, and where it ends, metres, ≥ 0.
    pub radii: [f64; 2],
    /// Half the height, metres, ≥ 0.
    pub half: f64,
    /// Unit.
    pub axis: DVec3,
}

impl Frustum {
    /// What its radius grows by along its axis.
    fn growth(&self) -> f64 {
        (self.radii[1] - self.radii[0]) / (2.0 * self.half)
    }

    /// Its radius half way.
    fn middle(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1])
    }
}

impl Body for Frustum {
    fn is_empty(&self) -> bool {
        self.radii[0].max(self.radii[1]).min(self.half) <= 0.0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (o, d) = (ray.origin - self.center, ray.direction);
        let (along_o, along_d) = (o.dot(self.axis), d.dot(self.axis));
        let ends = slab(along_o, along_d, self.half)?;
        let (slope, middle) = (self.growth(), self.middle());
        let o = Parted { across: o - along_o * self.axis, along: along_o };
        let d = Parted { across: across(d, self.axis), along: along_d };
        Some(both([ends, cone(o, d, Side { middle, slope, ends })?]))
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        let v = p - self.center;
        let along = v.dot(self.axis);
        distance(DVec2::new((v - along * self.axis).length(), along), self.radii, self.half)
    }

    fn bounds(&self) -> Aabb {
        let disc = (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        let end = |side: f64, radius: f64| Aabb::around(self.center + side * self.half * self.axis, radius * disc);
        end(-1.0, self.radii[0]).union(end(1.0, self.radii[1]))
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
        self.axis = (motion.rotation * self.axis).normalize_or(self.axis);
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let local = corners.map(|p| p - self.center);
        let (slope, middle) = (self.growth(), self.middle());
        let radius = |p: DVec3| middle + slope * p.dot(self.axis);
        // A cone is a cylinder seen from its tip: divided by the radius there, what is convex stays so. Without the
        // tip, where the radius is less than 1e-12 of the largest.
        let tip = (-slope * self.axis, middle - 1e-12 * self.radii[0].max(self.radii[1]));
        let part = clipped(&local, [(self.axis, self.half), (-self.axis, self.half), tip]);
        let (u, v) = self.axis.any_orthonormal_pair();
        let flat: Vec<DVec2> = part.iter().map(|p| DVec2::new(p.dot(u), p.dot(v)) / radius(*p)).collect();
        distance_to_origin(&flat) <= 1.0
    }

    fn bounding_mesh(&self) -> Mesh {
        let wider = build::GROWTH / (0.5 * TAU / f64::from(BOUNDING_SIDES)).cos();
        build::prism(self.center, self.radii.map(|r| r * wider), self.half * build::GROWTH, self.axis, BOUNDING_SIDES)
    }

    fn surface_mesh(&self, segments: u32) -> Mesh {
        build::prism(self.center, self.radii, self.half, self.axis, segments)
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        let (x, y) = self.axis.any_orthonormal_pair();
        let radius = self.radii[0].max(self.radii[1]);
        let half = DVec3::new(radius, radius, self.half);
        Some(build::corners_of_box(self.center, DMat3::from_cols(x, y, self.axis), half + reach))
    }

    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        ends(self.center - origin, self.axis, self.half).to_vec()
    }

    fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        // |across| ≤ middle + slope · along is one nappe of the cone, and convex; its gradient is the plane's.
        let c = self.center - origin;
        let (slope, middle) = (self.growth(), self.middle());
        let along = (p - c).dot(self.axis);
        let across = p - c - along * self.axis;
        if across.length() <= middle + slope * along {
            return None;
        }
        let gradient = across.normalize_or(self.axis.any_orthonormal_vector()) - slope * self.axis;
        let normal = gradient.try_normalize()?;
        Some((normal, middle / gradient.length() + normal.dot(c)))
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        Rows {
            a: eye.place(self.center),
            b: [self.middle() as f32, 0.0, 0.0, 0.0],
            c: [0.0, 0.0, 0.0, self.growth() as f32],
            d: eye.row(self.axis, self.half),
        }
    }
}

/// From a point (away from the axis, along it) to the border of a cone with its tip cut off, negative inside.
fn distance(p: DVec2, [bottom, top]: [f64; 2], half: f64) -> f64 {
    let corners = [DVec2::new(bottom, -half), DVec2::new(top, half)];
    let side = corners[1] - corners[0];
    // To the right of the side, seen from the first corner, is outside.
    let beyond_side = (p - corners[0]).perp_dot(side) / side.length();
    let inside = beyond_side.max(p.y.abs() - half);
    if inside <= 0.0 {
        return inside;
    }
    let to_segment = |a: DVec2, b: DVec2| {
        let along = b - a;
        let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        (p - a - t * along).length()
    };
    let caps = corners.map(|c| to_segment(DVec2::new(0.0, c.y), c));
    caps[0].min(caps[1]).min(to_segment(corners[0], corners[1]))
}
