//! Integers as metres.

use glam::DVec3;

/// The relation of a pool's integers to metres, per axis: `origin + step × integer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Metres per unit, > 0.
    pub step: DVec3,
    /// Metres at integer 0.
    pub origin: DVec3,
}

impl Lattice {
    /// The lattice that floating-point formats are put on: 2⁻²⁰ m (about a micrometre) around the world's origin.
    /// Positions nearer than 2³² m are rounded by at most half a step.
    pub const FINE: Self = Self { step: DVec3::splat(1.0 / 1_048_576.0), origin: DVec3::ZERO };

    /// World metres of a lattice point.
    pub fn to_world(&self, p: [i64; 3]) -> DVec3 {
        self.origin + self.step * DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64)
    }

    /// The nearest lattice point; `None` for NaN, infinity or farther than 2^62 steps.
    pub fn nearest(&self, world: DVec3) -> Option<[i64; 3]> {
        let p = ((world - self.origin) / self.step).round();
        p.abs().cmplt(DVec3::splat(4.6e18)).all().then_some([p.x as i64, p.y as i64, p.z as i64])
    }
}
