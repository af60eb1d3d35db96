//! Solids of any form: concave, in several parts, touching or crossing themselves.
//!
//! A place is inside where the winding number of the surface about it is not 0. It is counted along the vertical line
//! upwards from the place: +1 for every face above that looks up there, −1 for every one that looks down. Which faces are
//! above is decided in plan, edge by edge, each edge alike for both faces that have it: nothing leaks between them. Columns
//! in plan hold the faces that stand over them.
//!
//! Files have small faults. Faces that are turned round are turned back, and holes are closed by fans, before any test.

mod columns;
mod form;
mod mend;
mod tree;

use std::sync::Arc;

use glam::{DQuat, DVec2, DVec3};
use robust::{Coord, orient2d};

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{
        error::ShapeError,
        limits::MAX_FACES,
        mesh::Mesh,
        solid::{
            columns::Columns,
            tree::{Tree, upward},
        },
    },
    triangle::nearest_to_origin,
};

pub use form::{Bitmap, prism, stacked};

/// A solid in its own coordinates, metres, rounded to f32: to 2⁻²⁴ of its extent. What every adapter computes with, to the bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    faces: Vec<[DVec3; 3]>,
    bounds: Aabb,
    columns: Columns,
    /// Faces that closed holes.
    pub mended: usize,
}

/// A solid at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedSolid {
    /// In its own coordinates.
    pub solid: Arc<Solid>,
    /// Turns its axes into the world's.
    pub rotation: DQuat,
    /// Where its origin is, metres.
    pub at: DVec3,
}

/// Where a line crosses a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCrossing {
    /// Along the ray, in lengths of its direction; may be negative.
    pub t: f64,
    /// +1 where the line enters through the face, −1 where it leaves.
    pub step: i32,
}

impl Solid {
    /// The union of closed bodies, faces counter-clockwise from outside: each is oriented, closed and moved by `-origin`.
    pub fn new(bodies: &[Mesh], origin: DVec3) -> Result<Self, ShapeError> {
        let count: usize = bodies.iter().map(|b| b.triangles.len()).sum();
        if count > MAX_FACES {
            return Err(ShapeError::ManyFaces(count));
        }
        let (mut faces, mut mended) = (Vec::with_capacity(count), 0);
        for body in bodies {
            if !body.points.iter().all(|p| p.is_finite()) {
                return Err(ShapeError::NotFinite);
            }
            let points: Vec<DVec3> = body.points.iter().map(|p| (*p - origin).as_vec3().as_dvec3()).collect();
            let (closed, added) = mend::closed(&points, &body.triangles);
            mended += added;
            faces.extend(closed);
        }
        Self::of_faces(faces, mended)
    }

    /// Of faces that close a body between them, also where corners of some stand on edges of others.
    fn of_faces(faces: Vec<[DVec3; 3]>, mended: usize) -> Result<Self, ShapeError> {
        if faces.len() > MAX_FACES {
            return Err(ShapeError::ManyFaces(faces.len()));
        }
        let volume: f64 = faces.iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
        let bounds = Aabb::from_points(faces.iter().flatten().copied());
        if faces.is_empty() || volume.abs() <= 1e-9 * bounds.size().max_element().powi(3) {
            return Err(ShapeError::NoBody);
        }
        let columns = Columns::new(&faces, &bounds);
        Ok(Self { faces, bounds, columns, mended })
    }

    /// Its faces, counter-clockwise from outside; own coordinates, each of which an f32 holds.
    pub fn faces(&self) -> &[[DVec3; 3]] {
        &self.faces
    }

