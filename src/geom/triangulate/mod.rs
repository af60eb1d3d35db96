//! Exact triangulation of faces on integer lattices.
//!
//! A face (an outer ring and holes, in space) becomes triangles over its own corners, or is refused with a reason.
//! All decisions are made on integers, so what comes out is proven, not hoped for:
//!
//! - every triangle has area and turns as the outer ring does;
//! - no two overlap, and together they cover exactly what the rings enclose;
//! - **canonical**: starting a ring elsewhere, reversing it, re-ordering the holes or moving the whole face by any
//!   integer vector gives the same set of triangles (hard case 14).
//!
//! ```text
//! ring ──> exact Newell normal ──> drop its largest axis ──> canonical start and turn ──> no repeats, no spikes
//!                                                                                               │
//!      simple, no holes, ≤ 32 corners: ear clipping (`ear`) <───────────────────────────────────┤
//!      anything else: constrained Delaunay + winding numbers (`cdt`) <──────────────────────────┘
//! ```
//!
//! Corners on a straight edge are kept: the neighbouring face has them too, and dropping them would open a crack.

mod cdt;
mod ear;

use crate::geom::exact::{cross, dot, newell, orient, twice_area};

/// Faces may extend over this many lattice units per axis: exact in `f64`, and `i128` has room for all sums.
pub const MAX_EXTENT: i64 = 1 << 50;
/// Up to this extent the distance of a corner from the face's plane is computed exactly.
const MAX_PLANAR_EXTENT: i64 = 1 << 40;
/// Rings up to this many corners are tried by ear clipping (cubic at worst), longer ones are not.
const MAX_EARS: usize = 32;

/// Why a face has no triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The outer ring has fewer than three distinct points.
    ShortRing,
    /// The outer ring encloses nothing: all its points are on one line.
    ZeroArea,
    /// A ring crosses itself or another one, or covers a place twice.
    SelfCrossing,
    /// No triangulation has exactly the area of the rings.
    AreaMismatch,
    /// The face extends over more than [`MAX_EXTENT`] units.
    TooLarge,
}

/// Facts about a face, found on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Exact Newell normal of the outer ring, as it was given: twice its vector area, in square lattice units.
    pub normal: [i128; 3],
    /// Whether all corners lie on exactly one plane.
    pub planar: bool,
    /// The distance of corners from the best plane across `normal`, lattice units (half the spread along it).
    pub deviation: f64,
    /// Holes without area, which were left out.
    pub holes_dropped: u32,
}

/// A corner in the plane: relative to the face's smallest coordinates, the dropped axis kept as `height`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Corner {
    at: [i64; 2],
    height: i64,
    /// Index into the caller's points.
    index: u32,
}

impl Corner {
    fn key(&self) -> ([i64; 2], i64) {
        (self.at, self.height)
    }
}

/// Triangulates faces, one after the other, without allocating for each.
#[derive(Debug, Default)]
pub struct Triangulator {
    /// Cleaned rings, one after the other, the outer one first and counter-clockwise, holes clockwise.
    corners: Vec<Corner>,
    /// Exclusive ends of the cleaned rings in `corners`.
    ends: Vec<u32>,
    ring: Vec<Corner>,
    /// Triangles as positions in `corners`, counter-clockwise.
    triangles: Vec<[u32; 3]>,
    ear: ear::Scratch,
}

