//! Colour ramps and category colours that people with colour-weak eyes can tell apart, as papers use them: [`RAMPS`] has a row for each.
//!
//! Their licences stand in `src/lens/ramp/NOTICE.md`. F. Crameri, "Scientific colour maps" (2018); C. Brewer, M. Harrower, "ColorBrewer"
//! (2003); P. Tol, "Colour schemes" (SRON technical note, 2021); M. Okabe, K. Ito, "Color Universal Design" (2008).

use std::sync::LazyLock;

use crate::lens::color::{Srgb, mixed};

/// What the order of a ramp's colours means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RampKind {
    /// From little to much.
    Sequential,
    /// From one side over a middle to the other.
    Diverging,
    /// Round in a circle: its ends are alike.
    Cyclic,
    /// Nothing: one colour for each category.
    Categorical,
}

impl RampKind {
    /// All kinds, as they are listed.
    pub const ALL: [Self; 4] = [Self::Sequential, Self::Diverging, Self::Cyclic, Self::Categorical];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sequential => "sequential",
            Self::Diverging => "diverging",
            Self::Cyclic => "cyclic",
            Self::Categorical => "categorical",
        }
    }
}

/// A ramp: its name in scene files, its kind, its colours, and who made it.
pub struct Ramp {
    /// Its name.
    pub name: &'static str,
    /// Its kind.
    pub kind: RampKind,
    /// Its author and the licence of its numbers.
    pub source: &'static str,
    data: Data,
}

