//! Solids of any form, at their places.

use glam::{DMat3, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        form::body::{Body, Rows, RowsEye, ends},
        mesh::Mesh,
        motion::Motion,
        solid::PlacedSolid,
    },
};

impl Body for PlacedSolid {
    fn is_empty(&self) -> bool {
        false
    }

    fn contains(&self, p: DVec3) -> bool {
        self.solid.winding(self.local(p)) != 0
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        let crossings = self.solid.crossings(&self.local_ray(ray));
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        Some(crossings.iter().fold(ends, |(low, high), c| (low.min(c.t), high.max(c.t))))
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        let local = self.local(p);
        let distance = self.solid.distance(local);
        if self.solid.winding(local) != 0 { -distance } else { distance }
    }

    fn bounds(&self) -> Aabb {
        Aabb::from_points(self.solid.bounds().corners().map(|c| self.world(c)))
    }

    fn move_by(&mut self, motion: &Motion) {
        self.at = motion.point(self.at);
        self.rotation = (motion.rotation * self.rotation).normalize();
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        self.solid.meets_triangle(&corners.map(|p| self.local(p)))
    }

    fn surface_mesh(&self, _: u32) -> Mesh {
        let faces = self.solid.faces();
        Mesh {
            points: faces.iter().flatten().map(|p| self.world(*p)).collect(),
            triangles: (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        }
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        (reach <= 0.0).then(|| self.solid.bounds().corners().map(|c| self.world(c)).to_vec())
    }

    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        let (bounds, axes) = (self.solid.bounds(), DMat3::from_quat(self.rotation));
        let (center, half) = (self.world(bounds.center()), 0.5 * bounds.size());
        (0..3).flat_map(|i| ends(center - origin, axes.col(i), half[i])).collect()
    }

    fn rows(&self, eye: &RowsEye, _: &mut Vec<[f32; 4]>) -> Rows {
        let axes = DMat3::from_quat(self.rotation);
        let mut rows = Rows {
            a: eye.place(self.at),
            b: eye.row(axes.x_axis, f64::from(eye.stored)),
            c: eye.row(axes.y_axis, 0.0),
            d: eye.row(axes.z_axis, 0.0),
        };
        if !eye.is_orthographic {
            let own = self.local(eye.eye);
            let near = DVec3::splat(eye.near_m);
            let around = self.solid.bounds();
            let may_touch = own.cmpge(around.min - near).all() && own.cmple(around.max + near).all();
            let is_in_doubt = may_touch && self.solid.distance(own) < eye.near_m;
            // A quarter more says that the eye is all but on a face.
            rows.d[3] = self.solid.winding(own) as f32 + if is_in_doubt { 0.25 } else { 0.0 };
        }
        rows
    }
}