    /// The box around it, own coordinates.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// What `shape/solid.wgsl` reads, in fours of words: the columns, the boxes around its faces, and the faces.
    pub fn words(&self) -> Vec<[u32; 4]> {
        let tree = Tree::new(&self.faces);
        let [grid, starts, numbers] = self.columns.words(&tree.places());
        let nodes = tree.node_words();
        let mut words = grid;
        let numbers_at = words.len() + 1 + starts.len();
        let nodes_at = numbers_at + numbers.len();
        let faces_at = nodes_at + nodes.len();
        words[1][2] = numbers_at as u32;
        words.push([nodes_at as u32, nodes.len() as u32 / 2, faces_at as u32, 0]);
        for part in [starts, numbers, nodes, tree.face_words(self)] {
            words.extend(part);
        }
        words
    }

    /// The winding number of the surface about a place, own coordinates. A place on a face that looks up or down is inside of
    /// it; on a face that stands upright it is as the place next to it is, towards +x or, where the face runs along x, −y. What
    /// is drawn asks for the places beside it as well (`shape/solid.wgsl`): there upright faces hold what is on them, too.
    pub fn winding(&self, p: DVec3) -> i32 {
        let above = |face: &u32| {
            let corners = &self.faces[*face as usize];
            let turns = turns(corners.map(DVec3::truncate), p.truncate());
            if turns == 0 || !stands_above(corners, turns, p) { 0 } else { turns }
        };
        self.columns.at(p.truncate()).iter().map(above).sum()
    }

    /// All crossings of a line with the surface, own coordinates, in no order. Each edge is decided alike for both of its
    /// faces, exactly: entries and exits balance.
    pub fn crossings(&self, ray: &Ray) -> Vec<FaceCrossing> {
        let d = ray.direction;
        if d == DVec3::ZERO || !d.is_finite() || !ray.origin.is_finite() {
            return Vec::new();
        }
        // Along the main axis the line is a point in the plane of the other two, to which all corners are sheared.
        let axis = (0..3).max_by(|a, b| d[*a].abs().total_cmp(&d[*b].abs())).unwrap_or(2);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let sheared = |p: DVec3| {
            let r = p - ray.origin;
            DVec2::new(r[u] - r[axis] * (d[u] / d[axis]), r[v] - r[axis] * (d[v] / d[axis]))
        };
        let crossing = |corners: &[DVec3; 3]| {
            let turns = turns(corners.map(sheared), DVec2::ZERO);
            if turns == 0 {
                return None;
            }
            let [a, b, c] = *corners;
            let normal = (b - a).cross(c - a);
            let t = normal.dot(a - ray.origin) / normal.dot(d);
            // Seen along +axis a counter-clockwise face looks back at us along -axis only if the axis points at us.
            let step = if d[axis] > 0.0 { -turns } else { turns };
            t.is_finite().then_some(FaceCrossing { t, step })
        };
        self.faces.iter().filter_map(crossing).collect()
    }

    /// How far the surface is from a place, own coordinates, metres, ≥ 0.
    pub fn distance(&self, p: DVec3) -> f64 {
        let to = |[a, b, c]: &[DVec3; 3]| nearest_to_origin(*a - p, *b - p, *c - p).length_squared();
        self.faces.iter().map(to).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Whether a closed triangle, own coordinates, and the solid share a point.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let bounds = Aabb::from_points(*corners);
        if !bounds.meets(&self.bounds) {
            return false;
        }
        if corners.iter().any(|p| self.winding(*p) != 0) {
            return true;
        }
        let near = self.faces.iter().filter(|face| Aabb::from_points(**face).meets(&bounds));
        near.into_iter().any(|face| triangles_meet(face, corners))
    }
}

impl PlacedSolid {
    /// A place of the world in the solid's own coordinates.
    pub fn local(&self, p: DVec3) -> DVec3 {
        self.rotation.conjugate() * (p - self.at)
    }

    /// A place of the solid in the world.
    pub fn world(&self, p: DVec3) -> DVec3 {
        self.at + self.rotation * p
    }

    /// A ray of the world in the solid's own coordinates.
    pub fn local_ray(&self, ray: &Ray) -> Ray {
        Ray { origin: self.local(ray.origin), direction: self.rotation.conjugate() * ray.direction }
    }
}