/// The colours of a ramp, low to high.
enum Data {
    /// `rrggbb`, 256 of them: the text of a file.
    Table(LazyLock<Vec<Srgb>>),
    /// Few, in hexadecimal digits.
    Few(&'static [u32]),
}

const CRAMERI: &str = "F. Crameri, MIT";
const BREWER: &str = "ColorBrewer, Apache-2.0";
const TOL: &str = "P. Tol, SRON; BSD-3-Clause";

macro_rules! table {
    ($name:literal) => {
        Data::Table(LazyLock::new(|| table(include_str!(concat!("ramp/", $name, ".txt")))))
    };
}

const fn row(name: &'static str, kind: RampKind, source: &'static str, data: Data) -> Ramp {
    Ramp { name, kind, source, data }
}

/// The ramps, those of a kind one after the other, each kind's default first.
pub static RAMPS: [Ramp; COUNT] = {
    use RampKind::{Categorical, Cyclic, Diverging, Sequential};
    [
        row("viridis", Sequential, "S. van der Walt, N. Smith; CC0", table!("viridis")),
        row("cividis", Sequential, "J. Nuñez, C. Anderton, R. Renslow; CC0", table!("cividis")),
        row("batlow", Sequential, CRAMERI, table!("batlow")),
        row("lipari", Sequential, CRAMERI, table!("lipari")),
        row("lajolla", Sequential, CRAMERI, table!("lajolla")),
        row("acton", Sequential, CRAMERI, table!("acton")),
        row("devon", Sequential, CRAMERI, table!("devon")),
        row("blues", Sequential, BREWER, Data::Few(&BLUES)),
        row("greens", Sequential, BREWER, Data::Few(&GREENS)),
        row("reds", Sequential, BREWER, Data::Few(&REDS)),
        row("blue-purple", Sequential, BREWER, Data::Few(&BLUE_PURPLE)),
        row("yellow-blue", Sequential, BREWER, Data::Few(&YELLOW_BLUE)),
        row("vik", Diverging, CRAMERI, table!("vik")),
        row("roma", Diverging, CRAMERI, table!("roma")),
        row("broc", Diverging, CRAMERI, table!("broc")),
        row("purple-orange", Diverging, BREWER, Data::Few(&PURPLE_ORANGE)),
        row("red-blue", Diverging, BREWER, Data::Few(&RED_BLUE)),
        row("brown-teal", Diverging, BREWER, Data::Few(&BROWN_TEAL)),
        row("purple-green", Diverging, BREWER, Data::Few(&PURPLE_GREEN)),
        row("roma-o", Cyclic, CRAMERI, table!("roma-o")),
        row("bam-o", Cyclic, CRAMERI, table!("bam-o")),
        row("vik-o", Cyclic, CRAMERI, table!("vik-o")),
        row("okabe-ito", Categorical, "M. Okabe, K. Ito; free", Data::Few(&OKABE_ITO)),
        row("tol-bright", Categorical, TOL, Data::Few(&TOL_BRIGHT)),
        row("tol-muted", Categorical, TOL, Data::Few(&TOL_MUTED)),
        row("dark2", Categorical, BREWER, Data::Few(&DARK2)),
        row("paired", Categorical, BREWER, Data::Few(&PAIRED)),
    ]
};

const COUNT: usize = 27;

/// The ramps' names, in the order of [`RAMPS`].
pub const NAMES: &[&str] = &[
    "viridis",
    "cividis",
    "batlow",
    "lipari",
    "lajolla",
    "acton",
    "devon",
    "blues",
    "greens",
    "reds",
    "blue-purple",
    "yellow-blue",
    "vik",
    "roma",
    "broc",
    "purple-orange",
    "red-blue",
    "brown-teal",
    "purple-green",
    "roma-o",
    "bam-o",
    "vik-o",
    "okabe-ito",
    "tol-bright",
    "tol-muted",
    "dark2",
    "paired",
];

// ColorBrewer's classes of most colours: nine of sequential schemes (Blues, Greens, Reds, BuPu, YlGnBu), eleven of diverging ones (PuOr,
// RdBu, BrBG, PRGn).
const BLUES: [u32; 9] =
    [0xf7_fb_ff, 0xde_eb_f7, 0xc6_db_ef, 0x9e_ca_e1, 0x6b_ae_d6, 0x42_92_c6, 0x21_71_b5, 0x08_51_9c, 0x08_30_6b];
const GREENS: [u32; 9] =
    [0xf7_fc_f5, 0xe5_f5_e0, 0xc7_e9_c0, 0xa1_d9_9b, 0x74_c4_76, 0x41_ab_5d, 0x23_8b_45, 0x00_6d_2c, 0x00_44_1b];
const REDS: [u32; 9] =
    [0xff_f5_f0, 0xfe_e0_d2, 0xfc_bb_a1, 0xfc_92_72, 0xfb_6a_4a, 0xef_3b_2c, 0xcb_18_1d, 0xa5_0f_15, 0x67_00_0d];
const BLUE_PURPLE: [u32; 9] =
    [0xf7_fc_fd, 0xe0_ec_f4, 0xbf_d3_e6, 0x9e_bc_da, 0x8c_96_c6, 0x8c_6b_b1, 0x88_41_9d, 0x81_0f_7c, 0x4d_00_4b];
const YELLOW_BLUE: [u32; 9] =
    [0xff_ff_d9, 0xed_f8_b1, 0xc7_e9_b4, 0x7f_cd_bb, 0x41_b6_c4, 0x1d_91_c0, 0x22_5e_a8, 0x25_34_94, 0x08_1d_58];
const PURPLE_ORANGE: [u32; 11] = [
    0x2d_00_4b, 0x54_27_88, 0x80_73_ac, 0xb2_ab_d2, 0xd8_da_eb, 0xf7_f7_f7, 0xfe_e0_b6, 0xfd_b8_63, 0xe0_82_14,
    0xb3_58_06, 0x7f_3b_08,
];
const RED_BLUE: [u32; 11] = [
    0x67_00_1f, 0xb2_18_2b, 0xd6_60_4d, 0xf4_a5_82, 0xfd_db_c7, 0xf7_f7_f7, 0xd1_e5_f0, 0x92_c5_de, 0x43_93_c3,
    0x21_66_ac, 0x05_30_61,
];
const BROWN_TEAL: [u32; 11] = [
    0x54_30_05, 0x8c_51_0a, 0xbf_81_2d, 0xdf_c2_7d, 0xf6_e8_c3, 0xf5_f5_f5, 0xc7_ea_e5, 0x80_cd_c1, 0x35_97_8f,
    0x01_66_5e, 0x00_3c_30,
];
const PURPLE_GREEN: [u32; 11] = [
    0x40_00_4b, 0x76_2a_83, 0x99_70_ab, 0xc2_a5_cf, 0xe7_d4_e8, 0xf7_f7_f7, 0xd9_f0_d3, 0xa6_db_a0, 0x5a_ae_61,
    0x1b_78_37, 0x00_44_1b,
];

/// Okabe and Ito's colours without black (which reads as shadow), clearest first.
const OKABE_ITO: [u32; 7] = [0x00_72_b2, 0xe6_9f_00, 0x00_9e_73, 0xcc_79_a7, 0x56_b4_e9, 0xd5_5e_00, 0xf0_e4_42];
/// Tol's, and Brewer's Dark2, without their greys, which are for what has no value.
const TOL_BRIGHT: [u32; 6] = [0x44_77_aa, 0xee_66_77, 0x22_88_33, 0xcc_bb_44, 0x66_cc_ee, 0xaa_33_77];
const TOL_MUTED: [u32; 9] =
    [0xcc_66_77, 0x33_22_88, 0xdd_cc_77, 0x11_77_33, 0x88_cc_ee, 0x88_22_55, 0x44_aa_99, 0x99_99_33, 0xaa_44_99];
const DARK2: [u32; 7] = [0x1b_9e_77, 0xd9_5f_02, 0x75_70_b3, 0xe7_29_8a, 0x66_a6_1e, 0xe6_ab_02, 0xa6_76_1d];
const PAIRED: [u32; 12] = [
    0xa6_ce_e3, 0x1f_78_b4, 0xb2_df_8a, 0x33_a0_2c, 0xfb_9a_99, 0xe3_1a_1c, 0xfd_bf_6f, 0xff_7f_00, 0xca_b2_d6,
    0x6a_3d_9a, 0xff_ff_99, 0xb1_59_28,
];

/// Categories that get a colour of their own; what is rarer is "other".
pub const MAX_CATEGORIES: usize = 14;

fn srgb(hex: u32) -> Srgb {
    [hex >> 16, hex >> 8 & 0xff, hex & 0xff].map(|c| c as f32 / 255.0)
}

fn table(text: &str) -> Vec<Srgb> {
    text.split_whitespace().filter_map(|hex| u32::from_str_radix(hex, 16).ok()).map(srgb).collect()
}

/// Colours from low to high, and what their order means: a ramp's, or a list of a user's.
#[derive(Clone, Debug, PartialEq)]
pub struct RampColors {
    /// What their order means.
    pub kind: RampKind,
    /// At least one, sRGB 0..1.
    colors: Vec<Srgb>,
}

impl RampColors {
    /// Those of the ramp called `name`; unknown names give `viridis`.
    pub fn named(name: &str) -> Self {
        let ramp = RAMPS.iter().find(|ramp| ramp.name == name).unwrap_or(&RAMPS[0]);
        let colors = match &ramp.data {
            Data::Table(table) => table.to_vec(),
            Data::Few(few) => few.iter().copied().map(srgb).collect(),
        };
        Self { kind: ramp.kind, colors }
    }

