//! The questions that every form of a volume answers.

use glam::{DMat3, DVec3, Vec3};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{error::ShapeError, mesh::Mesh, motion::Motion},
};

/// A form of volumes, in model coordinates, asked by [`crate::geom::Volume`]. Only functions that say so are asked of an empty one.
pub trait Body {
    /// Checks the numbers that it was given by, and makes directions and turns unit; asked of anything.
    fn check(&mut self) -> Result<(), ShapeError> {
        Ok(())
    }

    /// Whether it has no volume; asked of anything.
    fn is_empty(&self) -> bool;

    /// Whether it holds `p`; asked of anything.
    fn contains(&self, p: DVec3) -> bool {
        self.signed_distance(p) <= 0.0 && !self.is_empty()
    }

    /// Where the line of a ray enters and leaves it; where it only touches, or misses, entry ≥ exit or nothing.
    fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)>;

    /// Distance to the border, metres, negative inside; asked of anything.
    fn signed_distance(&self, p: DVec3) -> f64;

    /// The box around it; asked of anything.
    fn bounds(&self) -> Aabb;

    /// Turns and moves it; asked of anything.
    fn move_by(&mut self, motion: &Motion);

    /// Whether a closed triangle and it share a point.
    fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool;

    /// A closed mesh that holds all of it; by default that of its surface.
    fn bounding_mesh(&self) -> Mesh {
        self.surface_mesh(BOUNDING_SIDES)
    }

    /// A closed mesh with its corners on the surface; as many segments around what is round.
    fn surface_mesh(&self, segments: u32) -> Mesh;

    /// Corners of a convex body that holds all within `reach` metres of it; by default nothing is known but its box.
    fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        let _ = reach;
        None
    }

    /// Its flat faces: it lies where n · (p − origin) ≤ d for each, n unit outwards; of what is not convex, those of a box around it.
    fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        let _ = origin;
        Vec::new()
    }

    /// Where its round part does not hold `p` (relative to `origin`): a plane, as for [`Self::flat_faces`], that all of the
    /// part lies behind, and `p` before.
    fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        let _ = (p, origin);
        None
    }

    /// Its numbers for an eye, as the struct in its WGSL file names them; further rows are appended to `more`.
    fn rows(&self, eye: &RowsEye, more: &mut Vec<[f32; 4]>) -> Rows;
}

/// The faces at both ends of an axis, as for [`Body::flat_faces`]; `center` is relative to the origin.
pub(super) fn ends(center: DVec3, axis: DVec3, half: f64) -> [(DVec3, f64); 2] {
    [axis, -axis].map(|normal| (normal, half + normal.dot(center)))
}

/// Sides of a cylinder's bounding prism.
pub const BOUNDING_SIDES: u32 = 48;

/// Rows of a region without its test: `Region` in `shaders/lib/region.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rows {
    /// First row: three numbers.
    pub a: [f32; 3],
    /// Second row.
    pub b: [f32; 4],
    /// Third row.
    pub c: [f32; 4],
    /// Last row.
    pub d: [f32; 4],
}

/// The eye that rows are made for, and places of other numbers of the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowsEye {
    /// Where it is, metres.
    pub eye: DVec3,
    /// Turns the world's axes into the view's.
    pub view_from_world: DMat3,
    /// Whether its rays are parallel.
    pub is_orthographic: bool,
    /// Its near plane, metres.
    pub near_m: f64,
    /// First entry of a solid.
    pub stored: u32,
}

impl RowsEye {
    /// A place, from the eye.
    pub fn place(&self, p: DVec3) -> [f32; 3] {
        (self.view_from_world * (p - self.eye)).as_vec3().to_array()
    }

    /// A direction.
    pub fn turn(&self, v: DVec3) -> Vec3 {
        (self.view_from_world * v).as_vec3()
    }

    /// A direction and a number.
    pub fn row(&self, v: DVec3, number: f64) -> [f32; 4] {
        self.turn(v).extend(number as f32).to_array()
    }
}
