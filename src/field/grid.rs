//! Regular grids: where samples are.

use glam::{DMat3, DVec3};

/// The most samples along an axis.
pub const MOST_PER_AXIS: usize = 2048;
/// The most samples of a step in time.
pub const MOST_SAMPLES: usize = 1 << 29;
/// What a grid's axes are, at least, apart: the volume that their steps span over the product of their lengths.
const LEAST_SPAN: f64 = 1e-9;

/// Regular grid of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Samples along each axis, 1 to 2048.
    pub size: [usize; 3],
    /// Where the first sample is, in the file's units.
    pub origin: DVec3,
    /// From a sample to the next along each axis, in the file's units; finite, not 0, in no plane, of any handedness. An axis of one sample
    /// has a step, too: the file's, or one 1 long, at right angles to the others.
    pub steps: [DVec3; 3],
}

impl Grid {
    /// A grid whose axes of one sample are given a step; the error says what is wrong with the size or the steps.
    pub fn new(size: [usize; 3], origin: DVec3, steps: [DVec3; 3]) -> Result<Self, String> {
        checked_size(size)?;
        let steps = completed(size, steps);
        let grid = Self { size, origin, steps };
        let [a, b, c] = steps;
        let lengths = a.length() * b.length() * c.length();
        let span = DMat3::from_cols(a, b, c).determinant().abs();
        let last = grid.position(DVec3::from_array(size.map(|n| n as f64)));
        let is_sound = lengths.is_finite() && lengths > 0.0 && span >= LEAST_SPAN * lengths;
        if !is_sound || !origin.is_finite() || !last.is_finite() {
            return Err(format!(
                "the grid begins at {origin} with the steps {a}, {b} and {c}; all must be finite numbers, and the steps neither 0 nor in one plane"
            ));
        }
        Ok(grid)
    }

    /// How many samples it has.
    pub fn count(&self) -> usize {
        self.size.iter().product()
    }

    /// Where a sample is, or a place between samples, counted in samples from the first.
    pub fn position(&self, index: DVec3) -> DVec3 {
        let [a, b, c] = self.steps;
        self.origin + a * index.x + b * index.y + c * index.z
    }

    /// Where the eight outermost samples are, x fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        let last = self.size.map(|n| n.saturating_sub(1) as f64);
        std::array::from_fn(|i| {
            let along = |axis: usize| if i >> axis & 1 == 1 { last[axis] } else { 0.0 };
            self.position(DVec3::new(along(0), along(1), along(2)))
        })
    }

    /// The least and the greatest coordinates of samples.
    pub fn bounds(&self) -> [DVec3; 2] {
        let corners = self.corners();
        corners.iter().fold([corners[0]; 2], |[min, max], corner| [min.min(*corner), max.max(*corner)])
    }

    /// The grid of the cells between samples; an axis of one sample has one cell, in which it is the middle.
    pub(super) fn cells(&self) -> Self {
        let halves = self.size.map(|n| if n > 1 { 0.5 } else { 0.0 });
        Self {
            size: cells_of(self.size),
            origin: self.position(DVec3::from_array(halves)),
            steps: completed(cells_of(self.size), self.steps),
        }
    }
}

/// How many cells there are between so many samples.
pub(super) fn cells_of(size: [usize; 3]) -> [usize; 3] {
    size.map(|n| n.saturating_sub(1).max(1))
}

/// Whether sizes are within the limits; the error says what is not.
pub(super) fn checked_size(size: [usize; 3]) -> Result<(), String> {
    let [x, y, z] = size;
    if size.contains(&0) {
        return Err(format!("the grid has {x} × {y} × {z} samples; each axis needs at least one"));
    }
    let count = size.iter().try_fold(1_usize, |count, n| count.checked_mul(*n));
    if size.iter().any(|n| *n > MOST_PER_AXIS) || count.is_none_or(|count| count > MOST_SAMPLES) {
        return Err(format!(
            "the grid has {x} × {y} × {z} samples; at most {MOST_PER_AXIS} along an axis and {MOST_SAMPLES} in all can be read, so thin it out"
        ));
    }
    Ok(())
}

