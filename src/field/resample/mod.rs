//! What does not lie on a regular grid is resampled to one.

mod axes;
mod curved;
mod scattered;

use glam::DVec3;

use crate::field::{data::Values, grid::Grid};

pub use scattered::Scattered;

/// The most samples of a grid that is made here.
const MOST_SAMPLES: usize = 1 << 24;
/// How far a place may be from where a regular grid has it, in steps; and by how much of its coordinates, for what F32 rounds.
const NEAR_STEPS: f64 = 1e-3;
const NEAR_ROUNDED: f64 = 2e-7;

/// A way from values at the places of a file to values on a regular grid.
pub struct Resampling {
    /// The regular grid.
    pub grid: Grid,
    /// What is done, for a warning; nothing where the places were regular.
    pub note: Option<String>,
    way: Way,
}

enum Way {
    /// They are on it.
    Same,
    /// Axes of their own coordinates.
    Axes(axes::Axes),
    /// Cells of any form.
    Curved(curved::Curved),
}

impl Resampling {
    /// No way: the values are on this grid.
    pub fn regular(grid: Grid) -> Self {
        Self { grid, note: None, way: Way::Same }
    }

    /// The way from a grid whose axes have these coordinates. The error says what is wrong with them.
    pub fn of_axes(axes: [Vec<f64>; 3]) -> Result<Self, String> {
        let (grid, axes) = axes::Axes::new(axes)?;
        let note = axes.as_ref().map(|_| format!("uneven spacing; resampled linearly to {}", shown(&grid)));
        Ok(Self { grid, note, way: axes.map_or(Way::Same, Way::Axes) })
    }

    /// The way from a grid whose samples are at these places, x fastest. The error says what is wrong with them.
    pub fn of_points(size: [usize; 3], points: Vec<DVec3>) -> Result<Self, String> {
        if let Some(grid) = regular(size, &points) {
            return Ok(Self::regular(grid));
        }
        let (grid, curved) = curved::Curved::new(size, &points)?;
        let [x, y, z] = size;
        let kind = if curved.is_flat() { "bilinearly" } else { "trilinearly" };
        let note = format!(
            "{x} × {y} × {z} samples on a curved grid; resampled {kind} within its cells to {}, missing outside them",
            shown(&grid)
        );
        Ok(Self { grid, note: Some(note), way: Way::Curved(curved) })
    }

    /// The way from the middles of cells between the samples of a grid at these places, x fastest.
    pub fn of_cells(size: [usize; 3], points: &[DVec3]) -> Result<Self, String> {
        let cells = crate::field::grid::cells_of(size);
        let mut middles = Vec::with_capacity(cells.iter().product());
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                for x in 0..cells[0] {
                    let corners = corners(size, [x, y, z]).map(|i| points.get(i).copied().unwrap_or(DVec3::NAN));
                    middles.push(corners.iter().sum::<DVec3>() / 8.0);
                }
            }
        }
        Self::of_points(cells, middles)
    }

    /// The values on the regular grid, of values at the places of the file.
    pub fn values(&self, values: Values, components: usize) -> Values {
        match &self.way {
            Way::Same => values,
            Way::Axes(axes) => axes.values(&values, components, self.grid.size),
            Way::Curved(curved) => curved.values(&values, components),
        }
    }
}

/// The grid in words.
fn shown(grid: &Grid) -> String {
    let [x, y, z] = grid.size;
    format!("a regular grid of {x} × {y} × {z}")
}

/// The samples at the corners of a cell, x fastest; where an axis has one sample, it is both ends.
fn corners(size: [usize; 3], cell: [usize; 3]) -> [usize; 8] {
    std::array::from_fn(|corner| {
        let at = |axis: usize| (cell[axis] + (corner >> axis & 1)).min(size[axis] - 1);
        at(0) + size[0] * (at(1) + size[1] * at(2))
    })
}

/// The regular grid that these places are, if they are one.
fn regular(size: [usize; 3], points: &[DVec3]) -> Option<Grid> {
    let first = *points.first()?;
    let mut steps = [DVec3::ZERO; 3];
    let mut stride = 1;
    for axis in 0..3 {
        let last = (size[axis] - 1) * stride;
        if size[axis] > 1 {
            steps[axis] = (*points.get(last)? - first) / (size[axis] - 1) as f64;
        }
        stride *= size[axis];
    }
    let grid = Grid::new(size, first, steps).ok()?;
    let least = (0..3).filter(|axis| size[*axis] > 1).map(|axis| steps[axis].length()).fold(f64::INFINITY, f64::min);
    let mut index = [0; 3];
    for point in points {
        let wanted = grid.position(DVec3::from_array(index.map(|n| n as f64)));
        let near = (NEAR_STEPS * least).max(NEAR_ROUNDED * wanted.abs().max_element());
        if !point.is_finite() || (*point - wanted).length() > near {
            return None;
        }
        for axis in 0..3 {
            index[axis] += 1;
            if index[axis] < size[axis] || axis == 2 {
                break;
            }
            index[axis] = 0;
        }
    }
    Some(grid)
}

/// A grid along the axes of space, from the least to the greatest coordinates; `size` has one sample where they are the same.
fn aligned(size: [usize; 3], bounds: [DVec3; 2]) -> Result<Grid, String> {
    let [min, max] = bounds;
    let extent = max - min;
    let step = |axis: usize, unit: DVec3| unit * (extent[axis] / size[axis].saturating_sub(1).max(1) as f64);
    Grid::new(size, min, [step(0, DVec3::X), step(1, DVec3::Y), step(2, DVec3::Z)])
}