/// How often a triangle turns counter-clockwise around a place: −1, 0 or 1. A line from the place towards +y decides, edge by
/// edge; the sign of an edge is exact and the same for both triangles that have it.
fn turns(corners: [DVec2; 3], at: DVec2) -> i32 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    (0..3)
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a.x <= at.x) == (b.x <= at.x) {
                return 0;
            }
            let (left, right, turn) = if a.x < b.x { (a, b, -1) } else { (b, a, 1) };
            if orient2d(coord(left), coord(right), coord(at)) < 0.0 { turn } else { 0 }
        })
        .sum()
}

/// Whether a face under or over which a place lies stands above it; what is on it counts as below where it looks up.
fn stands_above(corners: &[DVec3; 3], turns: i32, p: DVec3) -> bool {
    let (normal, rise) = upward(corners);
    let height = normal.dot(p - corners[0]) - rise;
    height < 0.0 || (height == 0.0 && turns > 0)
}

/// Whether two closed triangles share a point: if so, an edge of one meets the other, or both lie in one plane and overlap.
fn triangles_meet(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let edges = |t: &[DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    edges(a).iter().any(|e| segment_meets(e, b)) || edges(b).iter().any(|e| segment_meets(e, a))
}

/// Whether a closed segment and a closed triangle share a point.
fn segment_meets([p, q]: &[DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let coord = |v: DVec3| robust::Coord3D { x: v.x, y: v.y, z: v.z };
    let side = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| robust::orient3d(coord(a), coord(b), coord(c), coord(d));
    let [a, b, c] = *triangle;
    let (sp, sq) = (side(a, b, c, *p), side(a, b, c, *q));
    if (sp > 0.0 && sq > 0.0) || (sp < 0.0 && sq < 0.0) {
        return false;
    }
    if sp == 0.0 && sq == 0.0 {
        // In the triangle's plane, along the axis that shows most of it.
        let normal = (b - a).cross(c - a).abs();
        let axis = (0..3).max_by(|i, j| normal[*i].total_cmp(&normal[*j])).unwrap_or(2);
        let flat = |v: DVec3| DVec2::new(v[(axis + 1) % 3], v[(axis + 2) % 3]);
        let corners = triangle.map(flat);
        return flat_segments_meet([flat(*p), flat(*q)], corners);
    }
    let around = [side(*p, *q, a, b), side(*p, *q, b, c), side(*p, *q, c, a)];
    around.iter().all(|s| *s >= 0.0) || around.iter().all(|s| *s <= 0.0)
}

fn flat_segments_meet([p, q]: [DVec2; 2], corners: [DVec2; 3]) -> bool {
    let side = |a: DVec2, b: DVec2, c: DVec2| {
        orient2d(Coord { x: a.x, y: a.y }, Coord { x: b.x, y: b.y }, Coord { x: c.x, y: c.y })
    };
    let between = |a: DVec2, b: DVec2, c: DVec2| c.cmpge(a.min(b)).all() && c.cmple(a.max(b)).all();
    let crosses = |a: DVec2, b: DVec2| {
        let (s, t, u, v) = (side(a, b, p), side(a, b, q), side(p, q, a), side(p, q, b));
        (s * t < 0.0 && u * v < 0.0)
            || (s == 0.0 && between(a, b, p))
            || (t == 0.0 && between(a, b, q))
            || (u == 0.0 && between(p, q, a))
            || (v == 0.0 && between(p, q, b))
    };
    let [a, b, c] = corners;
    let signs = [side(a, b, p), side(b, c, p), side(c, a, p)];
    let is_within = signs.iter().all(|s| *s >= 0.0) || signs.iter().all(|s| *s <= 0.0);
    is_within || crosses(a, b) || crosses(b, c) || crosses(c, a)
}

#[cfg(test)]
mod tests;
