//! Volumes asked: each function is answered by the form ([`crate::geom::shape::form`]).

use glam::DVec3;

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        error::ShapeError,
        form::{
            Extent, Volume,
            body::{Rows, RowsEye},
        },
        mesh::Mesh,
        motion::Motion,
    },
};

impl Volume {
    /// Checks the numbers that it was given by, and makes directions and turns unit.
    pub(super) fn check(&mut self) -> Result<(), ShapeError> {
        self.body_mut().check()
    }

    /// Whether it has no volume: it holds no point and no ray meets it (hard case 21).
    pub fn is_empty(&self) -> bool {
        self.body().is_empty()
    }

    /// Whether it is convex: all but solids and flat lenses.
    pub fn is_convex(&self) -> bool {
        self.form().extent() == Extent::Convex
    }

    /// Whether it has an end on all sides.
    pub fn is_bounded(&self) -> bool {
        self.form().extent() != Extent::Endless
    }

    /// Whether the closed body holds `p`.
    pub fn contains(&self, p: DVec3) -> bool {
        self.body().contains(p)
    }

    /// Where the line of `ray` enters and leaves: inside for `entry ≤ t < exit`; of a solid, which it may leave and enter again
    /// in between, the first and the last crossing ([`crate::geom::shape::solid::Solid::crossings`] has all of them). Both may be negative (behind the
    /// origin). `None`: it misses. A ray without direction is everywhere inside or misses. A flat lens knows only the sight
    /// lines of its own eye, and their exit is infinite.
    pub fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        if self.is_empty() {
            return None;
        }
        self.body().entry_exit(ray).filter(|(entry, exit)| entry < exit)
    }

    /// Exact Euclidean distance to the border, metres, negative inside.
    pub fn signed_distance(&self, p: DVec3) -> f64 {
        self.body().signed_distance(p)
    }

    /// The smallest axis-aligned box around it; one around everything for a flat lens, which has no end.
    pub fn bounds(&self) -> Aabb {
        self.body().bounds()
    }

    /// The volume, turned and moved; of a flat lens with the eye that sees through it.
    #[must_use]
    pub fn placed(mut self, motion: &Motion) -> Self {
        if *motion != Motion::NONE {
            self.body_mut().move_by(motion);
        }
        self
    }

    /// Whether the closed triangle and the closed volume share a point, in f64: also where the triangle spans the volume with no corner
    /// and no edge inside.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        !self.is_empty() && self.body().meets_triangle(corners)
    }

    /// A closed mesh that holds the whole shape, convex where that is: what a renderer draws to reach all pixels of an analytic
    /// volume. Boxes, polytopes and solids: their faces exactly. Round ones: circumscribed, at most 4 % wider.
    /// Empty where the volume is, and for a flat lens, which no closed mesh holds.
    pub fn bounding_mesh(&self) -> Mesh {
        if self.is_empty() { Mesh::default() } else { self.body().bounding_mesh() }
    }

    /// A closed mesh with its corners on the shape's surface; `segments` (3..=1024) around a cylinder, and about as
    /// many around a sphere; of a flat lens none.
    pub fn surface_mesh(&self, segments: u32) -> Mesh {
        if self.is_empty() { Mesh::default() } else { self.body().surface_mesh(segments.clamp(3, 1024)) }
    }

    /// Corners of a convex body that holds all within `reach` metres of it; `None` where nothing is known but its box.
    pub fn corners_around(&self, reach: f64) -> Option<Vec<DVec3>> {
        self.body().corners_around(reach)
    }

    /// Its flat faces: it lies where n · (p − origin) ≤ d for each, n unit outwards; of what is not convex, those of a box around it.
    pub(in crate::geom) fn flat_faces(&self, origin: DVec3) -> Vec<(DVec3, f64)> {
        self.body().flat_faces(origin)
    }

    /// Where its round part does not hold `p` (relative to `origin`): a plane, as for [`Self::flat_faces`], that all of the
    /// part lies behind, and `p` before.
    pub(in crate::geom) fn parting_plane(&self, p: DVec3, origin: DVec3) -> Option<(DVec3, f64)> {
        self.body().parting_plane(p, origin)
    }

    /// Its numbers for an eye, as the struct in its WGSL file names them; further rows are appended to `more`.
    pub fn rows(&self, eye: &RowsEye, more: &mut Vec<[f32; 4]>) -> Rows {
        self.body().rows(eye, more)
    }
}
