//! Flat lenses, as volumes of the eye that sees through them.

use glam::{DQuat, DVec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        flat::{ENDLESS_M, Flat, FlatFigure, Sightlines},
        form::body::{Body, Rows, RowsEye},
        mesh::Mesh,
        motion::Motion,
    },
};

/// `figure` of `shape/flat.wgsl`.
const DISC: f32 = 0.0;
const RECTANGLE: f32 = 1.0;
const POLYGON: f32 = 2.0;

impl Body for Flat {
    fn is_empty(&self) -> bool {
        self.holds_nothing()
    }

    fn contains(&self, p: DVec3) -> bool {
        self.holds(p)
    }

    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        self.span(ray)
    }

    fn signed_distance(&self, p: DVec3) -> f64 {
        self.distance(p)
    }

    fn bounds(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::splat(ENDLESS_M))
    }

    fn move_by(&mut self, motion: &Motion) {
        self.center = motion.point(self.center);
        self.rotation = DQuat::normalize(motion.rotation * self.rotation);
        self.sight = match self.sight {
            Sightlines::From(eye) => Sightlines::From(motion.point(eye)),
            Sightlines::Along(direction) => Sightlines::Along(motion.rotation * direction),
        };
    }

    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        self.meets(corners)
    }

    // It has no end.
    fn surface_mesh(&self, _: u32) -> Mesh {
        Mesh::default()
    }

    /// The projective map from the picture to the figure's plane, as `span_of_flat` reads it, and the figure; the sides of a polygon
    /// are appended.
    fn rows(&self, eye: &RowsEye, more: &mut Vec<[f32; 4]>) -> Rows {
        let axes = eye.view_from_world * self.axes();
        let (normal, center) = (axes.z_axis, eye.view_from_world * (self.center() - eye.eye));
        let side = self.side();
        // Where the plane is crossed, times the weight w = weight.a: all have the sign that makes w positive.
        let (weight, depth, across): (DVec3, DVec3, [DVec3; 2]) = if eye.is_orthographic {
            // Rays begin at (x, y, 0) and go along -z; the axes sheared along them into the picture's plane.
            let slope = -normal.z;
            let sheared = [axes.x_axis, axes.y_axis].map(|axis| axis * slope + normal * axis.z);
            (
                DVec3::new(0.0, 0.0, -slope),
                DVec3::new(-normal.x, -normal.y, -normal.dot(center)),
                sheared.map(|axis| DVec3::new(axis.x, axis.y, axis.dot(center))),
            )
        } else {
            let reach = normal.dot(center);
            let turned = [axes.x_axis, axes.y_axis].map(|axis| axis * reach - normal * axis.dot(center));
            (normal, DVec3::new(0.0, 0.0, -reach), turned)
        };
        let signed = |v: DVec3| (side * v).as_vec3();
        let (size, kind) = match self.figure() {
            FlatFigure::Disc { radius } => ([*radius as f32, 0.0], DISC),
            FlatFigure::Rectangle { size } => ((0.5 * *size).as_vec2().to_array(), RECTANGLE),
            FlatFigure::Polygon { points } => {
                let size = [more.len() as f32, points.len() as f32];
                let next = points.iter().cycle().skip(1);
                more.extend(points.iter().zip(next).map(|(a, b)| {
                    let ([x, y], [z, w]) = (a.as_vec2().to_array(), b.as_vec2().to_array());
                    [x, y, z, w]
                }));
                (size, POLYGON)
            }
        };
        Rows {
            a: signed(depth).to_array(),
            b: signed(across[0]).extend(size[0]).to_array(),
            c: signed(across[1]).extend(size[1]).to_array(),
            d: signed(weight).extend(kind).to_array(),
        }
    }
}
