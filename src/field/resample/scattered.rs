//! Values at scattered places: weighted by the inverse of the squared distance (Shepard).

use glam::DVec3;

use crate::field::{
    data::Values,
    grid::Grid,
    resample::{aligned, bounds},
};

/// Samples along the longest axis, at most and at least.
const MOST: usize = 128;
const LEAST: usize = 8;
/// Weights that are asked for, and bytes of values, at most.
const MOST_WEIGHTS: u64 = 1 << 28;
const MOST_BYTES: u64 = 1 << 27;

/// A regular grid over scattered places.
pub struct Scattered {
    /// The grid.
    pub grid: Grid,
    /// What is done, for a warning.
    pub note: String,
}

impl Scattered {
    /// A grid over the places of all steps. `places`: of one step. `numbers`: numbers of a sample, in all steps together.
    pub fn new(points: &[DVec3], places: usize, numbers: usize) -> Result<Self, String> {
        let Some(ends) = bounds(points.iter()) else { return Err("no place is finite".into()) };
        let extent = ends[1] - ends[0];
        let longest = extent.max_element();
        if !longest.is_finite() {
            return Err("the places are too far apart".into());
        }
        let mut most = MOST;
        let size = loop {
            let size: [usize; 3] = std::array::from_fn(|axis| match extent[axis] > 0.0 {
                true => ((extent[axis] / longest * most as f64).round() as usize).clamp((most / 4).max(2), most),
                false => 1,
            });
            let samples = size.iter().product::<usize>() as u64;
            let is_small = samples.saturating_mul(numbers as u64).saturating_mul(4) <= MOST_BYTES;
            if is_small && samples.saturating_mul(places as u64).saturating_mul(numbers as u64) <= MOST_WEIGHTS {
                break size;
            }
            most /= 2;
            if most < LEAST {
                return Err(format!("{places} scattered places are too many to be resampled; put them on a grid"));
            }
        };
        let [x, y, z] = size;
        let note = format!(
            "values at {places} scattered places; resampled to a regular grid of {x} × {y} × {z} by weights of inverse squared distance"
        );
        Ok(Self { grid: aligned(size, ends)?, note })
    }

    /// The values on the grid; what is missing at a place counts nothing there.
    pub fn values(&self, points: &[DVec3], values: &Values, components: usize) -> Values {
        let [nx, ny, nz] = self.grid.size;
        let mut all = Vec::with_capacity(self.grid.count() * components);
        for index in 0..nx * ny * nz {
            let cell = DVec3::new((index % nx) as f64, (index / nx % ny) as f64, (index / nx / ny) as f64);
            let sample = self.grid.position(cell);
            all.extend((0..components).map(|c| weighted(points, values, components, c, sample)));
        }
        Values::F32(all)
    }
}

fn weighted(points: &[DVec3], values: &Values, components: usize, component: usize, sample: DVec3) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, point) in points.iter().enumerate() {
        let value = f64::from(values.get(i * components + component));
        let squared = point.distance_squared(sample);
        if !value.is_finite() || !squared.is_finite() {
            continue;
        }
        if squared == 0.0 {
            return value as f32;
        }
        sum += value / squared;
        weights += 1.0 / squared;
    }
    let value = (sum / weights) as f32;
    if value.is_finite() { value } else { f32::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_kept_where_they_are_and_mixed_between() {
        let points = [DVec3::ZERO, DVec3::X * 127.0, DVec3::new(30.0, 0.0, 0.0)];
        let scattered = Scattered::new(&points, 3, 1).unwrap();
        assert_eq!(scattered.grid.size, [128, 1, 1]);
        let found = scattered.values(&points, &Values::F32(vec![1.0, 3.0, f32::NAN]), 1);
        assert_eq!((found.get(0), found.get(127)), (1.0, 3.0));
        let wanted = (1.0 / 900.0 + 3.0 / 9409.0) / (1.0 / 900.0 + 1.0 / 9409.0);
        assert!((found.get(30) - wanted as f32).abs() < 1e-6, "{}", found.get(30));
        assert!(scattered.note.contains("128 × 1 × 1"));
    }

    #[test]
    fn the_grid_becomes_coarser_before_it_takes_too_long() {
        let points: Vec<DVec3> = (0..3000).map(|i| DVec3::new(i as f64, (i * 7 % 64) as f64, 0.0)).collect();
        assert_eq!(Scattered::new(&points, 3000, 9).unwrap().grid.size, [128, 32, 1]);
        assert_eq!(Scattered::new(&points, 3000, 90).unwrap().grid.size, [32, 8, 1]);
        assert!(Scattered::new(&points, 3000, 9000).err().unwrap().contains("too many"));
        assert!(Scattered::new(&[DVec3::NAN], 1, 1).is_err());
        assert_eq!(Scattered::new(&[DVec3::ONE], 1, 1).unwrap().grid.count(), 1);
    }
}
