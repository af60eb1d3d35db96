//! Volumetric depth sprites, CPU side: how a distance becomes a stored depth, and back (S2).
//!
//! ```text
//! mapping          λ(D)                 D(λ)               λ grows with D   D = far or ∞
//! z                f/(f−n)·(1−n/D)      nf/(f−λ(f−n))      yes              1
//! complementary z  n/(f−n)·(f/D−1)      nf/(n+λ(f−n))      no               0
//! w                D/f                  λf                 yes              1
//! 1/w              n/D                  n/λ                no               0 (f = ∞)
//! ```
//!
//! Lenses compare distances in metres, never stored depths: sprites of other clip settings then just work
//! (V eq. 3.1 holds for linear depth only).

/// How distances along the sprite's axis are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mapping {
    /// Perspective depth, 0 at the near plane.
    Z,
    /// Perspective depth, 1 at the near plane.
    ComplementaryZ,
    /// Linear.
    W,
    /// Reversed infinite z; the default, in 32-bit float.
    #[default]
    InverseW,
}

/// A mapping between its clip planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthCode {
    /// The mapping.
    pub mapping: Mapping,
    /// Near plane, metres, > 0.
    pub near_m: f64,
    /// Far plane, metres, > near; 1/w has none and ignores it.
    pub far_m: f64,
}

/// Relative rounding of an f32: half of 2⁻²³.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;

impl DepthCode {
    /// Whether stored depths grow with distance; if not, every comparison of stored depths reverses (S5).
    pub fn is_increasing(&self) -> bool {
        matches!(self.mapping, Mapping::Z | Mapping::W)
    }

    /// The stored depth of distance `d`, which is clamped to the clip range, not clipped (S1).
    pub fn encode(&self, d: f64) -> f64 {
        let (n, f) = (self.near_m, self.far_m);
        let lambda = match self.mapping {
            Mapping::Z => f / (f - n) * (1.0 - n / d.max(n)),
            Mapping::ComplementaryZ => n / (f - n) * (f / d.max(n) - 1.0),
            Mapping::W => d / f,
            Mapping::InverseW => n / d.max(n),
        };
        lambda.clamp(0.0, 1.0)
    }

    /// The distance of a stored depth, metres; 1/w: 0 → ∞.
    pub fn decode(&self, lambda: f64) -> f64 {
        let (n, f) = (self.near_m, self.far_m);
        match self.mapping {
            Mapping::Z => n * f / (f - lambda * (f - n)),
            Mapping::ComplementaryZ => n * f / (n + lambda * (f - n)),
            Mapping::W => lambda * f,
            Mapping::InverseW => n / lambda,
        }
    }

    /// [`Self::encode`] as a shader computes it, all in f32.
    pub fn encode_f32(&self, d: f32) -> f32 {
        let (n, f) = (self.near_m as f32, self.far_m as f32);
        let lambda = match self.mapping {
            Mapping::Z => f / (f - n) * (1.0 - n / d.max(n)),
            Mapping::ComplementaryZ => n / (f - n) * (f / d.max(n) - 1.0),
            Mapping::W => d / f,
            Mapping::InverseW => n / d.max(n),
        };
        lambda.clamp(0.0, 1.0)
    }

    /// [`Self::decode`] as a shader computes it, all in f32.
    pub fn decode_f32(&self, lambda: f32) -> f32 {
        let (n, f) = (self.near_m as f32, self.far_m as f32);
        match self.mapping {
            Mapping::Z => n * f / (f - lambda * (f - n)),
            Mapping::ComplementaryZ => n * f / (n + lambda * (f - n)),
            Mapping::W => lambda * f,
            Mapping::InverseW => n / lambda,
        }
    }

    /// How many metres apart distances near `d` must be so that an f32 sprite tells them apart: the step of the
    /// stored value times dD/dλ. For 1/w, w and complementary z this is 2⁻²⁴·D; for z it grows with D².
    pub fn quantum_m(&self, d: f64) -> f64 {
        let (n, f) = (self.near_m, self.far_m);
        match self.mapping {
            Mapping::Z => HALF_ULP * d * d * (f - n) / (n * f),
            _ => HALF_ULP * d,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ALL: [Mapping; 4] = [Mapping::Z, Mapping::ComplementaryZ, Mapping::W, Mapping::InverseW];

    #[test]
    fn ends_are_where_the_table_says() {
        for (mapping, near, far) in
            [(Mapping::Z, 0.0, 1.0), (Mapping::ComplementaryZ, 1.0, 0.0), (Mapping::W, 0.01, 1.0)]
        {
            let code = DepthCode { mapping, near_m: 1.0, far_m: 100.0 };
            assert!((code.encode(1.0) - near).abs() < 1e-15 && (code.encode(100.0) - far).abs() < 1e-15);
        }
        let code = DepthCode { mapping: Mapping::InverseW, near_m: 0.5, far_m: f64::INFINITY };
        assert_eq!((code.encode(0.5), code.encode(f64::INFINITY)), (1.0, 0.0));
        assert_eq!(code.decode(0.0), f64::INFINITY);
    }

    #[test]
    fn nearer_than_near_is_clamped_not_lost() {
        for mapping in ALL {
            let code = DepthCode { mapping, near_m: 1.0, far_m: 100.0 };
            for d in [-5.0, 0.0, 0.5] {
                assert!((0.0..=1.0).contains(&code.encode(d)), "{mapping:?} {d}");
            }
            assert!((0.0..=1.0).contains(&code.encode(1e9)));
        }
    }

    proptest! {
        #[test]
        fn decoding_undoes_encoding(near in 0.1..2.0f64, part in 0.0..1.0f64, far in 10.0..5e4f64) {
            let d = near + part * (far - near);
            for mapping in ALL {
                let code = DepthCode { mapping, near_m: near, far_m: far };
                let back = code.decode(code.encode(d));
                // f64 has 2⁻⁵³ where the quantum has 2⁻²⁴.
                prop_assert!((back - d).abs() <= 16.0 * code.quantum_m(d) / 536_870_912.0 + 1e-12, "{:?} {} {}", mapping, d, back);
            }
        }

        #[test]
        fn a_stored_f32_is_off_by_its_quantum(near in 0.1..2.0f64, part in 0.001..0.999f64, far in 10.0..5e4f64) {
            let d = near + part * (far - near);
            for mapping in ALL {
                let code = DepthCode { mapping, near_m: near, far_m: far };
                let back = code.decode(f64::from(code.encode(d) as f32));
                prop_assert!((back - d).abs() <= 1.01 * code.quantum_m(d) + 1e-12, "{:?} {} {}", mapping, d, back);
                // All in f32: up to eight roundings, those of D and of the planes among them.
                let shader = f64::from(code.decode_f32(code.encode_f32(d as f32)));
                let room = 8.0 * (code.quantum_m(d) + HALF_ULP * d);
                let cancelled = if mapping == Mapping::ComplementaryZ { 8.0 * HALF_ULP * d * d / near } else { 0.0 };
                prop_assert!((shader - d).abs() <= room + cancelled, "{:?} {} {}", mapping, d, shader);
            }
        }

        #[test]
        fn order_is_kept_or_reversed_as_stated(a in 1.0..1e3f64, b in 1.0..1e3f64) {
            for mapping in ALL {
                let code = DepthCode { mapping, near_m: 0.5, far_m: 2e3 };
                if (a - b).abs() > 1e-6 {
                    prop_assert_eq!((code.encode(a) < code.encode(b)) == (a < b), code.is_increasing());
                }
            }
        }
    }
}
