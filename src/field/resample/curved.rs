//! Grids of curved cells: the inverse of the bilinear or trilinear map of each.

use glam::{DMat3, DVec3};

use crate::field::{
    data::Values,
    grid::{Grid, MOST_PER_AXIS, cells_of, checked_size},
    resample::{MOST_SAMPLES, aligned, bounds, corners},
};

/// Samples of the new grid for each of the file, at most.
const MOST_FINER: usize = 4;
/// Tries to find a sample in a cell, for each cell and sample, at most: more are cells that lie over each other.
const MOST_TRIES: usize = 64;
/// Steps of Newton's method; four do for cells that are nearly boxes.
const ITERATIONS: usize = 12;
/// How far outside a cell a sample may be, in cells.
const NEAR: f64 = 1e-6;

/// Where the samples of a regular grid lie in the cells of the file's.
pub struct Curved {
    size: [usize; 3],
    /// The axis of space along which all lies in one plane.
    flat_axis: Option<usize>,
    /// For each sample of the regular grid: its cell, and where in it, 0 to 1 along each axis.
    places: Vec<Option<Place>>,
}

#[derive(Clone, Copy)]
struct Place {
    cell: u32,
    part: [f32; 3],
}

impl Curved {
    /// The regular grid over these places, x fastest, and how to get there.
    pub fn new(size: [usize; 3], points: &[DVec3]) -> Result<(Grid, Self), String> {
        checked_size(size)?;
        if points.len() != size.iter().product::<usize>() {
            return Err("the grid has not as many samples as places".into());
        }
        let Some(ends) = bounds(points.iter()) else {
            return Err("no place of the grid is finite".into());
        };
        let extent = ends[1] - ends[0];
        let axes = size.iter().filter(|n| **n > 1).count();
        let least = if extent.x <= extent.y.min(extent.z) { 0 } else { 1 + usize::from(extent.z < extent.y) };
        let flat_axis = match axes {
            0 | 1 => return Err("the places of the grid lie along a line; two axes or three are needed".into()),
            2 => Some(least),
            _ => None,
        };
        let widths = [extent.x, extent.y, extent.z];
        let is_wide = |axis: usize| Some(axis) == flat_axis || (widths[axis] > 0.0 && widths[axis].is_finite());
        if !(0..3).all(is_wide) {
            return Err("the places of the grid lie in a flat volume; its three axes must span one".into());
        }
        let grid = aligned(even_size(size, points, widths, flat_axis), ends)?;
        let mut curved = Self { size, flat_axis, places: vec![None; grid.count()] };
        curved.place(&grid, points)?;
        Ok((grid, curved))
    }

    /// Whether all lies in one plane.
    pub fn is_flat(&self) -> bool {
        self.flat_axis.is_some()
    }

    /// Finds the cell of each sample.
    fn place(&mut self, grid: &Grid, points: &[DVec3]) -> Result<(), String> {
        let cells = cells_of(self.size);
        let count = cells.iter().product::<usize>();
        let mut tries = (count + grid.count()) * MOST_TRIES;
        for cell in 0..count {
            let at = split(cell, cells);
            let Some(corners) = self.corners(points, at) else { continue };
            let range = self.range(grid, &corners);
            let samples: usize = range.iter().map(|[from, to]| (to + 1).saturating_sub(*from)).product();
            tries = tries.checked_sub(samples).ok_or("the cells of the curved grid lie over each other")?;
            let [[x0, x1], [y0, y1], [z0, z1]] = range;
            for z in z0..=z1 {
                for y in y0..=y1 {
                    for x in x0..=x1 {
                        let index = x + grid.size[0] * (y + grid.size[1] * z);
                        let Some(place @ None) = self.places.get_mut(index) else { continue };
                        let mut sample = grid.position(DVec3::new(x as f64, y as f64, z as f64));
                        if let Some(axis) = self.flat_axis {
                            sample[axis] = 0.0;
                        }
                        let found = within(&corners, sample);
                        *place = found.map(|part| Place { cell: cell as u32, part: part.as_vec3().to_array() });
                    }
                }
            }
        }
        Ok(())
    }

    /// The places of a cell's corners, if all are finite; one that is flat has its other side at a distance of 1.
    fn corners(&self, points: &[DVec3], cell: [usize; 3]) -> Option<[DVec3; 8]> {
        let indices = corners(self.size, cell);
        let thin = (0..3).find(|axis| self.size[*axis] == 1);
        let mut all = [DVec3::ZERO; 8];
        for (corner, (place, index)) in all.iter_mut().zip(indices).enumerate() {
            *place = points.get(index).copied().filter(|p| p.is_finite())?;
            if let (Some(axis), Some(thin)) = (self.flat_axis, thin) {
                place[axis] = if corner >> thin & 1 == 1 { 1.0 } else { 0.0 };
            }
        }
        Some(all)
    }

