//! The lie of the land: where the river runs, how high the ground is, and how the straight plan is bent to both.
//!
//! Millimetres throughout. Only `+ - * /` and `sqrt` of f64, which every machine rounds alike, and results rounded to whole
//! millimetres: the same city everywhere.

use crate::city::synth::random::Random;

/// A place in plan, millimetres, x east and y north.
pub type P2 = [i64; 2];
/// A point, millimetres, z up.
pub type P3 = [i64; 3];

/// Metres in millimetres, as the fields count.
const M: f64 = 1000.0;
/// The height of quays above the river, millimetres.
pub const QUAY: i64 = 3_000;
/// Ground this near to the middle of the river is as high as its quays, millimetres.
const LEVEL_TO: f64 = 80.0 * M;

const BEND: u64 = 11;
const MEANDER: u64 = 12;
const KNOLLS: u64 = 13;
const HILLS: u64 = 14;
const RANGES: u64 = 15;
const WARP_X: u64 = 16;
const WARP_Y: u64 = 17;
const KINK_X: u64 = 18;
const KINK_Y: u64 = 19;

/// The land of one city.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    seed: u64,
    /// Where the river crosses y = 0 before it is bent, millimetres.
    river: f64,
}

impl Field {
    /// The land of a seed; `river` is where its middle would be if it ran straight, millimetres east.
    pub fn new(seed: u64, river: i64) -> Self {
        Self { seed, river: river as f64 }
    }

    /// A number from -1 to 1 of each point of a lattice.
    fn value(&self, salt: u64, i: i64, j: i64) -> f64 {
        Random::at(self.seed, salt, [i, j]).range(-1000, 1000) as f64 / 1000.0
    }

    /// Smooth noise along a line, -1 to 1.
    fn along(&self, salt: u64, at: f64, wave: f64) -> f64 {
        let (cell, part) = split(at / wave);
        let (a, b) = (self.value(salt, cell, 0), self.value(salt, cell + 1, 0));
        a + (b - a) * smooth(part)
    }

    /// Smooth noise in the plane, -1 to 1.
    fn over(&self, salt: u64, [x, y]: [f64; 2], wave: f64) -> f64 {
        let ((i, s), (j, t)) = (split(x / wave), split(y / wave));
        let (s, t) = (smooth(s), smooth(t));
        let row = |j: i64| {
            let (a, b) = (self.value(salt, i, j), self.value(salt, i + 1, j));
            a + (b - a) * s
        };
        let (south, north) = (row(j), row(j + 1));
        south + (north - south) * t
    }

    /// How far east of its straight course the river is at `y`.
    fn bend(&self, y: f64) -> f64 {
        165.0 * M * self.along(BEND, y, 1800.0 * M) + 28.0 * M * self.along(MEANDER, y, 620.0 * M)
    }

    /// The slope of the river against north.
    fn slope(&self, y: f64) -> f64 {
        (self.bend(y + 2.0 * M) - self.bend(y - 2.0 * M)) / (4.0 * M)
    }

    /// Where a place of the straight plan lies: streets beside the river follow it, those across meet it at right angles,
    /// and farther away all swing a little.
    pub fn place(&self, [p, q]: P2) -> P2 {
        let (p, q) = (p as f64, q as f64);
        let d = p - self.river;
        let round = Self::rounding([p, q], d);
        let far = d / (900.0 * M);
        let near = d / (250.0 * M);
        let near = 1.0 / (1.0 + near * near);
        let x = p * round + self.bend(q) / (1.0 + far * far);
        let y = q * round - d * self.slope(q) * near * near;
        let free = d * d / (d * d + 75.0 * M * 75.0 * M);
        let swing = |salt: u64, kink: u64| {
            70.0 * M * self.over(salt + 10, [p, q], 1150.0 * M)
                + 24.0 * M * self.over(salt, [p, q], 450.0 * M)
                + 7.0 * M * self.over(kink, [p, q], 170.0 * M)
        };
        let (dx, dy) = (swing(WARP_X, KINK_X), swing(WARP_Y, KINK_Y));
        [(x + free * dx).round() as i64, (y + free * dy).round() as i64]
    }

