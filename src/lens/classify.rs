//! The volumetric depth test (Trapp §3.2) on the CPU: where a surface lies with regard to a lens.

use crate::{
    geom::{Ray, Volume, shape::solid::FaceCrossing},
    lens::class::Class,
};

/// Where a sight line crosses the border of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance D along the view axis, metres.
    pub depth: f64,
    /// +1 where the line enters, −1 where it leaves.
    pub step: i32,
}

/// The intervals `[entry, exit)` in which a sight line is inside, ascending and apart, from its crossings in any order:
/// inside where the sum of steps is not 0. Exits without an entry mean that the eye is inside: D_F = 0.
/// Entries without an exit reach to infinity. Crossings at NaN are left out.
pub fn intervals_of(crossings: &[Crossing]) -> Vec<(f64, f64)> {
    let mut sorted: Vec<Crossing> = crossings.iter().filter(|c| !c.depth.is_nan()).copied().collect();
    sorted.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    // Closed solids enter as often as they leave; what is missing lies behind the eye.
    let total: i32 = sorted.iter().map(|c| c.step).sum();
    let mut sum = if total < 0 { -total } else { 0 };
    let mut intervals = Vec::new();
    let mut entry = (sum != 0).then_some(0.0);
    for group in sorted.chunk_by(|a, b| a.depth == b.depth) {
        sum += group.iter().map(|c| c.step).sum::<i32>();
        match entry {
            None if sum != 0 => entry = Some(group[0].depth),
            Some(start) if sum == 0 => {
                intervals.push((start, group[0].depth));
                entry = None;
            }
            _ => {}
        }
    }
    intervals.extend(entry.map(|start| (start, f64::INFINITY)));
    intervals
}

/// Where a surface at distance `d` (+∞: none) lies with regard to a lens that the sight line is inside of in
/// `intervals` (`entry ≤ D < exit`, in any order, overlaps allowed).
///
/// Inside any interval: inside. Before the first entry: in front. At or after the last exit: behind. Between two
/// intervals, or no interval in front of the eye: rest. No surface is inside only what has no end.
pub fn classify(intervals: &[(f64, f64)], d: f64) -> Class {
    let mut first = f64::INFINITY;
    let mut last = f64::NEG_INFINITY;
    for &(entry, exit) in intervals {
        // Empty, NaN, or wholly behind the eye: this line does not meet it.
        if !(entry < exit && exit > 0.0) {
            continue;
        }
        if entry <= d && (d < exit || exit == f64::INFINITY) {
            return Class::Inside;
        }
        first = first.min(entry);
        last = last.max(exit);
    }
    if d < first && last > 0.0 {
        Class::Front
    } else if d >= last && last > 0.0 {
        Class::Behind
    } else {
        Class::Rest
    }
}

/// Where a line of sight is inside of a volume, ascending and apart; `t` of the ray in place of D.
pub fn intervals(volume: &Volume, ray: &Ray) -> Vec<(f64, f64)> {
    match volume {
        Volume::Solid(placed) => {
            let crossings = placed.solid.crossings(&placed.local_ray(ray));
            let crossing = |c: &FaceCrossing| Crossing { depth: c.t, step: c.step };
            intervals_of(&crossings.iter().map(crossing).collect::<Vec<_>>())
        }
        _ => volume.entry_exit(ray).into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const INF: f64 = f64::INFINITY;

    #[test]
    fn one_solid() {
        let lens = [(2.0, 5.0)];
        for (d, class) in [
            (1.0, Class::Front),
            (2.0, Class::Inside),
            (4.999, Class::Inside),
            (5.0, Class::Behind),
            (INF, Class::Behind),
        ] {
            assert_eq!(classify(&lens, d), class, "{d}");
        }
        assert_eq!(classify(&[], 3.0), Class::Rest);
        assert_eq!(classify(&lens, f64::NAN), Class::Rest);
    }

    #[test]
    fn between_two_solids_is_rest() {
        let lens = [(8.0, 9.0), (2.0, 5.0)];
        assert_eq!(classify(&lens, 6.0), Class::Rest);
        assert_eq!(classify(&lens, 1.0), Class::Front);
        assert_eq!(classify(&lens, 8.5), Class::Inside);
        assert_eq!(classify(&lens, 9.0), Class::Behind);
    }

    #[test]
    fn eye_inside_lens_behind_and_lens_without_end() {
        assert_eq!(classify(&[(-3.0, 5.0)], 0.1), Class::Inside);
        assert_eq!(classify(&[(-3.0, -1.0)], 0.1), Class::Rest);
        assert_eq!(classify(&[(-3.0, 0.0)], 0.1), Class::Rest);
        assert_eq!(classify(&[(4.0, INF)], INF), Class::Inside);
        assert_eq!(classify(&[(4.0, 4.0)], 4.0), Class::Rest, "an empty interval is a miss");
    }

    #[test]
    fn crossings_of_a_concave_solid_seen_from_within() {
        let at = |depth, step| Crossing { depth, step };
        assert_eq!(intervals_of(&[at(5.0, -1)]), [(0.0, 5.0)]);
        assert_eq!(intervals_of(&[at(5.0, 1)]), [(5.0, INF)]);
        assert_eq!(intervals_of(&[at(9.0, -1), at(3.0, -1), at(7.0, 1)]), [(0.0, 3.0), (7.0, 9.0)]);
        // Two solids that overlap, and two that touch.
        assert_eq!(intervals_of(&[at(1.0, 1), at(2.0, 1), at(3.0, -1), at(4.0, -1)]), [(1.0, 4.0)]);
        assert_eq!(intervals_of(&[at(1.0, 1), at(2.0, -1), at(2.0, 1), at(3.0, -1)]), [(1.0, 3.0)]);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// The oracle counts, at d itself, the solids that hold d; it sorts nothing.
        #[test]
        fn crossings_say_what_counting_says(solids in prop::collection::vec((0..40i32, 1..20i32), 1..9), d in 0..120i32) {
            let crossings: Vec<Crossing> = solids.iter().flat_map(|(start, length)| {
                [Crossing { depth: f64::from(*start), step: 1 }, Crossing { depth: f64::from(start + length), step: -1 }]
            }).collect();
            let holds = solids.iter().any(|(start, length)| (*start..start + length).contains(&(d / 2)) );
            let expected = if holds {
                Class::Inside
            } else if solids.iter().all(|(start, _)| d / 2 < *start) {
                Class::Front
            } else if solids.iter().all(|(start, length)| d / 2 >= start + length) {
                Class::Behind
            } else {
                Class::Rest
            };
            prop_assert_eq!(classify(&intervals_of(&crossings), f64::from(d / 2)), expected);
        }
    }
}
