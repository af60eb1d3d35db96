//! Balls.

use glam::DVec3;

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        build::{self, BOUNDING_LEVEL},
        error::ShapeError,
        form::{
            body::{Body, Rows, RowsEye},
            given::{self, Field, Given, Value, named},
        },
        mesh::Mesh,
        motion::Motion,
        span::round,
    },
    triangle::nearest_to_origin,
};

/// A ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle, metres.
    pub center: DVec3,
    /// Metres, ≥ 0.
    pub radius: f64,
}

impl Given for Sphere {
    named!("sphere", "A ball.");
    const DEFAULT: Self = Self { center: DVec3::ZERO, radius: 0.0 };
    const FIELDS: &'static [Field<Self>] =
        &[Field::center(|own| Value::Vector(&mut own.center)), Field::radius(|own| Value::Number(&mut own.radius))];
}

impl Body for Sphere {
    fn check(&mut self) -> Result<(), ShapeError> {
        given::check(self)
    }

    fn is_empty(&self) -> bool {
        self.radius <= 0.0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        round(ray.origin - self.center, ray.direction, self.radius)
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        p.distance(self.center) - self.radius
    }

    fn bounds(&self) -> Aabb {
        Aabb::around(self.center, DVec3::splat(self.radius))
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = corners.map(|p| p - self.center);
        nearest_to_origin(a, b, c).length_squared() <= self.radius * self.radius
    }

    fn bounding_mesh(&self) -> Mesh {
        let unit = build::icosphere(BOUNDING_LEVEL);
        let corner = |i: u32| unit.points[i as usize];
        let inner = unit
            .triangles
            .iter()
            .map(|[a, b, c]| {
                let n = (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a));
                n.normalize_or_zero().dot(corner(*a))
            })
            .fold(f64::INFINITY, f64::min);
        build::placed(unit, self.center, self.radius / inner * build::GROWTH)
    }

    fn surface_mesh(&self, segments: u32) -> Mesh {
        // An icosphere of level k has about 5·2ᵏ edges around its equator.
        let level = (f64::from(segments) / 5.0).log2().ceil().clamp(0.0, 6.0);
        build::placed(build::icosphere(level as u32), self.center, self.radius)
    }

    fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        let c = self.center - origin;
        let normal = (p - c).try_normalize()?;
        ((p - c).length_squared() > self.radius * self.radius).then(|| (normal, self.radius + normal.dot(c)))
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        Rows { a: eye.place(self.center), b: [self.radius as f32, 0.0, 0.0, 0.0], ..Rows::default() }
    }
}
