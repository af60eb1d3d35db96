//! The share of a point of interest that objects cover, by rays.

use glam::DVec3;

use crate::{
    city::{CityModel, spatial::SpatialIndex},
    geom::{Aabb, Ray},
};

/// A share of what is seen of a point of interest from the eye, were it alone; by solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Rays to it that are covered, of all that meet it, 0..=1.
    pub share: f64,
    /// Lower end of the 95 % interval (Wilson).
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Coverage {
    /// The share of `hits` rays among `rays` ≥ 1.
    pub fn of(hits: u32, rays: u32) -> Self {
        // Wilson, Probable inference (1927): right also where all or none hit.
        const Z: f64 = 1.959_963_984_540_054;
        let n = f64::from(rays.max(1));
        let share = f64::from(hits) / n;
        let middle = share + Z * Z / (2.0 * n);
        let reach = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + Z * Z / n;
        Self { share, low: ((middle - reach) / scale).max(0.0), high: ((middle + reach) / scale).min(1.0) }
    }
}

/// The city that rays to a point of interest go through.
pub(super) struct Sampler<'a> {
    pub model: &'a CityModel,
    pub index: &'a SpatialIndex,
    pub of_object: &'a [u32],
    pub eye: DVec3,
}

/// Rays tried for one that meets a point of interest, at most.
const TRIES: u32 = 64;

impl Sampler<'_> {
    /// Sends rays until `wanted` meet the unit `poi` (or the point, if it is none), and counts those that pass through each
    /// unit before; none where nothing is met.
    pub fn count(
        &self,
        poi: Option<u32>,
        bounds: &Aabb,
        wanted: u32,
    ) -> Option<(u32, rustc_hash::FxHashMap<u32, u32>)> {
        let mut counts = rustc_hash::FxHashMap::default();
        let mut before: Vec<(u32, f64)> = Vec::new();
        let mut add = |before: &mut Vec<(u32, f64)>, end: f64| {
            before.retain(|(_, t)| *t < end);
            before.sort_unstable_by_key(|(unit, _)| *unit);
            before.dedup_by_key(|(unit, _)| *unit);
            before.iter().for_each(|(unit, _)| *counts.entry(*unit).or_default() += 1);
        };
        let Some(poi) = poi else {
            // A point is one ray.
            let ray = Ray { origin: self.eye, direction: bounds.center() - self.eye };
            self.index.hits(self.model, &ray, 1.0, |hit| before.push((self.of_object[hit.object as usize], hit.t)));
            add(&mut before, 1.0);
            return Some((1, counts));
        };
        let cone = Cone::around(self.eye, bounds);
        let (mut met, mut dice) = (0, Dice(0x5eed));
        for _ in 0..wanted.saturating_mul(TRIES) {
            let ray = Ray { origin: self.eye, direction: cone.direction([dice.next(), dice.next()]) };
            let mut end = f64::INFINITY;
            before.clear();
            self.index.hits(self.model, &ray, f64::INFINITY, |hit| match self.of_object[hit.object as usize] {
                unit if unit == poi => end = end.min(hit.t),
                unit => before.push((unit, hit.t)),
            });
            if end.is_finite() {
                add(&mut before, end);
                met += 1;
            }
            if met == wanted {
                break;
            }
        }
        (met > 0).then_some((met, counts))
    }
}

/// Directions about an axis.
struct Cone {
    axis: DVec3,
    /// 1 − the cosine of its opening.
    height: f64,
}

impl Cone {
    /// The directions from the eye to a box, and some beside.
    fn around(eye: DVec3, bounds: &Aabb) -> Self {
        let axis = (bounds.center() - eye).normalize_or(DVec3::X);
        // 1 − cos without the loss of a difference: half of the squared distance of unit vectors.
        let off = |corner: DVec3| (corner - eye).try_normalize().map_or(2.0, |to| 0.5 * to.distance_squared(axis));
        let is_in = eye.cmpge(bounds.min).all() && eye.cmple(bounds.max).all();
        let widest = bounds.corners().into_iter().map(off).fold(0.0, f64::max);
        Self { axis, height: if is_in { 2.0 } else { widest } }
    }

    /// Evenly spread over the solid angle, of two numbers 0..1.
    fn direction(&self, [a, b]: [f64; 2]) -> DVec3 {
        let lost = a * self.height;
        let sine = (lost * (2.0 - lost)).max(0.0).sqrt();
        let (u, v) = self.axis.any_orthonormal_pair();
        let (sin, cos) = (std::f64::consts::TAU * b).sin_cos();
        self.axis * (1.0 - lost) + (u * cos + v * sin) * sine
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): the same rays in every run.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_the_share_and_never_leave_0_to_1() {
        for (hits, rays) in [(0, 1), (1, 1), (0, 256), (256, 256), (128, 256), (3, 256)] {
            let c = Coverage::of(hits, rays);
            assert!(0.0 <= c.low && c.low <= c.share && c.share <= c.high && c.high <= 1.0, "{c:?}");
        }
        let half = Coverage::of(128, 256);
        assert!((half.high - half.low - 0.121_6).abs() < 1e-3, "{half:?}");
    }

    #[test]
    fn directions_fill_their_cone_evenly() {
        let bounds = Aabb { min: DVec3::new(9.0, -3.0, -1.0), max: DVec3::new(11.0, 3.0, 2.0) };
        let cone = Cone::around(DVec3::ZERO, &bounds);
        let mut dice = Dice(7);
        let n = 100_000;
        let inner = (0..n).filter(|_| {
            let d = cone.direction([dice.next(), dice.next()]);
            assert!((d.length() - 1.0).abs() < 1e-12);
            let off = 1.0 - d.dot(cone.axis);
            assert!(off <= cone.height * (1.0 + 1e-12) + 1e-15);
            // By Archimedes, half of the solid angle.
            off < 0.5 * cone.height
        });
        let share = inner.count() as f64 / f64::from(n);
        assert!((share - 0.5).abs() < 0.008, "{share}");
        for corner in bounds.corners() {
            let off = 1.0 - corner.normalize_or(DVec3::X).dot(cone.axis);
            assert!(off <= cone.height + 1e-12, "{corner} is out of the cone");
        }
    }
}