    /// A user's list; an empty one is grey.
    pub fn own(kind: RampKind, mut colors: Vec<Srgb>) -> Self {
        if colors.is_empty() {
            colors.push([0.5; 3]);
        }
        Self { kind, colors }
    }

    /// The same from high to low.
    pub fn reversed(mut self) -> Self {
        self.colors.reverse();
        self
    }

    /// The colour at `t` (0 = low, 1 = high; clamped, NaN = low). Categories are steps.
    pub fn at(&self, t: f64) -> Srgb {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        let last = self.colors.len() - 1;
        if self.kind == RampKind::Categorical {
            return self.colors[((t * self.colors.len() as f64) as usize).min(last)];
        }
        let at = t * last as f64;
        let below = (at as usize).min(last.saturating_sub(1));
        mixed(self.colors[below], self.colors[(below + 1).min(last)], (at - below as f64) as f32)
    }

    /// The colours of `count` classes or categories, in order: as many as there are of categories, darker ones after them; places at
    /// equal distances of all other ramps, the middles of equal parts of cyclic ones.
    pub fn classes(&self, count: usize) -> Vec<Srgb> {
        let share = |i: usize| match self.kind {
            RampKind::Cyclic => (i as f64 + 0.5) / count as f64,
            _ if count == 1 => 0.5,
            _ => i as f64 / (count - 1) as f64,
        };
        let one = |i| match self.kind {
            RampKind::Categorical => self.category(i),
            _ => self.at(share(i)),
        };
        (0..count).map(one).collect()
    }