    /// The first and the last sample along each axis that may be in a cell.
    fn range(&self, grid: &Grid, corners: &[DVec3; 8]) -> [[usize; 2]; 3] {
        let [min, max] = bounds(corners.iter()).unwrap_or_default();
        std::array::from_fn(|axis| {
            if Some(axis) == self.flat_axis {
                return [0, 0];
            }
            let count = |coordinate: f64| (coordinate - grid.origin[axis]) / grid.steps[axis][axis];
            let near = 1e-6;
            let first = (count(min[axis]) - near).ceil().max(0.0) as usize;
            [first, ((count(max[axis]) + near).floor().max(0.0) as usize).min(grid.size[axis] - 1)]
        })
    }

    /// The values on the regular grid.
    pub fn values(&self, values: &Values, components: usize) -> Values {
        let mut all = Vec::with_capacity(self.places.len() * components);
        let cells = cells_of(self.size);
        for place in &self.places {
            let Some(Place { cell, part }) = place else {
                all.extend(std::iter::repeat_n(f32::NAN, components));
                continue;
            };
            let indices = corners(self.size, split(*cell as usize, cells));
            let weights: [f64; 8] = std::array::from_fn(|corner| weight(part.map(f64::from), corner));
            for c in 0..components {
                let weighted = indices.iter().zip(weights).filter(|(_, weight)| *weight > 1e-9);
                all.push(weighted.map(|(i, w)| f64::from(values.get(i * components + c)) * w).sum::<f64>() as f32);
            }
        }
        Values::F32(all)
    }
}

/// What of a corner's value is in that of a place in a cell.
fn weight(part: [f64; 3], corner: usize) -> f64 {
    (0..3).map(|axis| if corner >> axis & 1 == 1 { part[axis] } else { 1.0 - part[axis] }).product()
}

fn split(index: usize, size: [usize; 3]) -> [usize; 3] {
    [index % size[0], index / size[0] % size[1], index / size[0] / size[1]]
}

/// Samples along each axis of space that are about as fine as the file's.
fn even_size(size: [usize; 3], points: &[DVec3], widths: [f64; 3], flat_axis: Option<usize>) -> [usize; 3] {
    // The mean change of each coordinate along each axis of the grid; the axis that changes it most says how fine it is.
    let mut steps = [0.0_f64; 3];
    let mut stride = 1;
    for n in size {
        let pairs = points.iter().zip(points.iter().skip(stride));
        let changes = pairs.enumerate().filter(|(i, _)| i / stride % n + 1 < n).map(|(_, (a, b))| (*b - *a).abs());
        let (sum, count) = changes.filter(|c| c.is_finite()).fold((DVec3::ZERO, 0), |(sum, n), c| (sum + c, n + 1));
        for (axis, step) in steps.iter_mut().enumerate() {
            *step = step.max(sum[axis] / f64::from(count.max(1)));
        }
        stride *= n;
    }
    let mut counts: [f64; 3] = std::array::from_fn(|axis| match flat_axis == Some(axis) {
        true => 1.0,
        false => ((widths[axis] / steps[axis]).round() + 1.0).clamp(2.0, MOST_PER_AXIS as f64),
    });
    let most = points.len().saturating_mul(MOST_FINER).clamp(8, MOST_SAMPLES) as f64;
    while counts.iter().map(|n| n.floor()).product::<f64>() > most {
        counts = counts.map(|n| if n > 2.0 { (n * 0.9).max(2.0) } else { n });
    }
    counts.map(|n| n as usize)
}

/// Where in a cell a place is, 0 to 1 along each axis; none if it is outside.
fn within(corners: &[DVec3; 8], place: DVec3) -> Option<DVec3> {
    let mut part = DVec3::splat(0.5);
    for _ in 0..ITERATIONS {
        let (at, slopes) = mapped(corners, part);
        let determinant = slopes.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let step = slopes.inverse() * (place - at);
        part += step;
        if !part.is_finite() || part.abs().max_element() > 1e3 {
            return None;
        }
        if step.abs().max_element() < 1e-9 {
            break;
        }
    }
    let is_inside = part.cmpge(DVec3::splat(-NEAR)).all() && part.cmple(DVec3::splat(1.0 + NEAR)).all();
    let (at, slopes) = mapped(corners, part);
    let is_there = (place - at).length() <= 1e-5 * (slopes.x_axis + slopes.y_axis + slopes.z_axis).length();
    (is_inside && is_there).then(|| part.clamp(DVec3::ZERO, DVec3::ONE))
}

/// The place of a part of a cell, and how it changes with it.
fn mapped(corners: &[DVec3; 8], part: DVec3) -> (DVec3, DMat3) {
    let [u, v, w] = part.to_array();
    let [a, b, c, d, e, f, g, h] = *corners;
    let lines = [a.lerp(b, u), c.lerp(d, u), e.lerp(f, u), g.lerp(h, u)];
    let sides = [lines[0].lerp(lines[1], v), lines[2].lerp(lines[3], v)];
    let along_u = (b - a).lerp(d - c, v).lerp((f - e).lerp(h - g, v), w);
    let along_v = (lines[1] - lines[0]).lerp(lines[3] - lines[2], w);
    (sides[0].lerp(sides[1], w), DMat3::from_cols(along_u, along_v, sides[1] - sides[0]))
}
