//! Volumetric depth sprites (Trapp §3.1), CPU side: how a distance becomes a stored depth, and back.
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
//! (Trapp, eq. 3.1, holds for linear depth only).

use crate::{
    geom::shape::Motion,
    view::{Camera, MAX_SIZE},
};

/// The volumetric depth sprite that a lens is tested by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensSprite {
    /// The eye that it is made from; `None`: the picture's.
    pub own: Option<OwnEye>,
    /// Texels along the longer side of the picture, or of its own frame; `None`: one per pixel, or [`OWN_RESOLUTION`].
    pub resolution: Option<u32>,
    /// What a stored depth is.
    pub format: Format,
    /// How distances become stored depths.
    pub mapping: Mapping,
    /// Near clip plane, metres, > 0; `None`: where the lens begins.
    pub near_m: Option<f64>,
    /// Far clip plane, metres; `None`: where the lens ends. 1/w has none.
    pub far_m: Option<f64>,
    /// Intervals of a ray that are kept, at most, 1..=[`MOST_LAYERS`]; a good value is 4.
    pub layers: u32,
    /// Only where a ray enters first and leaves last is kept, as the source does (V's aggregate).
    pub aggregate: bool,
}

/// The own eye of a sprite, and its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnEye {
    /// In the coordinates of the lens' shapes: it moves with them.
    pub camera: Camera,
    /// Width of the frame over its height, > 0.
    pub aspect: f64,
}

impl OwnEye {
    /// Turned and moved.
    pub fn moved(&self, motion: &Motion) -> Self {
        let Camera { eye, target, up, .. } = self.camera;
        let camera =
            Camera { eye: motion.point(eye), target: motion.point(target), up: motion.rotation * up, ..self.camera };
        Self { camera, ..*self }
    }

    /// Width and height of the frame, texels, of which the longer side has so many.
    pub fn size(&self, longer: u32) -> [u32; 2] {
        let side = |share: f64| ((f64::from(longer) * share).round() as u32).clamp(1, MAX_SIZE);
        [side(self.aspect.min(1.0)), side((1.0 / self.aspect).min(1.0))]
    }
}

/// Texels along the longer side of the frame of a sprite that has its own eye, where nothing is said.
pub const OWN_RESOLUTION: u32 = 512;
/// Layers of a sprite, at most.
pub const MOST_LAYERS: u32 = 16;
/// Where nothing is said.
pub const LAYERS: u32 = 4;

impl Default for LensSprite {
    fn default() -> Self {
        Self {
            own: None,
            resolution: None,
            format: Format::default(),
            mapping: Mapping::default(),
            near_m: None,
            far_m: None,
            layers: LAYERS,
            aggregate: false,
        }
    }
}

impl LensSprite {
    /// Width and height of the frame of its own eye, texels, if it has one.
    pub fn own_size(&self) -> Option<[u32; 2]> {
        self.own.map(|own| own.size(self.resolution.unwrap_or(OWN_RESOLUTION)))
    }

    /// Whether it stores depths as the depth target of the picture does.
    pub fn is_as_the_target(&self) -> bool {
        (self.format, self.mapping, self.near_m) == (Format::Float32, Mapping::InverseW, None)
    }
}

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
    /// Linear, 1 at the near plane: λ = (f−D)/(f−n). Depth targets of orthographic views have it; scene files do not.
    ComplementaryW,
}

impl Mapping {
    /// Those of scene files, by the words that they have there.
    pub const WORDS: [(&str, Self); 4] =
        [("z", Self::Z), ("complementary-z", Self::ComplementaryZ), ("w", Self::W), ("1/w", Self::InverseW)];

    /// Its word; ComplementaryW has one in files of sprites alone.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, mapping)| *mapping == self).map_or("complementary-w", |(word, _)| word)
    }
}

