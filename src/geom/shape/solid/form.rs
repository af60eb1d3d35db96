//! Solids made from figures in plan: polygons and bitmaps that are given a height.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::geom::{
    shape::{error::ShapeError, solid::Solid},
    triangulate::Triangulator,
};

/// A picture of yes and no; rows from north to south.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    /// Width and height.
    pub size: [u32; 2],
    /// Row by row.
    pub bits: Vec<bool>,
}

impl Bitmap {
    /// Whether a cell is in; `y` counts from the south. Beside the picture nothing is.
    fn holds(&self, x: i64, y: i64) -> bool {
        let [w, h] = self.size.map(i64::from);
        (0..w).contains(&x) && (0..h).contains(&y) && self.bits[((h - 1 - y) * w + x) as usize]
    }
}

/// What stands over a polygon between `base` and `base + height`, metres: the outer ring, then holes. Corners are rounded to
/// what an f32 holds of their distance from `origin`.
pub fn prism(rings: &[Vec<DVec2>], base: f64, height: f64, origin: DVec3) -> Result<Solid, ShapeError> {
    if !(rings.iter().flatten().all(|p| p.is_finite()) && base.is_finite() && height.is_finite()) {
        return Err(ShapeError::NotFinite);
    }
    let reach = rings.iter().flatten().map(|p| (*p - origin.truncate()).abs().max_element()).fold(1.0, f64::max);
    // A power of two, of which the corners are whole multiples of less than 2^24.
    let step = 2_f64.powi(reach.log2().ceil() as i32 - 23);
    let mut corners: Vec<[i64; 3]> = Vec::new();
    let mut ends = Vec::new();
    for ring in rings {
        corners.extend(ring.iter().map(|p| {
            let at = ((*p - origin.truncate()) / step).round();
            [at.x as i64, at.y as i64, 0]
        }));
        ends.push(corners.len() as u32);
    }
    let mut cap = Vec::new();
    Triangulator::default().triangulate(&corners, &ends, &mut cap).map_err(ShapeError::Ring)?;
    let at = |i: u32| DVec2::new(corners[i as usize][0] as f64, corners[i as usize][1] as f64) * step;
    let first = cap.first().map(|t| t.map(at)).unwrap_or_default();
    if (first[1] - first[0]).perp_dot(first[2] - first[0]) < 0.0 {
        cap.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let [low, high] = [base, base + height].map(|z| f64::from((z - origin.z) as f32));
    let mut faces = Vec::with_capacity(4 * cap.len());
    let mut around: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for t in &cap {
        let [a, b, c] = t.map(at);
        faces.push([a.extend(high), b.extend(high), c.extend(high)]);
        faces.push([a.extend(low), c.extend(low), b.extend(low)]);
        for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            let (key, sense) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *around.entry(key).or_default() += sense;
        }
    }
    for ([a, b], sense) in around.into_iter().filter(|(_, sense)| *sense != 0) {
        let (a, b) = if sense > 0 { (at(a), at(b)) } else { (at(b), at(a)) };
        faces.extend(quad([a.extend(low), b.extend(low), b.extend(high), a.extend(high)]));
    }
    Solid::of_faces(faces, 0)
}

/// The cells of a mask: bitmaps of one size, bottom to top, in the box at `corner` (south-west, below) of this `size`.
pub fn stacked(layers: &[Bitmap], [corner, size]: [DVec3; 2], origin: DVec3) -> Result<Solid, ShapeError> {
    let count = layers.first().map_or([0, 0], |l| l.size);
    if let Some(i) = layers.iter().position(|l| l.size != count) {
        return Err(ShapeError::Layers(i, layers[i].size, count));
    }
    let line = |axis: usize, cells: u32| -> Vec<f64> {
        let at = |i: u32| corner[axis] + size[axis] * f64::from(i) / f64::from(cells) - origin[axis];
        (0..=cells).map(|i| f64::from(at(i) as f32)).collect()
    };
    let lines = [line(0, count[0]), line(1, count[1]), line(2, layers.len() as u32)];
    let holds =
        |p: [i64; 3]| usize::try_from(p[2]).ok().and_then(|z| layers.get(z)).is_some_and(|l| l.holds(p[0], p[1]));
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let cells = |axis: usize| lines[axis].len() as i64 - 1;
        for k in 0..=cells(axis) {
            // Between the cells k - 1 and k: 1 looks along the axis, −1 against it.
            let looks = |i: i64, j: i64| {
                let mut cell = [0; 3];
                (cell[axis], cell[u], cell[v]) = (k, i, j);
                let after = holds(cell);
                cell[axis] = k - 1;
                i32::from(holds(cell)) - i32::from(after)
            };
            for (sense, [i0, i1], [j0, j1]) in rectangles(cells(u), cells(v), looks) {
                let corner = |i: i64, j: i64| {
                    let mut p = DVec3::ZERO;
                    (p[axis], p[u], p[v]) = (lines[axis][k as usize], lines[u][i as usize], lines[v][j as usize]);
                    p
                };
                let ring = [corner(i0, j0), corner(i1, j0), corner(i1, j1), corner(i0, j1)];
                faces.extend(quad(if sense > 0 { ring } else { [ring[0], ring[3], ring[2], ring[1]] }));
            }
        }
    }
    if faces.is_empty() {
        return Err(ShapeError::EmptyMask);
    }
    Solid::of_faces(faces, 0)
}

fn quad([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// Rectangles of cells that have one value, not 0: runs along the first direction, and runs that are alike put together.
fn rectangles(across: i64, along: i64, value: impl Fn(i64, i64) -> i32) -> Vec<(i32, [i64; 2], [i64; 2])> {
    let mut done: Vec<(i32, [i64; 2], [i64; 2])> = Vec::new();
    let mut open: Vec<(i32, [i64; 2], i64)> = Vec::new();
    for j in 0..=along {
        let mut runs: Vec<(i32, [i64; 2])> = Vec::new();
        let mut i = 0;
        while j < along && i < across {
            let here = value(i, j);
            let first = i;
            while i < across && value(i, j) == here {
                i += 1;
            }
            if here != 0 {
                runs.push((here, [first, i]));
            }
        }
        let mut next = Vec::with_capacity(runs.len());
        for (sense, run) in &runs {
            let begun = open.iter().find(|(s, r, _)| (s, r) == (sense, run)).map_or(j, |(.., begun)| *begun);
            next.push((*sense, *run, begun));
        }
        let ended = open.iter().filter(|(s, r, _)| !runs.contains(&(*s, *r)));
        done.extend(ended.map(|(sense, run, begun)| (*sense, *run, [*begun, j])));
        open = next;
    }
    done
}
