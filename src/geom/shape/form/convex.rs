//! Convex polytopes.

use glam::DVec3;

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        form::body::{Body, Rows, RowsEye},
        hull::Hull,
        mesh::Mesh,
        motion::Motion,
    },
    triangle::clipped,
};

impl Body for Hull {
    fn is_empty(&self) -> bool {
        false
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        self.span(ray)
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        self.distance(p)
    }

    fn bounds(&self) -> Aabb {
        Aabb::from_points(self.corners.iter().map(|p| *p + self.center))
    }

    fn move_by(&mut self, motion: &Motion) {
        let center = motion.point(self.center);
        self.center = center.round();
        // Near the corners, as it was: it keeps their digits.
        let rest = center - self.center;
        for corner in &mut self.corners {
            *corner = motion.rotation * *corner + rest;
        }
        for (normal, offset) in &mut self.planes {
            *normal = (motion.rotation * *normal).normalize_or(*normal);
            *offset += normal.dot(rest);
        }
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let (center, planes) = self.planes();
        let local = corners.map(|p| p - center);
        !clipped(&local, planes.iter().copied()).is_empty()
    }

    fn surface_mesh(&self, _: u32) -> Mesh {
        let (points, triangles) = self.faces();
        Mesh { points, triangles: triangles.to_vec() }
    }

    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        (reach <= 0.0).then(|| self.faces().0)
    }

    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        let (center, planes) = self.planes();
        planes.iter().map(|(normal, offset)| (*normal, offset + normal.dot(center - origin))).collect()
    }

    fn rows(&self, eye: &RowsEye, more: &mut Vec<[f32; 4]>) -> Rows {
        let (center, faces) = self.planes();
        let first = more.len();
        more.extend(faces.iter().map(|&(normal, offset)| eye.row(normal, offset + normal.dot(center - eye.eye))));
        Rows { b: [first as f32, faces.len() as f32, 0.0, 0.0], ..Rows::default() }
    }
}