/// What a stored depth is. All are rows of codes 0 to [`Format::top`] that grow with the depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Format {
    /// 255 steps.
    Unorm8,
    /// 65535 steps.
    Unorm16,
    /// 2³² steps, of which a float, from which they are made, tells 2²⁴ apart.
    Uint32,
    /// Half precision.
    Float16,
    /// Single precision.
    #[default]
    Float32,
}

impl Format {
    /// All, by the words that scene files have for them.
    pub const WORDS: [(&str, Self); 5] = [
        ("unorm8", Self::Unorm8),
        ("unorm16", Self::Unorm16),
        ("uint32", Self::Uint32),
        ("float16", Self::Float16),
        ("float32", Self::Float32),
    ];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// Bits of a stored depth.
    pub fn bits(self) -> u32 {
        match self {
            Self::Unorm8 => 8,
            Self::Unorm16 | Self::Float16 => 16,
            Self::Uint32 | Self::Float32 => 32,
        }
    }

    /// The code of depth 1.
    pub fn top(self) -> u32 {
        match self {
            Self::Unorm8 => 0xff,
            Self::Unorm16 => 0xffff,
            Self::Uint32 => u32::MAX,
            Self::Float16 => 0x3c00,
            Self::Float32 => 0x3f80_0000,
        }
    }

    /// The code of a depth in 0..=1, rounded to the nearest.
    pub fn quantised(self, lambda: f32) -> u32 {
        match self {
            Self::Unorm8 => (lambda * 255.0 + 0.5) as u32,
            Self::Unorm16 => (lambda * 65_535.0 + 0.5) as u32,
            // 1 saturates.
            Self::Uint32 => (lambda * 4_294_967_296.0) as u32,
            // Below 2⁻¹⁴ halves are steps of 2⁻²⁴; above, an exponent of 5 bits and 10 of the mantissa.
            Self::Float16 if lambda < SMALLEST_NORMAL_HALF => (lambda * 16_777_216.0 + 0.5) as u32,
            Self::Float16 => {
                let bits = lambda.to_bits();
                ((bits + 0xfff + (bits >> 13 & 1)) >> 13) - (112 << 10)
            }
            Self::Float32 => lambda.to_bits(),
        }
    }

    /// The depth of a code.
    pub fn dequantised(self, code: u32) -> f32 {
        match self {
            Self::Unorm8 => code as f32 / 255.0,
            Self::Unorm16 => code as f32 / 65_535.0,
            Self::Uint32 => code as f32 / 4_294_967_296.0,
            Self::Float16 if code < 1024 => code as f32 / 16_777_216.0,
            Self::Float16 => f32::from_bits((code << 13) + (112 << 23)),
            Self::Float32 => f32::from_bits(code),
        }
    }

    /// How far the depth of a code is from the one it was made from, at most.
    fn error(self, lambda: f64) -> f64 {
        match self {
            Self::Unorm8 => 0.5 / 255.0,
            Self::Unorm16 => 0.5 / 65_535.0,
            // Cut off, not rounded.
            Self::Uint32 => HALF_ULP * lambda + 1.0 / 4_294_967_296.0,
            Self::Float16 => (lambda / 2048.0).max(0.5 / 16_777_216.0),
            Self::Float32 => HALF_ULP * lambda,
        }
    }
}

/// The smallest half with all its bits: 2⁻¹⁴.
const SMALLEST_NORMAL_HALF: f32 = 1.0 / 16_384.0;

/// How distances become codes, and back.
///
/// Two codes are no distances. That of the near plane says of an entry that there is none before the eye (or the near plane),
/// and of an exit that the ray misses the lens. That of the far plane says of an exit that the lens has no end. What lies nearer
/// or further away than the planes is clamped to the codes between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthCode {
    /// The mapping.
    pub mapping: Mapping,
    /// Near plane, metres, > 0.
    pub near_m: f64,
    /// Far plane, metres, > near; 1/w has none and ignores it.
    pub far_m: f64,
    /// The format.
    pub format: Format,
}

