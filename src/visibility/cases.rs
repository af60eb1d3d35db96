//! Cases over time: which of several ways an occluder is drawn in changes by the same margin and fade as whether it is one.

use crate::visibility::memory::Pace;

/// Which of some cases something is in, and how far each of them has come to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseMemory {
    case: usize,
    /// The share of each case, in order, ≥ 0; together 1.
    shares: Vec<f64>,
}

impl CaseMemory {
    /// Wholly in one of so many.
    pub fn settled(case: usize, count: usize) -> Self {
        Self { case, shares: (0..count).map(|i| f64::from(u8::from(i == case))).collect() }
    }

    /// Which it is in.
    pub fn case(&self) -> usize {
        self.case
    }

    /// Goes on by `dt` seconds, ≥ 0, to a moment when `now` is the first case that holds; `stays`: whether the one that it was in still
    /// holds with its margin.
    pub fn step(&mut self, now: usize, stays: bool, pace: Pace, dt: f64) {
        if now < self.case || !stays {
            self.case = now;
        }
        let others = 1.0 - self.shares[self.case];
        let by = if pace.fade_s > 0.0 { (dt / pace.fade_s).max(0.0) } else { 1.0 };
        if by >= others {
            *self = Self::settled(self.case, self.shares.len());
            return;
        }
        let left = (others - by) / others;
        self.shares.iter_mut().for_each(|share| *share *= left);
        self.shares[self.case] = 1.0 - others + by;
    }

    /// Between which thresholds, of 0 to `weight`, a case is drawn: those of all cases in order leave nothing out and have nothing in common.
    pub fn thresholds(&self, case: usize, weight: f64) -> [f32; 2] {
        // What begins where the one before ends is the same number; the last that has a share ends with the weight.
        let end = |count: usize| {
            let is_all = self.shares[count..].iter().all(|share| *share == 0.0);
            let below: f64 = self.shares[..count].iter().sum();
            (if is_all { weight } else { weight * below.min(1.0) }) as f32
        };
        [end(case), end(case + 1)]
    }

    /// Whether all fades are over.
    pub fn is_settled(&self) -> bool {
        self.shares[self.case] == 1.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Cases by distance: between two changes the whole margin is crossed, shares follow without a jump, and each threshold
        /// below the weight is that of one case.
        #[test]
        fn a_case_changes_once_per_crossing_and_shares_make_a_whole(
            start in 0.0..60.0f64,
            steps in prop::collection::vec((-9.0..9.0f64, 0.0..0.2f64), 1..150),
            weight in 0.0..1.0f64,
        ) {
            let (ends, margin, pace) = ([20.0, 40.0], 3.0, Pace { fade_s: 0.3 });
            let first = |away: f64| ends.iter().position(|end| away < *end).unwrap_or(2);
            let stays = |case: usize, away: f64| ends.get(case).is_none_or(|end| away < end + margin);
            let mut away: f64 = start;
            let mut memory = CaseMemory::settled(first(away), 3);
            for (by, dt) in steps {
                let before = memory.clone();
                away = (away + by).abs();
                memory.step(first(away), stays(before.case(), away), pace, dt);
                if memory.case() != before.case() {
                    let is_beyond = if memory.case() < before.case() {
                        away < ends[memory.case()]
                    } else {
                        away >= ends[before.case()] + margin
                    };
                    prop_assert!(is_beyond, "from {} to {} at {away}", before.case(), memory.case());
                }
                let mut last = 0.0;
                for case in 0..3 {
                    let step = (memory.shares[case] - before.shares[case]).abs();
                    prop_assert!(step <= dt / pace.fade_s + 1e-9, "a jump of {step}");
                    let [from, to] = memory.thresholds(case, weight);
                    prop_assert!(from == last && to >= from, "{from} to {to} after {last}");
                    last = to;
                }
                prop_assert_eq!(last, weight as f32);
            }
        }
    }

    #[test]
    fn a_fade_that_turns_round_goes_back_as_it_came() {
        let pace = Pace { fade_s: 1.0 };
        let mut memory = CaseMemory::settled(0, 2);
        memory.step(1, false, pace, 0.25);
        assert_eq!((memory.thresholds(0, 1.0), memory.thresholds(1, 1.0)), ([0.0, 0.75], [0.75, 1.0]));
        memory.step(1, true, pace, 0.5);
        assert_eq!((memory.thresholds(0, 0.5), memory.is_settled()), ([0.0, 0.125], false));
        memory.step(0, true, pace, 0.5);
        assert_eq!(memory.thresholds(0, 1.0), [0.0, 0.75]);
        memory.step(0, true, pace, 0.5);
        assert!(memory.is_settled() && memory.case() == 0 && memory.thresholds(1, 1.0) == [1.0, 1.0]);
        memory.step(1, false, Pace { fade_s: 0.0 }, 0.0);
        assert!(memory.is_settled() && memory.case() == 1, "at once");
    }
}
