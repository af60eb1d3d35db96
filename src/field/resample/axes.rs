//! Grids whose axes have uneven spacing.

use glam::DVec3;

use crate::field::{
    data::Values,
    grid::{Grid, checked_size},
    resample::{NEAR_ROUNDED, NEAR_STEPS},
};

/// How the samples of a regular grid lie between those of the file.
pub struct Axes {
    /// Samples of the file along each axis.
    size: [usize; 3],
    /// For each sample along an axis: the sample of the file before it, and how far it is on the way to the next.
    between: [Vec<Between>; 3],
}

#[derive(Clone, Copy)]
struct Between {
    before: usize,
    part: f64,
}

impl Axes {
    /// The regular grid over these coordinates, and how to get there where they are uneven.
    pub fn new(axes: [Vec<f64>; 3]) -> Result<(Grid, Option<Self>), String> {
        let size = axes.each_ref().map(Vec::len);
        checked_size(size)?;
        let [x, y, z] = &axes;
        let first = DVec3::new(x[0], y[0], z[0]);
        for (axis, name) in axes.iter().zip(["x", "y", "z"]) {
            let is_rising = axis.windows(2).all(|w| w[0] < w[1]);
            let is_falling = axis.windows(2).all(|w| w[0] > w[1]);
            if !(is_rising || is_falling) || axis.iter().any(|c| !c.is_finite()) {
                return Err(format!("the {name} coordinates must be finite and always rise or fall"));
            }
        }
        let is_even = axes.each_ref().map(|axis| is_even(axis));
        let sizes: [usize; 3] = std::array::from_fn(|i| if is_even[i] { size[i] } else { even_count(&axes[i]) });
        let step = |i: usize| {
            let (first, last) = (axes[i][0], axes[i][size[i] - 1]);
            if sizes[i] > 1 { (last - first) / (sizes[i] - 1) as f64 } else { 1.0 }
        };
        let grid = Grid::new(sizes, first, [DVec3::X * step(0), DVec3::Y * step(1), DVec3::Z * step(2)])?;
        if is_even == [true; 3] {
            return Ok((grid, None));
        }
        let between = std::array::from_fn(|i| {
            let all = (0..sizes[i]).map(|n| match is_even[i] {
                true => Between { before: n, part: 0.0 },
                false => between(&axes[i], axes[i][0] + step(i) * n as f64),
            });
            all.collect()
        });
        Ok((grid, Some(Self { size, between })))
    }

    /// The values on a regular grid of this size.
    pub fn values(&self, values: &Values, components: usize, size: [usize; 3]) -> Values {
        let mut all = Vec::with_capacity(size.iter().product::<usize>() * components);
        let [along_x, along_y, along_z] = &self.between;
        let next = |axis: usize, n: usize| (n + 1).min(self.size[axis] - 1);
        for z in along_z {
            for y in along_y {
                for x in along_x {
                    for c in 0..components {
                        let value = |x: usize, y: usize, z: usize| {
                            f64::from(values.get((x + self.size[0] * (y + self.size[1] * z)) * components + c))
                        };
                        let on_x = |y, z| mixed(value(x.before, y, z), || value(next(0, x.before), y, z), x.part);
                        let on_y = |z| mixed(on_x(y.before, z), || on_x(next(1, y.before), z), y.part);
                        all.push(mixed(on_y(z.before), || on_y(next(2, z.before)), z.part) as f32);
                    }
                }
            }
        }
        Values::F32(all)
    }
}

/// A value on the way from one to another; the other is not asked for where it counts nothing, as it may be missing.
fn mixed(from: f64, to: impl Fn() -> f64, part: f64) -> f64 {
    if part == 0.0 { from } else { from + (to() - from) * part }
}

fn is_even(axis: &[f64]) -> bool {
    let (Some(first), Some(last)) = (axis.first(), axis.last()) else { return true };
    let step = (last - first) / axis.len().saturating_sub(1).max(1) as f64;
    axis.iter().enumerate().all(|(i, c)| {
        let wanted = first + step * i as f64;
        (c - wanted).abs() <= (NEAR_STEPS * step.abs()).max(NEAR_ROUNDED * wanted.abs())
    })
}

/// Samples of an even axis that are about as fine: by the median of the steps, up to twice as many.
fn even_count(axis: &[f64]) -> usize {
    let mut steps: Vec<f64> = axis.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    let median = steps.get(steps.len().saturating_sub(1) / 2).copied().unwrap_or(1.0);
    let extent: f64 = steps.iter().sum();
    ((extent / median).round() as usize)
        .saturating_add(1)
        .clamp(axis.len(), (axis.len() * 2).min(crate::field::grid::MOST_PER_AXIS))
}

/// Where a coordinate lies between those of an axis.
fn between(axis: &[f64], at: f64) -> Between {
    let is_rising = axis[0] < axis[axis.len() - 1];
    let behind = axis.partition_point(|c| if is_rising { *c <= at } else { *c >= at });
    let before = behind.saturating_sub(1).min(axis.len() - 2);
    let part = (at - axis[before]) / (axis[before + 1] - axis[before]);
    // What is next to a sample is that sample: rounding gives no missing neighbour a say.
    if part < 1e-9 {
        Between { before, part: 0.0 }
    } else if part > 1.0 - 1e-9 {
        Between { before: before + 1, part: 0.0 }
    } else {
        Between { before, part }
    }
}