/// Relative rounding of an f32: half of 2⁻²³.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;

impl DepthCode {
    /// Whether stored depths grow with distance; if not, every comparison of stored depths reverses.
    pub fn is_increasing(&self) -> bool {
        matches!(self.mapping, Mapping::Z | Mapping::W)
    }

    /// The stored depth of distance `d`, which is clamped to the clip range, not clipped.
    pub fn encode(&self, d: f64) -> f64 {
        let (n, f) = (self.near_m, self.far_m);
        let lambda = match self.mapping {
            Mapping::Z => f / (f - n) * (1.0 - n / d.max(n)),
            Mapping::ComplementaryZ => n / (f - n) * (f / d.max(n) - 1.0),
            Mapping::W => d / f,
            Mapping::InverseW => n / d.max(n),
            Mapping::ComplementaryW => (f - d) / (f - n),
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
            Mapping::ComplementaryW => f - lambda * (f - n),
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
            Mapping::ComplementaryW => (f - d) / (f - n),
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
            Mapping::ComplementaryW => f - lambda * (f - n),
        }
    }

    /// The code of the near plane.
    pub fn nearest(&self) -> u32 {
        if self.is_increasing() { 0 } else { self.format.top() }
    }

    /// The code of the far plane.
    pub fn farthest(&self) -> u32 {
        if self.is_increasing() { self.format.top() } else { 0 }
    }

    /// The code of a distance: never that of a plane.
    pub fn code(&self, d: f32) -> u32 {
        self.format.quantised(self.encode_f32(d)).clamp(1, self.format.top() - 1)
    }

    /// The code that a stored distance was decoded from, if it was one of these codes; else its code, as [`Self::code`].
    ///
    /// A distance that was coded, decoded and rounded to f32 would else often come back as a neighbour of its code.
    pub fn code_of_stored(&self, d: f32) -> u32 {
        let decoded = |code: u32| self.decode_f32(self.format.dequantised(code));
        let lambda = self.encode(f64::from(d)) as f32;
        let near = self.format.quantised(lambda).clamp(1, self.format.top() - 1);
        if decoded(near) == d {
            return near;
        }
        // Decoding is monotonic: the first code, from the near plane, that is not nearer.
        let from_near = |steps: u32| if self.is_increasing() { steps } else { self.format.top() - steps };
        let (mut low, mut high) = (1, self.format.top() - 1);
        while low < high {
            let middle = low + (high - low) / 2;
            if decoded(from_near(middle)) < d { low = middle + 1 } else { high = middle }
        }
        let found = from_near(low);
        if decoded(found) == d { found } else { near }
    }

    /// Where a ray is inside, as codes of its entry and exit; what begins nearer than `seen_m` begins before all that is seen.
    pub fn codes(&self, inside: Option<(f32, f32)>, seen_m: f32) -> [u32; 2] {
        let Some((enter, exit)) = inside else { return [self.farthest(), self.nearest()] };
        let entry = if enter <= seen_m { self.nearest() } else { self.code(enter) };
        [entry, if exit >= NO_END_M { self.farthest() } else { self.code(exit) }]
    }

    /// The inverse: metres, an entry before the eye as −∞ and no exit as +∞; `None` where the ray misses the lens.
    pub fn distances(&self, [entry, exit]: [u32; 2]) -> Option<(f32, f32)> {
        let decoded = |code: u32| self.decode_f32(self.format.dequantised(code));
        let enter = if entry == self.nearest() { f32::NEG_INFINITY } else { decoded(entry) };
        let exits = if exit == self.farthest() { f32::INFINITY } else { decoded(exit) };
        (exit != self.nearest()).then_some((enter, exits))
    }