impl Triangulator {
    /// Triangulates the face whose rings are `points[..ring_ends[0]]` (outer), `points[ring_ends[0]..ring_ends[1]]`, ...
    /// and appends triangles to `out` as indices into `points`; they turn as the outer ring does.
    ///
    /// On refusal nothing is appended.
    pub fn triangulate(
        &mut self,
        points: &[[i64; 3]],
        ring_ends: &[u32],
        out: &mut Vec<[u32; 3]>,
    ) -> Result<Face, Refusal> {
        let outer_end = ring_ends.first().map_or(0, |&end| end as usize);
        let outer = &points[..outer_end];
        if outer.len() < 3 {
            return Err(Refusal::ShortRing);
        }
        let (low, extent) = bounds(points).ok_or(Refusal::TooLarge)?;
        let normal = newell(outer);
        if normal == [0; 3] {
            return Err(reason_without_area(outer));
        }
        let mut face = Face { normal, planar: true, deviation: 0.0, holes_dropped: 0 };
        if points.len() == 3 {
            out.push([0, 1, 2]);
            return Ok(face);
        }
        (face.planar, face.deviation) = flatness(points, low, extent, normal);

        let axis = largest_axis(normal);
        let reversed = normal[axis] < 0;
        face.holes_dropped = self.load(points, ring_ends, low, axis, reversed)?;
        self.triangles.clear();
        self.fill()?;
        self.check()?;
        out.extend(self.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| self.corners[corner as usize].index);
            if reversed { [a, c, b] } else { [a, b, c] }
        }));
        Ok(face)
    }

    /// Projects, orders and cleans all rings; returns how many holes had no area.
    fn load(
        &mut self,
        points: &[[i64; 3]],
        ring_ends: &[u32],
        low: [i64; 3],
        axis: usize,
        reversed: bool,
    ) -> Result<u32, Refusal> {
        self.corners.clear();
        self.ends.clear();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut dropped = 0;
        let mut start = 0;
        for (number, &end) in ring_ends.iter().enumerate() {
            self.ring.clear();
            self.ring.extend((start..end).map(|index| {
                let p = points[index as usize];
                Corner { at: [p[u] - low[u], p[v] - low[v]], height: p[axis] - low[axis], index }
            }));
            start = end;
            let is_hole = number > 0;
            let backwards = if is_hole { twice_area(self.ring.iter().map(|c| c.at)) > 0 } else { reversed };
            if backwards {
                self.ring.reverse();
            }
            let first = least_rotation(self.ring.len(), |i| self.ring[i].key());
            self.ring.rotate_left(first);
            clean(&mut self.ring);
            if self.ring.len() >= 3 {
                self.corners.extend_from_slice(&self.ring);
                self.ends.push(self.corners.len() as u32);
            } else if is_hole {
                dropped += 1;
            } else {
                return Err(Refusal::ZeroArea);
            }
        }
        if self.ends.len() > 2 {
            self.sort_holes();
        }
        Ok(dropped)
    }

    /// Puts the holes into an order that depends on their points alone.
    fn sort_holes(&mut self) {
        let mut holes: Vec<&[Corner]> =
            self.ends.windows(2).map(|pair| &self.corners[pair[0] as usize..pair[1] as usize]).collect();
        holes.sort_by(|a, b| a.iter().map(Corner::key).cmp(b.iter().map(Corner::key)));
        let mut corners = self.corners[..self.ends[0] as usize].to_vec();
        let mut ends = vec![self.ends[0]];
        for hole in holes {
            corners.extend_from_slice(hole);
            ends.push(corners.len() as u32);
        }
        self.corners = corners;
        self.ends = ends;
    }

    /// Finds triangles for the cleaned rings.
    fn fill(&mut self) -> Result<(), Refusal> {
        if self.ends.len() == 1 {
            if self.corners.len() == 3 {
                self.triangles.push([0, 1, 2]);
                return Ok(());
            }
            if self.corners.len() == 4 && self.fill_quad() {
                return Ok(());
            }
            if self.corners.len() <= MAX_EARS && self.ear.clip(&self.corners, &mut self.triangles) {
                return Ok(());
            }
            self.triangles.clear();
        }
        cdt::fill(&self.corners, &self.ends, &mut self.triangles)
    }

    /// Splits four corners along the shorter diagonal that lies inside. Two triangles that turn left on either side of
    /// their common diagonal cannot overlap, so nothing else needs a test.
    fn fill_quad(&mut self) -> bool {
        let c = [0, 1, 2, 3].map(|i: usize| self.corners[i]);
        let turns_left = |a: usize, b: usize, d: usize| orient(c[a].at, c[b].at, c[d].at) > 0;
        let length = |a: usize, b: usize| {
            let d = [c[b].at[0] - c[a].at[0], c[b].at[1] - c[a].at[1]];
            dot(d, d) + i128::from(c[b].height - c[a].height).pow(2)
        };
        let by_02 = turns_left(0, 1, 2) && turns_left(0, 2, 3);
        let by_13 = turns_left(0, 1, 3) && turns_left(1, 2, 3);
        if by_02 && (!by_13 || length(0, 2) <= length(1, 3)) {
            self.triangles.extend([[0, 1, 2], [0, 2, 3]]);
        } else if by_13 {
            self.triangles.extend([[0, 1, 3], [1, 2, 3]]);
        }
        by_02 || by_13
    }

    /// The exact check at the end of either way: all triangles turn left and their areas add up to the rings'.
    fn check(&self) -> Result<(), Refusal> {
        let mut expected = 0;
        let mut start = 0;
        for &end in &self.ends {
            expected += twice_area(self.corners[start..end as usize].iter().map(|c| c.at));
            start = end as usize;
        }
        let mut covered = 0;
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| self.corners[corner as usize].at);
            let area = orient(a, b, c);
            if area <= 0 {
                return Err(Refusal::AreaMismatch);
            }
            covered += area;
        }
        if covered == expected { Ok(()) } else { Err(Refusal::AreaMismatch) }
    }
}

