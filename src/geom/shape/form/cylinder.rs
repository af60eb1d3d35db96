//! Cylinders.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        build,
        error::ShapeError,
        form::{
            body::{BOUNDING_SIDES, Body, Rows, RowsEye, ends},
            given::{self, Field, Given, Quantity, Value, named},
        },
        mesh::Mesh,
        motion::Motion,
        span::{across, both, round, slab},
    },
    triangle::{clipped, distance_to_origin},
};

/// A finite cylinder.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    /// The middle of its axis, metres.
    pub center: DVec3,
    /// Metres, ≥ 0.
    pub radius: f64,
    /// Full height, metres, ≥ 0.
    pub height: f64,
    /// Unit.
    pub axis: DVec3,
}

impl Given for Cylinder {
    named!("cylinder", "A cylinder.");
    const DEFAULT: Self = Self { center: DVec3::ZERO, radius: 0.0, height: 0.0, axis: DVec3::Z };
    const FIELDS: &'static [Field<Self>] = &[
        Field::center(|own| Value::Vector(&mut own.center)),
        Field::radius(|own| Value::Number(&mut own.radius)),
        Field {
            name: "height",
            quantity: Quantity::Length,
            default: "",
            doc: "From end to end.",
            example: "80.0",
            at: |own| Value::Number(&mut own.height),
        },
        Field {
            name: "axis",
            quantity: Quantity::Direction,
            default: "[0, 0, 1]",
            doc: "Its direction, of any length but 0.",
            example: "[0, 0, 1]",
            at: |own| Value::Vector(&mut own.axis),
        },
    ];
}

impl Cylinder {
    /// Half the height, metres.
    pub fn half(&self) -> f64 {
        0.5 * self.height
    }
}

impl Body for Cylinder {
    fn check(&mut self) -> Result<(), ShapeError> {
        given::check(self)
    }

    fn is_empty(&self) -> bool {
        self.radius.min(self.height) <= 0.0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (o, d) = (ray.origin - self.center, ray.direction);
        let (along_o, along_d) = (o.dot(self.axis), d.dot(self.axis));
        let side = round(o - along_o * self.axis, across(d, self.axis), self.radius)?;
        Some(both([side, slab(along_o, along_d, self.half())?]))
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        let v = p - self.center;
        let along = v.dot(self.axis);
        let q = DVec2::new((v - along * self.axis).length() - self.radius, along.abs() - self.half());
        q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
    }

    fn bounds(&self) -> Aabb {
        // A disc of normal n reaches r·√(1 − nᵢ²) along axis i.
        let disc = (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        Aabb::around(self.center, self.half() * self.axis.abs() + self.radius * disc)
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
        self.axis = (motion.rotation * self.axis).normalize_or(self.axis);
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let local = corners.map(|p| p - self.center);
        let part = clipped(&local, [(self.axis, self.half()), (-self.axis, self.half())]);
        let (u, v) = self.axis.any_orthonormal_pair();
        let flat: Vec<DVec2> = part.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect();
        distance_to_origin(&flat) <= self.radius
    }

    fn bounding_mesh(&self) -> Mesh {
        let outer = self.radius / (0.5 * TAU / f64::from(BOUNDING_SIDES)).cos() * build::GROWTH;
        build::prism(self.center, [outer; 2], self.half() * build::GROWTH, self.axis, BOUNDING_SIDES)
    }

    fn surface_mesh(&self, segments: u32) -> Mesh {
        build::prism(self.center, [self.radius; 2], self.half(), self.axis, segments)
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        let (x, y) = self.axis.any_orthonormal_pair();
        let half = DVec3::new(self.radius, self.radius, self.half());
        Some(build::corners_of_box(self.center, DMat3::from_cols(x, y, self.axis), half + reach))
    }

    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        ends(self.center - origin, self.axis, self.half()).to_vec()
    }

    fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        let c = self.center - origin;
        let across = (p - c).reject_from_normalized(self.axis);
        let normal = across.try_normalize()?;
        (across.length_squared() > self.radius * self.radius).then(|| (normal, self.radius + normal.dot(c)))
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        Rows {
            a: eye.place(self.center),
            b: [self.radius as f32, 0.0, 0.0, 0.0],
            d: eye.row(self.axis, self.half()),
            ..Rows::default()
        }
    }
}