    /// How far a stored distance near `d` is from the true one, at most, metres: the error of the format times dD/dλ. That is
    /// 2⁻²⁴·D for 1/w and w in 32-bit float, and grows with D² where steps of λ are alike.
    pub fn quantum_m(&self, d: f64) -> f64 {
        let (n, f) = (self.near_m, self.far_m);
        let slope = match self.mapping {
            Mapping::Z | Mapping::ComplementaryZ => d * d * (f - n) / (n * f),
            Mapping::W => f,
            Mapping::InverseW => d * d / n,
            Mapping::ComplementaryW => f - n,
        };
        slope * self.format.error(self.encode(d))
    }
}

/// From here on there is no end: beyond any city.
const NO_END_M: f32 = 1e30;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ALL: [Mapping; 5] =
        [Mapping::Z, Mapping::ComplementaryZ, Mapping::W, Mapping::InverseW, Mapping::ComplementaryW];

    fn code(mapping: Mapping, near_m: f64, far_m: f64) -> DepthCode {
        DepthCode { mapping, near_m, far_m, format: Format::Float32 }
    }

    #[test]
    fn ends_are_where_the_table_says() {
        for (mapping, near, far) in
            [(Mapping::Z, 0.0, 1.0), (Mapping::ComplementaryZ, 1.0, 0.0), (Mapping::W, 0.01, 1.0)]
        {
            let code = code(mapping, 1.0, 100.0);
            assert!((code.encode(1.0) - near).abs() < 1e-15 && (code.encode(100.0) - far).abs() < 1e-15);
        }
        let code = code(Mapping::InverseW, 0.5, f64::INFINITY);
        assert_eq!((code.encode(0.5), code.encode(f64::INFINITY)), (1.0, 0.0));
        assert_eq!(code.decode(0.0), f64::INFINITY);
    }

    #[test]
    fn nearer_than_near_is_clamped_not_lost() {
        for mapping in ALL {
            let code = code(mapping, 1.0, 100.0);
            for d in [-5.0, 0.0, 0.5] {
                assert!((0.0..=1.0).contains(&code.encode(d)), "{mapping:?} {d}");
            }
            assert!((0.0..=1.0).contains(&code.encode(1e9)));
        }
    }

    #[test]
    fn codes_of_formats_known_by_thought() {
        for (format, lambda, code) in [
            (Format::Unorm8, 0.5, 128),
            (Format::Unorm8, 0.001, 0),
            (Format::Unorm16, 0.25, 16_384),
            (Format::Uint32, 0.25, 1 << 30),
            (Format::Float16, 0.5, 0x3800),
            (Format::Float16, 0.000_000_1, 2),
            // Between 0x3800 and 0x3801: to the even one.
            (Format::Float16, 0.5 + 1.0 / 4096.0, 0x3800),
            (Format::Float16, 0.5 + 3.0 / 4096.0, 0x3802),
            (Format::Float32, 0.5, 0x3f00_0000),
        ] {
            assert_eq!(format.quantised(lambda), code, "{format:?} {lambda}");
        }
        for (word, format) in Format::WORDS {
            assert_eq!((format.word(), format.quantised(1.0)), (word, format.top()));
            assert_eq!((format.dequantised(0), format.dequantised(format.top())), (0.0, 1.0));
            // Every code that a float gives rise to comes back as itself.
            for code in (0..=format.top()).step_by((format.top() as usize / 9973).max(1)) {
                let lambda = format.dequantised(code);
                assert_eq!(format.dequantised(format.quantised(lambda)), lambda, "{format:?} {code}");
            }
        }
    }

    #[test]
    fn ends_that_are_no_distances() {
        for (_, format) in Format::WORDS {
            for mapping in ALL {
                let code = DepthCode { format, ..code(mapping, 2.0, 50.0) };
                let back = |inside| code.distances(code.codes(inside, 0.5));
                let none = f32::NEG_INFINITY;
                assert_eq!(back(None), None, "{code:?}");
                assert_eq!(back(Some((none, f32::INFINITY))), Some((none, f32::INFINITY)), "{code:?}");
                // At the planes and beyond them distances stay distances.
                for d in [1.0, 2.0, 50.0] {
                    let (enter, exit) = back(Some((d, d))).expect("no miss");
                    let room = 1.1 * (code.quantum_m(2.0) + code.quantum_m(50.0));
                    for end in [enter, exit] {
                        let right = if mapping == Mapping::W { d } else { d.max(2.0) };
                        assert!((f64::from(end) - f64::from(right)).abs() <= 2.0 * room, "{code:?} {d}: {end}");
                    }
                }
                let (enter, exit) = back(Some((0.4, 60.0))).expect("no miss");
                assert!(enter == none && exit > 10.0 && exit < f32::INFINITY, "{code:?}: {exit}");
            }
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn a_decoded_distance_finds_its_code(near in 0.1..90.0f64, depth in 0.5..5e3f64, part in 0.0..1.0f64) {
            for (_, format) in Format::WORDS {
                for mapping in ALL {
                    let exact = DepthCode { format, ..code(mapping, near, near + depth) };
                    let d = exact.decode_f32(format.dequantised(exact.code((near + part * depth) as f32)));
                    let again = exact.decode_f32(format.dequantised(exact.code_of_stored(d)));
                    prop_assert_eq!(d, again, "{:?}", exact);
                }
            }
        }

        #[test]
        fn a_stored_distance_is_off_by_no_more_than_its_quantum(near in 0.1..90.0f64, part in 0.0..1.0f64,
            depth in 0.5..5e3f64) {
            let far = near + depth;
            let d = near + part * depth;
            for (_, format) in Format::WORDS {
                for mapping in ALL {
                    let exact = DepthCode { format, ..code(mapping, near, far) };
                    let lambda = exact.encode(d) as f32;
                    let back = exact.decode(f64::from(format.dequantised(format.quantised(lambda))));
                    // To first order: coarse formats of a curved mapping.
                    let quantum = exact.quantum_m(d).max(exact.quantum_m(back.min(2.0 * far)));
                    if quantum < 0.1 * d {
                        prop_assert!((back - d).abs() <= 1.3 * quantum + 1e-6 * d, "{:?} {} {} {}", exact, d, back, quantum);
                    }
                }
            }
        }

        #[test]
        fn codes_keep_the_order(a in 1.0..1e3f32, b in 1.0..1e3f32) {
            for (_, format) in Format::WORDS {
                for mapping in ALL {
                    let code = DepthCode { format, ..code(mapping, 0.5, 2e3) };
                    let (low, high) = (code.code(a.min(b)), code.code(a.max(b)));
                    let is_kept = if code.is_increasing() { low <= high } else { low >= high };
                    prop_assert!(is_kept, "{:?} {} {}", code, a, b);
                }
            }
        }

        #[test]
        fn decoding_undoes_encoding(near in 0.1..2.0f64, part in 0.0..1.0f64, far in 10.0..5e4f64) {
            let d = near + part * (far - near);
            for mapping in ALL {
                let code = code(mapping, near, far);
                let back = code.decode(code.encode(d));
                // f64 has 2⁻⁵³ where the quantum has 2⁻²⁴.
                let room = 16.0 * (code.quantum_m(d) + HALF_ULP * d) / 536_870_912.0;
                prop_assert!((back - d).abs() <= room + 1e-12, "{:?} {} {}", mapping, d, back);
            }
        }

        #[test]
        fn a_stored_f32_is_off_by_its_quantum(near in 0.1..2.0f64, part in 0.001..0.999f64, far in 10.0..5e4f64) {
            let d = near + part * (far - near);
            for mapping in ALL {
                let code = code(mapping, near, far);
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
                let code = code(mapping, 0.5, 2e3);
                if (a - b).abs() > 1e-6 {
                    prop_assert_eq!((code.encode(a) < code.encode(b)) == (a < b), code.is_increasing());
                }
            }
        }
    }
}
