//! Numbers that look random and are the same on every machine.

use glam::DVec3;

/// A stream of numbers (splitmix64; Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Numbers(pub u64);

impl Numbers {
    /// A whole number from `0..below`; `below` > 0.
    pub fn below(&mut self, below: u64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below) as i64
    }

    /// A number from 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.below(1 << 40) as f64 / (1_u64 << 40) as f64
    }

    /// A place in the cube of -1..1.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share()) * 2.0 - 1.0
    }

    /// A direction, of unit length.
    pub fn direction(&mut self) -> DVec3 {
        self.in_cube().try_normalize().unwrap_or(DVec3::X)
    }
}