/// Smallest coordinates and largest extent; `None` beyond [`MAX_EXTENT`].
fn bounds(points: &[[i64; 3]]) -> Option<([i64; 3], i64)> {
    let (mut low, mut high) = (points[0], points[0]);
    for p in points {
        for i in 0..3 {
            low[i] = low[i].min(p[i]);
            high[i] = high[i].max(p[i]);
        }
    }
    let mut extent = 0;
    for i in 0..3 {
        extent = extent.max(high[i].checked_sub(low[i])?);
    }
    (extent <= MAX_EXTENT).then_some((low, extent))
}

/// The axis of the largest component; z before y before x where they are equal.
fn largest_axis(normal: [i128; 3]) -> usize {
    let [x, y, z] = normal.map(i128::abs);
    if z >= x && z >= y {
        2
    } else if y >= x {
        1
    } else {
        0
    }
}

/// The fault of a ring whose vector area is zero.
fn reason_without_area(ring: &[[i64; 3]]) -> Refusal {
    let base = ring[0];
    let Some(second) = ring.iter().find(|&&p| p != base) else { return Refusal::ShortRing };
    let away = |p: [i64; 3]| [p[0] - base[0], p[1] - base[1], p[2] - base[2]];
    let along = away(*second);
    let on_line = |p: [i64; 3]| {
        let p = away(p);
        [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| cross([along[i], along[j]], [p[i], p[j]]) == 0)
    };
    if !ring.iter().all(|&p| on_line(p)) {
        Refusal::SelfCrossing
    } else if ring.iter().any(|&p| p != base && p != *second) {
        Refusal::ZeroArea
    } else {
        Refusal::ShortRing
    }
}

/// Whether all points lie on one plane across `normal`, and half their spread along it, in lattice units.
fn flatness(points: &[[i64; 3]], low: [i64; 3], extent: i64, normal: [i128; 3]) -> (bool, f64) {
    let length = normal.map(|n| (n as f64).powi(2)).iter().sum::<f64>().sqrt();
    let relative = points.iter().map(|p| [p[0] - low[0], p[1] - low[1], p[2] - low[2]]);
    if extent <= MAX_PLANAR_EXTENT {
        let mut along = relative.map(|p| (0..3).map(|i| normal[i] * i128::from(p[i])).sum::<i128>());
        let first = along.next().unwrap_or(0);
        let (least, most) = along.fold((first, first), |(least, most), d| (least.min(d), most.max(d)));
        (least == most, 0.5 * (most - least) as f64 / length)
    } else {
        let along = relative.map(|p| (0..3).map(|i| normal[i] as f64 / length * p[i] as f64).sum::<f64>());
        let (least, most) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
        (false, 0.5 * (most - least))
    }
}

/// Where the lexicographically smallest rotation of a ring of `n` keys starts (linear, also for repeated keys).
pub fn least_rotation<K: Ord>(n: usize, key: impl Fn(usize) -> K) -> usize {
    let (mut best, mut rival, mut matched) = (0, 1, 0);
    while best < n && rival < n && matched < n {
        match key((best + matched) % n).cmp(&key((rival + matched) % n)) {
            std::cmp::Ordering::Equal => {
                matched += 1;
                continue;
            }
            std::cmp::Ordering::Greater => best += matched + 1,
            std::cmp::Ordering::Less => rival += matched + 1,
        }
        if best == rival {
            rival += 1;
        }
        matched = 0;
    }
    best.min(rival)
}

/// Removes repeated consecutive corners and spikes (edges that fold back onto themselves); the area stays the same.
fn clean(ring: &mut Vec<Corner>) {
    let mut kept = 0;
    for i in 0..ring.len() {
        let corner = ring[i];
        while kept >= 2 && is_spike(&ring[kept - 2], &ring[kept - 1], &corner) {
            kept -= 1;
        }
        if kept == 0 || ring[kept - 1].at != corner.at {
            ring[kept] = corner;
            kept += 1;
        }
    }
    ring.truncate(kept);
    // The same around the seam, from both sides.
    let mut start = 0;
    while ring.len() - start >= 2 {
        let live = &ring[start..];
        let n = live.len();
        if live[0].at == live[n - 1].at || is_spike(&live[n - 2], &live[n - 1], &live[0]) {
            ring.pop();
        } else if is_spike(&live[n - 1], &live[0], &live[1]) {
            start += 1;
        } else {
            break;
        }
    }
    ring.drain(..start);
}

/// Whether the way `a b c` turns back on itself at `b`.
fn is_spike(a: &Corner, b: &Corner, c: &Corner) -> bool {
    let along = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
    let onward = [c.at[0] - b.at[0], c.at[1] - b.at[1]];
    cross(along, onward) == 0 && dot(along, onward) < 0
}

#[cfg(test)]
mod tests;
