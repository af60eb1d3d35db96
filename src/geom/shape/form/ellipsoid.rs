//! Ellipsoids.

use glam::{DMat3, DQuat, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        build,
        error::ShapeError,
        form::{
            body::{Body, Rows, RowsEye},
            given::{self, Field, Given, Quantity, Value, named},
            sphere::Sphere,
        },
        mesh::Mesh,
        motion::Motion,
        span::round,
    },
    triangle::nearest_to_origin,
};

/// A ball that is stretched along its own axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Its middle, metres.
    pub center: DVec3,
    /// Half its extent along its axes, metres, ≥ 0.
    pub radii: DVec3,
    /// Turns its axes into the world's.
    pub rotation: DQuat,
}

const UNIT_BALL: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };

impl Given for Ellipsoid {
    named!("ellipsoid", "A ball stretched along its own axes.");
    const DEFAULT: Self = Self { center: DVec3::ZERO, radii: DVec3::ZERO, rotation: DQuat::IDENTITY };
    const FIELDS: &'static [Field<Self>] = &[
        Field::center(|own| Value::Vector(&mut own.center)),
        Field {
            name: "radii",
            quantity: Quantity::Lengths,
            default: "",
            doc: "Half its extent along its own x, y, z.",
            example: "[80.0, 40.0, 20.0]",
            at: |own| Value::Vector(&mut own.radii),
        },
        Field::rotation(|own| Value::Turn(&mut own.rotation)),
    ];
}

impl Body for Ellipsoid {
    fn check(&mut self) -> Result<(), ShapeError> {
        given::check(self)
    }

    fn is_empty(&self) -> bool {
        self.radii.min_element() <= 0.0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        // A ball in its own measure.
        let back = self.rotation.conjugate();
        round(back * (ray.origin - self.center) / self.radii, back * ray.direction / self.radii, 1.0)
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        distance(self.rotation.conjugate() * (p - self.center), self.radii)
    }

    fn bounds(&self) -> Aabb {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| self.rotation * a);
        let squares: DVec3 = (0..3).map(|i| (self.radii[i] * axes[i]) * (self.radii[i] * axes[i])).sum();
        Aabb::around(self.center, squares.map(f64::sqrt))
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
        self.rotation = (motion.rotation * self.rotation).normalize();
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = corners.map(|p| self.rotation.conjugate() * (p - self.center) / self.radii);
        nearest_to_origin(a, b, c).length_squared() <= 1.0
    }

    fn bounding_mesh(&self) -> Mesh {
        build::stretched(UNIT_BALL.bounding_mesh(), self.center, self.radii, self.rotation)
    }

    fn surface_mesh(&self, segments: u32) -> Mesh {
        build::stretched(UNIT_BALL.surface_mesh(segments), self.center, self.radii, self.rotation)
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        Some(build::corners_of_box(self.center, DMat3::from_quat(self.rotation), self.radii + reach))
    }

    fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        // Where the line to its middle leaves it, the plane that touches it.
        let c = self.center - origin;
        let unit = self.rotation.conjugate() * (p - c) / self.radii;
        if unit.length_squared() <= 1.0 {
            return None;
        }
        let slope = self.rotation * (unit / unit.length() / self.radii);
        let normal = slope.try_normalize()?;
        Some((normal, 1.0 / slope.length() + normal.dot(c)))
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        let axes = DMat3::from_quat(self.rotation);
        // In its own measure it is a ball of radius 1.
        Rows {
            a: eye.place(self.center),
            b: eye.row(axes.x_axis / self.radii.x, 0.0),
            c: eye.row(axes.y_axis / self.radii.y, 0.0),
            d: eye.row(axes.z_axis / self.radii.z, 0.0),
        }
    }
}

/// From a point in the ellipsoid's own axes to its border, negative inside.
///
/// The nearest point is x with xᵢ = eᵢ² yᵢ / (t + eᵢ²), t the largest root of Σ (eᵢ yᵢ / (t + eᵢ²))² = 1 (Eberly, *Distance
/// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*). t is counted from −min eᵢ², where the points that have
/// several nearest ones find it.
fn distance(p: DVec3, radii: DVec3) -> f64 {
    if radii.min_element() <= 0.0 {
        // A disc, a line or a point: a ball around what it is in holds it.
        return (p.abs() - radii).max(DVec3::ZERO).length();
    }
    let y = p.abs().max(1e-30 * radii);
    let least = radii.min_element() * radii.min_element();
    let above = radii * radii - least;
    let (mut low, mut high) = (0.0, (radii * y).length());
    for _ in 0..220 {
        let s = 0.5 * (low + high);
        if s <= low || s >= high {
            break;
        }
        if (radii * y / (s + above)).length_squared() > 1.0 { low = s } else { high = s }
    }
    let nearest = radii * radii * y / (high + above);
    let distance = (y - nearest).length();
    if (p / radii).length_squared() <= 1.0 { -distance } else { distance }
}
