//! How light acts on colours that mean something: it moves lightness alone, and never so far that one colour of a legend is taken for
//! another.
//!
//! A class's hue and chroma stay (OKLab's a and b; chroma goes down where a screen does not have the colour). Its lightness goes from L − r
//! in the dark to L + r in full light; r, the *relief*, is the largest, up to [`MOST`], with which every colour seen stays nearest to its own
//! entry among all entries of the legend. *Near* is the plain distance in OKLab, so lightness counts in full, as it does for who holds a
//! picture against its legend.

use crate::lens::color::{Srgb, linear_in_gamut, oklab_from_srgb, srgb_from_linear};

/// The most that light moves lightness, to either side.
pub const MOST: f32 = 0.12;
/// Steps in which the relief is looked for.
const STEP: f32 = 0.002;
/// How much nearer than any other its own entry must be.
const NEARER: f32 = 0.93;
/// As many places of a smooth ramp are told apart.
pub const STEPS_OF_SMOOTH: usize = 7;

/// The colour seen of one of a legend in light of 0 (none) to 1 (the sun, straight on). Twin of `shown_under_light` in
/// `lib/color.wgsl`.
pub fn shown(color: Srgb, relief: f32, shade: f32) -> Srgb {
    let [lightness, a, b] = oklab_from_srgb(color);
    let moved = (lightness + relief * (2.0 * shade.clamp(0.0, 1.0) - 1.0)).clamp(0.0, 1.0);
    srgb_from_linear(linear_in_gamut([moved, a, b]))
}

/// The relief of a legend of these colours, 0 to [`MOST`]: of equal ones, which nothing tells apart, as of one.
pub fn of(colors: &[Srgb]) -> f32 {
    let entries: Vec<[f32; 3]> = each_once(colors);
    let fits = |relief: f32| (0..entries.len()).all(|i| [-1.0, 1.0].iter().all(|way| stays(&entries, i, way * relief)));
    let steps = (MOST / STEP).round() as u32;
    let failed = (1..=steps).map(|i| i as f32 * STEP).find(|relief| !fits(*relief));
    failed.map_or(MOST, |relief| relief - STEP)
}

/// Entries in OKLab, each once.
fn each_once(colors: &[Srgb]) -> Vec<[f32; 3]> {
    let mut entries: Vec<[f32; 3]> = Vec::new();
    for lab in colors.iter().map(|color| oklab_from_srgb(*color)) {
        if entries.iter().all(|entry| squared(*entry, lab) > SAME) {
            entries.push(lab);
        }
    }
    entries
}

/// Squared distance up to which two colours are one: less than a step of 8 bits.
const SAME: f32 = 1e-6;

fn squared(p: [f32; 3], q: [f32; 3]) -> f32 {
    (0..3).map(|i| (p[i] - q[i]).powi(2)).sum()
}

/// Whether an entry so much lighter, as a picture of 8 bits has it, is nearest to itself.
fn stays(entries: &[[f32; 3]], own: usize, lighter: f32) -> bool {
    let [lightness, a, b] = entries[own];
    let shown = srgb_from_linear(linear_in_gamut([(lightness + lighter).clamp(0.0, 1.0), a, b]));
    let seen = oklab_from_srgb(shown.map(|c| (c * 255.0).round() / 255.0));
    let off = squared(seen, entries[own]);
    entries.iter().enumerate().all(|(i, other)| i == own || off < NEARER * NEARER * squared(seen, *other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::{
        color::{difference, linear_from_oklab, linear_from_srgb},
        ramp::{RAMPS, RampColors, RampKind},
    };

    const NO_DATA: Srgb = [168.0 / 255.0; 3];

    /// The nearest of some colours, in OKLab.
    fn nearest(seen: Srgb, entries: &[Srgb]) -> usize {
        let far = |i: &usize| difference(seen, entries[*i]);
        (0..entries.len()).min_by(|i, j| far(i).total_cmp(&far(j))).expect("entries")
    }

    #[test]
    fn every_class_of_every_ramp_is_told_in_sun_and_shade() {
        let mut least = (f32::MAX, "");
        for row in &RAMPS {
            for count in 2..=9 {
                let mut entries = RampColors::named(row.name).classes(count);
                entries.push(NO_DATA);
                let relief = of(&entries);
                if relief < least.0 {
                    least = (relief, row.name);
                }
                // Enough that walls stand out from each other, and more where there are few classes.
                let enough = if count <= 5 { 0.03 } else { 0.012 };
                assert!(relief >= enough && relief <= MOST, "{} {count}: {relief}", row.name);
                for (i, entry) in entries.iter().enumerate() {
                    for step in 0..=20_u8 {
                        let seen = shown(*entry, relief, f32::from(step) / 20.0);
                        let in_picture = seen.map(|c| (c * 255.0).round() / 255.0);
                        assert_eq!(nearest(in_picture, &entries), i, "{} {count}: {entry:?} {step}", row.name);
                    }
                }
            }
        }
        assert!(least.0 < MOST, "{least:?}");
    }

    #[test]
    fn light_leaves_hue_and_takes_chroma_only_where_it_must() {
        for row in RAMPS.iter().filter(|row| row.kind != RampKind::Diverging) {
            for color in RampColors::named(row.name).classes(7) {
                let [lightness, a, b] = oklab_from_srgb(color);
                for step in 0..=10_u8 {
                    let shade = f32::from(step) / 10.0;
                    let [l, c, d] = oklab_from_srgb(shown(color, MOST, shade));
                    let wanted = (lightness + MOST * (2.0 * shade - 1.0)).clamp(0.0, 1.0);
                    assert!((l - wanted).abs() < 2e-3, "{}: {l} for {wanted}", row.name);
                    let [own, seen] = [[a, b], [c, d]].map(|v| v[0].hypot(v[1]));
                    assert!(seen <= own + 1e-3, "{}: {seen} of {own}", row.name);
                    // On the same line from grey.
                    assert!((a * d - b * c).abs() <= 2e-3 * own.max(0.01) && a * c + b * d >= -1e-5, "{}", row.name);
                    let is_there = linear_from_oklab([wanted, a, b]).iter().all(|v| (0.0..=1.0).contains(v));
                    assert!(!is_there || (own - seen).abs() < 2e-3, "{}: {seen} of {own}", row.name);
                }
            }
        }
    }

    #[test]
    fn relief_of_closed_forms() {
        // Greys so far apart: what moves by less than half of that stays nearer to its own.
        let grey = |lightness: f32| srgb_from_linear(linear_from_oklab([lightness, 0.0, 0.0]));
        let relief = of(&[grey(0.4), grey(0.5)]);
        assert!(relief > 0.042 && relief < 0.05, "{relief}");
        assert_eq!(of(&[grey(0.3), grey(0.8)]), MOST);
        assert_eq!(of(&[grey(0.5); 3]), MOST, "of one colour");
        assert_eq!(of(&[]), MOST);
        assert!(of(&[grey(0.5), grey(0.505)]) < 0.004);
        // In the middle of its range a colour is the legend's.
        let color = [0.2, 0.5, 0.7];
        assert!(difference(shown(color, 0.1, 0.5), color) < 1e-4);
        assert!(linear_from_srgb(shown([1.0, 0.9, 0.1], MOST, 1.0)).iter().all(|c| (0.0..=1.0).contains(c)));
    }
}
