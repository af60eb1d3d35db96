//! Meshes fine enough for deformations: the reference of what the renderer does.
//!
//! A mesh is refined by halving edges. Whether an edge is halved is asked of its two ends alone, in an order of their own, and its
//! middle is ½(a + b): both neighbours find the same, to the bit, so no crack can open, whatever the order of triangles and corners
//! (hard case 18). A triangle with 0..=3 halved edges becomes 1..=4 triangles, and all is asked again of those:
//!
//! ```text
//!       c              c              c              c
//!      / \            /|\            / \            / \        with two halved edges, and three, what is
//!     /   \          / | \          m---n          m---n       left (a b n m; k and the corner across the longest
//!    /     \        /  |  \        / `.  \        / \ / \      edge) is cut by its shorter diagonal; corners are taken
//!   a-------b      a---m---b      a----`--b      a---k---b     in the order of their places, should they be alike
//! ```
//!
//! An edge is halved iff it meets the support of a deformation and its predicted chord error ([`Refiner::halves`]) is more than the
//! tolerance, in pixels. A triangle none of whose edges is halved, but in the middle of which the deformation bends it (a small lens on a
//! large triangle), gets a point inside if that is off by more than twice the tolerance (where edges just keep it, the inside may be 4/3 of it off). What does not meet a support is left as it is.

mod chord;
mod split;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DMat3, DVec3};
use rayon::prelude::*;

pub use chord::{Chord, Refiner, order};

use crate::geom::deform::{Deformers, cofactor, refine::split::Split};

/// Triangles that are taken on by one thread at a time.
const BATCH: usize = 64;
/// By how much the tolerance is raised where there are too many triangles, and how often; then the shortest edge likewise.
const COARSER: f64 = 4.0;
const COARSENINGS: u32 = 8;
const LONGER_M: f64 = 0.01;

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Edges that are shorter than this are not halved, metres, > 0.
    pub shortest_m: f64,
    /// How many triangles there may be in place of those that meet a support.
    pub triangles: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { shortest_m: 0.01, triangles: 4_000_000 }
    }
}

/// A corner of a refined mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinedVertex {
    /// Where it is without deformation, metres of the world.
    pub rest: DVec3,
    /// Where it is shown, θ(rest).
    pub shown: DVec3,
    /// cof(J) at rest: takes normals at rest to those shown, but for their length.
    pub normals: DMat3,
    /// The triangle it is in, of those given.
    pub source: u32,
    /// What its three corners count for there, in their order, adding up to 1: any attribute is mixed by them.
    pub weights: DVec3,
}

/// A refined mesh. Corners are shared within what one triangle became, and equal to the bit between neighbours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refined {
    /// Triangles given that meet no support, ascending: drawn as they are.
    pub kept: Vec<u32>,
    /// Corners of the others.
    pub vertices: Vec<RefinedVertex>,
    /// The others, by `vertices`, turned as they were given, in their order.
    pub triangles: Vec<[u32; 3]>,
    /// How it went.
    pub report: Report,
}

/// What was asked for and what was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Tolerance that was kept, pixels: more than was asked for where there would have been too many triangles.
    pub tolerance_px: f64,
    /// The shortest edge that was halved, metres: longer for the same reason.
    pub shortest_m: f64,
    /// Edges and triangles that are worse than the tolerance because they are short; counted once for each triangle they were in.
    pub too_coarse: usize,
    /// Triangles that were left as they are because a corner is not finite or does not exist.
    pub unusable: usize,
}

/// Refines a mesh until no edge is worse than `tolerance_px`.
///
/// `pixels_per_m` says how many pixels a metre has at a place where it is shown (focal length in pixels by distance, the distance at least
/// that of the near plane): finite, ≥ 0.
pub fn refined(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    deformers: &Deformers,
    pixels_per_m: &(dyn Fn(DVec3) -> f64 + Sync),
    tolerance_px: f64,
    limits: Limits,
) -> Refined {
    let mut refiner = Refiner { deformers, pixels_per_m, tolerance_px, shortest_m: limits.shortest_m };
    let mut attempt = 0;
    loop {
        // The last attempt halves nothing, and cannot have too many.
        let most = if refiner.shortest_m == f64::INFINITY { usize::MAX } else { limits.triangles };
        if let Some(refined) = refiner.all(positions, triangles, most) {
            return refined;
        }
        attempt += 1;
        match attempt / COARSENINGS {
            0 => refiner.tolerance_px *= COARSER,
            1 => refiner.shortest_m = COARSER * refiner.shortest_m.max(LONGER_M),
            _ => refiner.shortest_m = f64::INFINITY,
        }
    }
}

impl Refiner<'_> {
    /// `None` if there are more triangles than `most`.
    fn all(&self, positions: &[DVec3], triangles: &[[u32; 3]], most: usize) -> Option<Refined> {
        let count = AtomicUsize::new(0);
        let batch = |(batch, part): (usize, &[[u32; 3]])| {
            let mut refined = Refined::default();
            for (i, triangle) in part.iter().enumerate() {
                if count.load(Ordering::Relaxed) > most {
                    return refined;
                }
                let before = refined.triangles.len();
                self.one(positions, triangle, (batch * BATCH + i) as u32, most, &mut refined);
                count.fetch_add(refined.triangles.len() - before, Ordering::Relaxed);
            }
            refined
        };
        let batches: Vec<Refined> = triangles.par_chunks(BATCH).enumerate().map(batch).collect();
        if count.into_inner() > most {
            return None;
        }
        let mut all = Refined::default();
        for batch in batches {
            all.append(batch);
        }
        all.report.tolerance_px = self.tolerance_px;
        all.report.shortest_m = self.shortest_m;
        Some(all)
    }

    /// Refines one triangle.
    fn one(&self, positions: &[DVec3], triangle: &[u32; 3], source: u32, most: usize, to: &mut Refined) {
        let corners = triangle.map(|i| positions.get(i as usize).copied().filter(|p| p.is_finite()));
        let [Some(a), Some(b), Some(c)] = corners else {
            to.report.unusable += 1;
            to.kept.push(source);
            return;
        };
        let corners = [a, b, c];
        if !self.meets_triangle(&corners) {
            to.kept.push(source);
            return;
        }
        let split = Split::of(self, corners, most);
        let first = to.vertices.len() as u32;
        to.vertices.extend(split.vertices.iter().map(|vertex| RefinedVertex {
            rest: vertex.rest,
            shown: vertex.shown,
            normals: cofactor(&self.deformers.jacobian(vertex.rest)),
            source,
            weights: vertex.weights,
        }));
        to.triangles.extend(split.triangles.iter().map(|corners| corners.map(|i| first + i)));
        to.report.too_coarse += split.too_coarse;
    }
}

impl Refined {
    fn append(&mut self, other: Self) {
        let first = self.vertices.len() as u32;
        self.kept.extend(other.kept);
        self.vertices.extend(other.vertices);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|i| first + i)));
        self.report.too_coarse += other.report.too_coarse;
        self.report.unusable += other.report.unusable;
    }
}