    /// By how much a place is drawn towards the middle, so that what is square on the plan is nearly round: streets turn
    /// around the old town. Not at the river, `d` millimetres away.
    fn rounding([p, q]: [f64; 2], d: f64) -> f64 {
        let [a, b] = [p / M, q / M].map(|v| v * v);
        let length = (a + b).sqrt();
        if length < 1.0 {
            return 1.0;
        }
        let [a, b] = [a * a, b * b];
        let square = (a * a + b * b).sqrt().sqrt().sqrt();
        let share = 0.62 * d * d / (d * d + 220.0 * M * 220.0 * M);
        1.0 - share * (1.0 - square / length)
    }

    /// The height of the ground, millimetres above the river.
    pub fn height(&self, [x, y]: P2) -> i64 {
        let at = [x as f64, y as f64];
        let slope = self.slope(at[1]);
        let away = (at[0] - self.river - self.bend(at[1])).abs() / (1.0 + slope * slope).sqrt() - LEVEL_TO;
        let rise = |over: f64| smooth((away / (over * M)).clamp(0.0, 1.0));
        let knolls = 5.0 + 8.0 * (1.0 + self.over(KNOLLS, at, 430.0 * M));
        let hills = 15.0 * (1.0 + self.over(HILLS, at, 1100.0 * M));
        let ranges = 26.0 * (1.0 + self.over(RANGES, at, 2900.0 * M));
        let metres = rise(380.0) * knolls + rise(800.0) * hills + rise(2500.0) * ranges;
        QUAY + (metres * M).round() as i64
    }

    /// A place with the height of its ground.
    pub fn ground(&self, [x, y]: P2) -> P3 {
        [x, y, self.height([x, y])]
    }
}

/// The whole part and the rest.
fn split(value: f64) -> (i64, f64) {
    let whole = value.floor();
    (whole as i64, value - whole)
}

/// From 0 to 1 without a kink in its slope or its bend.
fn smooth(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The place `part` in `whole` of the way from `a` to `b`.
pub fn between(a: P2, b: P2, part: i64, whole: i64) -> P2 {
    let step = |a: i64, b: i64| a + ((b - a) * part + (b - a).signum() * whole / 2) / whole;
    [step(a[0], b[0]), step(a[1], b[1])]
}

/// A whole length nearest to that from `a` to `b`, millimetres.
pub fn distance(a: P2, b: P2) -> i64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]].map(|d| d as f64);
    (x * x + y * y).sqrt().round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_is_level_at_the_quays_and_nowhere_steep() {
        for seed in 1..=5 {
            let field = Field::new(seed, -100_000);
            let mut highest = 0;
            for k in -40..=40_i64 {
                let quay = field.place([-63_000, k * 40_000]);
                assert_eq!(field.height(quay), QUAY, "seed {seed}");
                for i in -40..=40_i64 {
                    let [x, y] = [i * 50_000, k * 50_000];
                    let here = field.height([x, y]);
                    let slope = [[x + 1000, y], [x, y + 1000]].map(|at| (field.height(at) - here).abs());
                    assert!(here >= QUAY && slope.iter().all(|s| *s < 250), "seed {seed}: {slope:?} mm in a metre");
                    highest = highest.max(here);
                }
            }
            assert!(highest > 25_000, "seed {seed}: {highest}");
        }
    }

    #[test]
    fn the_plan_is_bent_and_never_folded() {
        for seed in 1..=5 {
            let field = Field::new(seed, -100_000);
            for k in -60..=60_i64 {
                for i in -60..=60_i64 {
                    let at = [i * 30_000, k * 30_000];
                    let here = field.place(at);
                    let [e, n] = [[at[0] + 5_000, at[1]], [at[0], at[1] + 5_000]].map(|to| {
                        let there = field.place(to);
                        [there[0] - here[0], there[1] - here[1]]
                    });
                    let area = e[0] * n[1] - e[1] * n[0];
                    assert!(area > 25_000_000 / 3, "seed {seed} at {at:?}: {e:?}, {n:?}");
                }
            }
        }
    }

    #[test]
    fn steps_begin_and_end_at_their_places() {
        let (a, b) = ([-7, 1000], [94, -503]);
        assert_eq!((between(a, b, 0, 4), between(a, b, 4, 4)), (a, b));
        assert_eq!((between(a, b, 1, 2), between(a, b, 1, 4)), ([44, 248], [18, 624]));
        assert_eq!(distance([0, 0], [3_000, -4_000]), 5_000);
    }
}