/// The least and the greatest coordinates of finite places; none if there are none.
fn bounds<'a>(points: impl Iterator<Item = &'a DVec3>) -> Option<[DVec3; 2]> {
    let finite = points.filter(|point| point.is_finite());
    finite.fold(None, |bounds, point| {
        let [min, max] = bounds.unwrap_or([*point; 2]);
        Some([min.min(*point), max.max(*point)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places of a grid by a map.
    pub fn places(size: [usize; 3], map: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
        let all = (0..size.iter().product()).map(|i: usize| {
            let (x, y, z) = (i % size[0], i / size[0] % size[1], i / size[0] / size[1]);
            map(DVec3::new(x as f64, y as f64, z as f64))
        });
        all.collect()
    }

    #[test]
    fn regular_places_are_a_grid() {
        let turned = |p: DVec3| DVec3::new(7.0 + p.x - p.y, p.x + p.y, 1e6 + 2.5 * p.z);
        let way = Resampling::of_points([4, 3, 2], places([4, 3, 2], turned)).unwrap();
        assert!(way.note.is_none());
        assert_eq!(way.grid.steps, [DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 1.0, 0.0), DVec3::Z * 2.5]);
        let cells = Resampling::of_cells([4, 3, 2], &places([4, 3, 2], turned)).unwrap();
        assert_eq!((cells.grid.size, cells.grid.origin), ([3, 2, 1], DVec3::new(7.0, 1.0, 1e6 + 1.25)));
    }

    #[test]
    fn a_curved_plane_is_resampled() {
        let bent = |p: DVec3| DVec3::new(p.x + 0.05 * p.y * p.y, 2.0 * p.y + 0.02 * p.x * p.x, 5.0);
        let way = Resampling::of_points([12, 9, 1], places([12, 9, 1], bent)).unwrap();
        assert!(way.note.as_ref().unwrap().contains("12 × 9 × 1"), "{:?}", way.note);
        assert_eq!((way.grid.size[2], way.grid.origin.z), (1, 5.0));
        // A value that is linear in space is found again wherever there is one.
        let value = |p: DVec3| (3.0 * p.x - 2.0 * p.y) as f32;
        let values = places([12, 9, 1], bent).into_iter().map(value).collect();
        let found = way.values(Values::F32(values), 1);
        let mut inside = 0;
        for (i, place) in places(way.grid.size, |p| way.grid.position(p)).into_iter().enumerate() {
            if found.get(i).is_finite() {
                assert!((found.get(i) - value(place)).abs() < 1e-3, "{} at {place}", found.get(i));
                inside += 1;
            }
        }
        assert!(inside * 2 > found.len() && inside < found.len(), "{inside} of {}", found.len());
    }

    #[test]
    fn a_curved_volume_is_resampled() {
        let size = [6, 5, 7];
        let bent = |p: DVec3| DVec3::new(p.x + 0.1 * p.z, p.y - 0.1 * p.z + 0.05 * p.x * p.x, 3.0 * p.z + 0.2 * p.x);
        let way = Resampling::of_points(size, places(size, bent)).unwrap();
        let value = |p: DVec3| [(p.x + p.y + p.z) as f32, (p.x - p.z) as f32];
        let values = places(size, bent).into_iter().flat_map(value).collect();
        let found = way.values(Values::F32(values), 2);
        let places = places(way.grid.size, |p| way.grid.position(p));
        let mut inside = 0;
        for (i, place) in places.into_iter().enumerate().filter(|(i, _)| found.get(i * 2).is_finite()) {
            let [a, b] = value(place);
            assert!((found.get(i * 2) - a).abs() < 1e-3 && (found.get(i * 2 + 1) - b).abs() < 1e-3, "at {place}");
            inside += 1;
        }
        assert!(inside * 4 > way.grid.count(), "{inside} of {}", way.grid.count());
    }

    #[test]
    fn uneven_axes_are_resampled() {
        let way = Resampling::of_axes([vec![0.0, 1.0, 2.0, 4.0], vec![5.0, 3.0], vec![9.0]]).unwrap();
        assert_eq!((way.grid.size, way.grid.steps[1]), ([5, 2, 1], DVec3::Y * -2.0));
        let found = way.values(Values::U8(vec![0, 10, 20, 40, 5, 5, 5, 5]), 1);
        assert_eq!(found, Values::F32(vec![0.0, 10.0, 20.0, 30.0, 40.0, 5.0, 5.0, 5.0, 5.0, 5.0]));
        let even = Resampling::of_axes([vec![0.0, 0.1, 0.2], vec![1.0], vec![1.0, 2.0]]).unwrap();
        let far = Resampling::of_axes([vec![0.0, 1e-300, 1e9], vec![1.0], vec![1.0]]).unwrap();
        assert_eq!(far.grid.size, [6, 1, 1], "no more than twice as many");
        assert!(even.note.is_none() && even.grid.size == [3, 1, 2]);
        assert!(
            Resampling::of_axes([vec![0.0, 1.0, 0.5], vec![1.0], vec![1.0]]).err().unwrap().contains("rise or fall")
        );
    }

    #[test]
    fn places_that_span_nothing_are_refused() {
        let folded = Resampling::of_points([3, 3, 3], places([3, 3, 3], |p| DVec3::new(p.x * p.x, p.y, 0.0)));
        assert!(folded.err().unwrap().contains("flat"));
        let nowhere = Resampling::of_points([3, 3, 1], vec![DVec3::NAN; 9]);
        assert!(nowhere.err().unwrap().contains("finite"));
        let line = Resampling::of_points([3, 1, 1], places([3, 1, 1], |p| DVec3::X * p.x * p.x));
        assert!(line.err().unwrap().contains("along a line"));
    }
}