/// Whether steps are finite, not 0, and in no plane.
fn spans([a, b, c]: [DVec3; 3]) -> bool {
    let lengths = a.length() * b.length() * c.length();
    let span = DMat3::from_cols(a, b, c).determinant().abs();
    lengths.is_finite() && lengths > 0.0 && span >= LEAST_SPAN * lengths
}

/// The steps, where an axis of one sample has one of length 1 at right angles to the others.
fn completed(size: [usize; 3], steps: [DVec3; 3]) -> [DVec3; 3] {
    if spans(steps) {
        return steps;
    }
    let real: Vec<usize> = (0..3).filter(|axis| size[*axis] > 1).collect();
    let (mut all, units) = (steps, [DVec3::X, DVec3::Y, DVec3::Z]);
    match real[..] {
        [] => units,
        [a] => {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let along = steps[a].try_normalize().unwrap_or(units[a]);
            let aside = if along.dot(units[b]).abs() < 0.9 { units[b] } else { units[c] };
            all[b] = (aside - along * along.dot(aside)).try_normalize().unwrap_or(units[b]);
            all[c] = along.cross(all[b]);
            all
        }
        [a, b] => {
            let c = 3 - a - b;
            let normal = steps[(c + 1) % 3].cross(steps[(c + 2) % 3]);
            // Parallel steps have none; they are refused with it, too.
            all[c] = normal.try_normalize().unwrap_or(units[c]);
            all
        }
        _ => all,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_one_sample_are_at_right_angles() {
        let grid = Grid::new([4, 1, 5], DVec3::ZERO, [DVec3::X * 3.0, DVec3::ZERO, DVec3::Z * 2.0]).unwrap();
        assert_eq!(grid.steps[1], DVec3::Y);
        assert_eq!(grid.bounds(), [DVec3::ZERO, DVec3::new(9.0, 0.0, 8.0)]);
        let line = Grid::new([1, 7, 1], DVec3::ONE, [DVec3::NAN, DVec3::new(0.0, 3.0, 4.0), DVec3::ZERO]).unwrap();
        assert!(line.steps.iter().all(|step| step.is_finite()));
        assert!(line.steps[0].dot(line.steps[1]).abs() < 1e-12 && line.steps[2].dot(line.steps[1]).abs() < 1e-12);
        assert_eq!(Grid::new([1; 3], DVec3::ZERO, [DVec3::ZERO; 3]).unwrap().steps, [DVec3::X, DVec3::Y, DVec3::Z]);
    }

    #[test]
    fn cells_lie_between_samples() {
        let cells = Grid::new([3, 2, 1], DVec3::ZERO, [DVec3::X * 2.0, DVec3::Y, DVec3::Z]).unwrap().cells();
        assert_eq!((cells.size, cells.origin), ([2, 1, 1], DVec3::new(1.0, 0.5, 0.0)));
    }

    #[test]
    fn grids_that_are_none_are_refused() {
        let steps = [DVec3::X, DVec3::Y, DVec3::Z];
        let refused = |size, origin, steps| Grid::new(size, origin, steps).unwrap_err();
        assert!(refused([2, 0, 2], DVec3::ZERO, steps).contains("at least one"));
        assert!(refused([2049, 1, 1], DVec3::ZERO, steps).contains("at most 2048"));
        assert!(refused([2048, 2048, 2048], DVec3::ZERO, steps).contains("536870912 in all"));
        assert!(refused([2, 2, 2], DVec3::NAN, steps).contains("finite"));
        assert!(refused([2, 2, 2], DVec3::ZERO, [DVec3::X, DVec3::X, DVec3::Z]).contains("in one plane"));
        assert!(refused([2, 2, 1], DVec3::ZERO, [DVec3::X, -DVec3::X, DVec3::Z]).contains("in one plane"));
        assert!(refused([2, 2, 2], DVec3::ZERO, [DVec3::X, DVec3::ZERO, DVec3::Z]).contains("neither 0"));
    }
}
