//! Colour ramps and category colours that people with colour-weak eyes can tell apart.
//!
//! * `viridis`: S. van der Walt, N. Smith (matplotlib, CC0), all 256 colours. * `cividis`: J. Nuñez, C. Anderton, R. Renslow, PLOS ONE
//!   13(7), 2018, the authors' 256 colours. * `purple-orange`: PuOr of ColorBrewer (C. Brewer, M. Harrower; Apache 2.0) in eleven classes,
//!   diverging. * Categories: M. Okabe, K. Ito, "Color Universal Design" (2008), and the same again lighter and darker.

use std::sync::LazyLock;

use crate::lens::color::{Srgb, mixed};

/// The ramps' names.
pub const NAMES: &[&str] = &["viridis", "cividis", "purple-orange"];

/// The 256 colours of a published table.
type Table = LazyLock<Vec<u32>>;

static VIRIDIS: Table = LazyLock::new(|| table(include_str!("ramp/viridis.txt")));
static CIVIDIS: Table = LazyLock::new(|| table(include_str!("ramp/cividis.txt")));
const PURPLE_ORANGE: &[u32] = &[
    0x2d_00_4b, 0x54_27_88, 0x80_73_ac, 0xb2_ab_d2, 0xd8_da_eb, 0xf7_f7_f7, 0xfe_e0_b6, 0xfd_b8_63, 0xe0_82_14,
    0xb3_58_06, 0x7f_3b_08,
];

/// Okabe and Ito's colours without black (which reads as shadow), clearest first.
const OKABE_ITO: [u32; 7] = [0x00_72_b2, 0xe6_9f_00, 0x00_9e_73, 0xcc_79_a7, 0x56_b4_e9, 0xd5_5e_00, 0xf0_e4_42];

/// Categories that get a colour of their own; what is rarer is "other".
pub const MAX_CATEGORIES: usize = 14;

fn srgb(hex: u32) -> Srgb {
    [hex >> 16, hex >> 8 & 0xff, hex & 0xff].map(|c| c as f32 / 255.0)
}

fn table(text: &str) -> Vec<u32> {
    text.split_whitespace().filter_map(|hex| u32::from_str_radix(hex, 16).ok()).collect()
}

/// The colour at `t` (0 = low, 1 = high; clamped, NaN = low) of a ramp; unknown names give `viridis`.
pub fn ramp(name: &str, t: f64) -> Srgb {
    let entries: &[u32] = match name {
        "cividis" => &CIVIDIS,
        "purple-orange" => PURPLE_ORANGE,
        _ => &VIRIDIS,
    };
    let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    let at = t * (entries.len() - 1) as f64;
    let below = (at as usize).min(entries.len() - 2);
    mixed(srgb(entries[below]), srgb(entries[below + 1]), (at - below as f64) as f32)
}

/// The colour of category `i` of [`MAX_CATEGORIES`].
pub fn category(i: usize) -> Srgb {
    let plain = srgb(OKABE_ITO[i % OKABE_ITO.len()]);
    if i < OKABE_ITO.len() { plain } else { mixed(plain, [0.1; 3], 0.45) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::color::{difference, linear_from_srgb, oklab_from_srgb, srgb_from_linear};

    /// How the colour looks without red or green cones (Machado, Oliveira, Fernandes 2009, severity 1).
    fn weak(color: Srgb, deutan: bool) -> Srgb {
        let m = if deutan {
            [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_82, 0.042_94, 0.968_881]]
        } else {
            [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]]
        };
        let c = linear_from_srgb(color);
        srgb_from_linear(m.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2]))
    }

    #[test]
    fn sequential_ramps_grow_lighter_all_the_way() {
        for name in ["viridis", "cividis"] {
            let lightness: Vec<f32> = (0..=100).map(|i| oklab_from_srgb(ramp(name, f64::from(i) / 100.0))[0]).collect();
            assert!(lightness.windows(2).all(|w| w[0] < w[1]), "{name}: {lightness:?}");
        }
        let middle = oklab_from_srgb(ramp("purple-orange", 0.5))[0];
        assert!((0..=100).all(|i| oklab_from_srgb(ramp("purple-orange", f64::from(i) / 100.0))[0] <= middle));
    }

    #[test]
    fn fifths_of_a_ramp_and_the_first_categories_differ_to_everyone() {
        for deutan in [true, false] {
            for name in NAMES {
                for i in 0..4 {
                    let (a, b) = (ramp(name, f64::from(i) / 4.0), ramp(name, f64::from(i + 1) / 4.0));
                    assert!(difference(weak(a, deutan), weak(b, deutan)) > 0.08, "{name} {i}");
                }
            }
            for i in 0..7 {
                for j in 0..i {
                    let apart = difference(weak(category(i), deutan), weak(category(j), deutan));
                    assert!(apart > 0.05, "categories {i} and {j}: {apart}");
                }
            }
        }
    }

    /// Colours as the publications have them in numbers, not from the tables here: every 17th of viridis, and places of cividis
    /// as its authors' list of parts says.
    #[test]
    fn published_colours_are_met_to_a_255th() {
        let viridis = [
            0x44_01_54, 0x48_1a_6c, 0x47_2f_7d, 0x41_44_87, 0x39_56_8c, 0x31_68_8e, 0x2a_78_8e, 0x23_88_8e, 0x1f_98_8b,
            0x22_a8_84, 0x35_b7_79, 0x54_c5_68, 0x7a_d1_51, 0xa5_db_36, 0xd2_e2_1b, 0xfd_e7_25,
        ];
        let cividis: [(usize, Srgb); 8] = [
            (8, [0.0000, 0.1492, 0.3537]),
            (43, [0.1431, 0.2442, 0.4245]),
            (78, [0.3132, 0.3424, 0.4236]),
            (113, [0.4388, 0.4419, 0.4521]),
            (148, [0.5657, 0.5461, 0.4727]),
            (183, [0.7060, 0.6577, 0.4463]),
            (218, [0.8548, 0.7781, 0.3818]),
            (253, [1.0000, 0.9094, 0.2634]),
        ];
        let parts = viridis.iter().enumerate().map(|(i, hex)| ("viridis", 17 * i, srgb(*hex)));
        for (name, i, published) in parts.chain(cividis.iter().map(|(i, c)| ("cividis", *i, *c))) {
            let shown = ramp(name, i as f64 / 255.0);
            let most = (0..3).map(|k| (shown[k] - published[k]).abs()).fold(0.0, f32::max);
            assert!(most <= 1.0 / 255.0, "{name} {i}: {shown:?} {published:?}");
        }
        assert!(VIRIDIS.len() == 256 && CIVIDIS.len() == 256);
    }

    #[test]
    fn ends_and_nonsense() {
        assert_eq!(ramp("viridis", 0.0), srgb(0x44_01_54));
        assert_eq!(ramp("viridis", 1.0), srgb(0xfd_e7_25));
        assert_eq!(ramp("viridis", 9.0), ramp("viridis", 1.0));
        assert_eq!(ramp("viridis", f64::NAN), ramp("viridis", 0.0));
        for i in 0..MAX_CATEGORIES {
            assert!((0..i).all(|j| difference(category(i), category(j)) > 0.05), "{i}");
        }
    }
}