    fn category(&self, i: usize) -> Srgb {
        let plain = self.colors[i % self.colors.len()];
        if i < self.colors.len() { plain } else { mixed(plain, [0.1; 3], 0.45) }
    }
}

/// The colour at `t` (0 = low, 1 = high; clamped, NaN = low) of a ramp; unknown names give `viridis`.
pub fn ramp(name: &str, t: f64) -> Srgb {
    RampColors::named(name).at(t)
}

/// The colour of category `i` of [`MAX_CATEGORIES`], by Okabe and Ito.
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
        for row in &RAMPS {
            let lightness: Vec<f32> =
                (0..=100).map(|i| oklab_from_srgb(ramp(row.name, f64::from(i) / 100.0))[0]).collect();
            match row.kind {
                // ColorBrewer's run from light to dark, the others from dark to light.
                RampKind::Sequential => {
                    let is_rising = lightness[0] < lightness[100];
                    assert_eq!(is_rising, row.source != BREWER, "{}", row.name);
                    let grows = |w: &[f32]| if is_rising { w[0] < w[1] } else { w[0] > w[1] };
                    assert!(lightness.windows(2).all(grows), "{}: {lightness:?}", row.name);
                }
                RampKind::Diverging => {
                    let middle = lightness[50];
                    assert!(lightness.iter().all(|l| *l <= middle + 0.02), "{}: {lightness:?}", row.name);
                }
                RampKind::Cyclic => assert!((lightness[0] - lightness[100]).abs() < 0.02, "{}", row.name),
                RampKind::Categorical => {}
            }
        }
    }

    #[test]
    fn fifths_of_a_ramp_and_the_first_categories_differ_to_everyone() {
        for deutan in [true, false] {
            for row in RAMPS.iter().filter(|row| matches!(row.kind, RampKind::Sequential | RampKind::Diverging)) {
                for i in 0..4 {
                    let (a, b) = (ramp(row.name, f64::from(i) / 4.0), ramp(row.name, f64::from(i + 1) / 4.0));
                    let apart = difference(weak(a, deutan), weak(b, deutan));
                    assert!(apart > 0.075, "{} {i}: {apart}", row.name);
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
        let is_whole = |ramp: &Ramp| !matches!(&ramp.data, Data::Table(table) if table.len() != 256);
        assert!(RAMPS.iter().all(is_whole));
    }

    #[test]
    fn names_and_kinds_are_those_of_the_rows() {
        assert!(RAMPS.iter().map(|row| row.name).eq(NAMES.iter().copied()));
        assert!(RAMPS.is_sorted_by_key(|row| RampKind::ALL.iter().position(|kind| *kind == row.kind)));
        let notice = include_str!("ramp/NOTICE.md");
        for row in &RAMPS {
            assert!(notice.contains(&format!("`{}`", row.name)), "{}", row.name);
            let differ = |a: Srgb, b: Srgb| difference(a, b) > 0.01;
            let colors = RampColors::named(row.name).classes(9);
            assert!((0..9).all(|i| (0..i).all(|j| differ(colors[i], colors[j]))), "{}", row.name);
            let back: Vec<Srgb> = RampColors::named(row.name).reversed().classes(2);
            if matches!(row.kind, RampKind::Sequential | RampKind::Diverging) {
                assert_eq!(back, [ramp(row.name, 1.0), ramp(row.name, 0.0)], "{}", row.name);
            }
        }
    }

    #[test]
    fn places_of_classes() {
        let of = |kind, count| RampColors::own(kind, vec![[0.0; 3], [1.0; 3]]).classes(count);
        assert_eq!(of(RampKind::Sequential, 2), [[0.0; 3], [1.0; 3]]);
        assert_eq!(
            of(RampKind::Sequential, 1),
            [RampColors::own(RampKind::Sequential, vec![[0.0; 3], [1.0; 3]]).at(0.5)]
        );
        assert_eq!(of(RampKind::Categorical, 3)[..2], [[0.0; 3], [1.0; 3]]);
        // Halves of a circle: their middles, not its ends, which are alike.
        let quarter = RampColors::own(RampKind::Cyclic, vec![[0.0; 3], [1.0; 3]]);
        assert_eq!(of(RampKind::Cyclic, 2), [quarter.at(0.25), quarter.at(0.75)]);
        let steps = RampColors::named("okabe-ito");
        assert_eq!([0.0, 0.99 / 7.0, 1.01 / 7.0, 1.0].map(|t| steps.at(t)), [0, 0, 1, 6].map(category));
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
