//! Oriented boxes.

use glam::{DMat3, DQuat, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        build,
        error::ShapeError,
        form::{
            body::{Body, Rows, RowsEye, ends},
            given::{self, Field, Given, Quantity, Value, named},
        },
        mesh::Mesh,
        motion::Motion,
        span::{EVERYWHERE, both, slab},
    },
    triangle::clipped,
};

/// A box.
#[derive(Clone, Debug, PartialEq)]
pub struct OrientedBox {
    /// Its middle, metres.
    pub center: DVec3,
    /// Full edges, metres, ≥ 0.
    pub size: DVec3,
    /// Turns its axes into the world's.
    pub rotation: DQuat,
}

impl Given for OrientedBox {
    named!("box", "A box.");
    const DEFAULT: Self = Self { center: DVec3::ZERO, size: DVec3::ZERO, rotation: DQuat::IDENTITY };
    const FIELDS: &'static [Field<Self>] = &[
        Field::center(|own| Value::Vector(&mut own.center)),
        Field {
            name: "size",
            quantity: Quantity::Lengths,
            default: "",
            doc: "Full edges along its own x, y, z.",
            example: "[40.0, 20.0, 30.0]",
            at: |own| Value::Vector(&mut own.size),
        },
        Field::rotation(|own| Value::Turn(&mut own.rotation)),
    ];
}

impl OrientedBox {
    /// Half the edges, metres.
    pub fn half(&self) -> DVec3 {
        0.5 * self.size
    }
}

impl Body for OrientedBox {
    fn check(&mut self) -> Result<(), ShapeError> {
        given::check(self)
    }

    fn is_empty(&self) -> bool {
        self.size.min_element() <= 0.0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        let back = self.rotation.conjugate();
        let (o, d) = (back * (ray.origin - self.center), back * ray.direction);
        (0..3).try_fold(EVERYWHERE, |all, axis| Some(both([all, slab(o[axis], d[axis], self.half()[axis])?])))
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        let q = (self.rotation.conjugate() * (p - self.center)).abs() - self.half();
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
    }

    fn bounds(&self) -> Aabb {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| self.rotation * a);
        Aabb::around(self.center, (0..3).map(|i| self.half()[i] * axes[i].abs()).sum())
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
        self.rotation = (motion.rotation * self.rotation).normalize();
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let back = DMat3::from_quat(self.rotation.conjugate());
        let local = corners.map(|p| back * (p - self.center));
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let planes = axes.into_iter().zip(self.half().to_array()).flat_map(|(n, h)| [(n, h), (-n, h)]);
        !clipped(&local, planes).is_empty()
    }

    fn surface_mesh(&self, _: u32) -> Mesh {
        build::cuboid(self.center, self.half(), self.rotation)
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        Some(build::corners_of_box(self.center, DMat3::from_quat(self.rotation), self.half() + reach))
    }

    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        let axes = DMat3::from_quat(self.rotation);
        (0..3).flat_map(|i| ends(self.center - origin, axes.col(i), self.half()[i])).collect()
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        let axes = DMat3::from_quat(self.rotation);
        Rows {
            a: eye.place(self.center),
            b: eye.row(axes.x_axis, self.half().x),
            c: eye.row(axes.y_axis, self.half().y),
            d: eye.row(axes.z_axis, self.half().z),
        }
    }
}
