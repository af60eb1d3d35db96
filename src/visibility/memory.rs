//! Classes over time: what is an occluder stays one until it has left its test by a margin, and comes and goes gradually.

use crate::visibility::{detect::Detected, set::Set};

/// The pace at which things come and go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Seconds from not at all to wholly, and back, ≥ 0; 0: at once. 0.3 is quick and does not pop.
    pub fade_s: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { fade_s: 0.3 }
    }
}

/// Which units are occluders, and how far they have come to be drawn as such.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    is_occluder: Vec<bool>,
    weights: Vec<f64>,
}

impl Memory {
    /// The memory without a history: everything is as it is detected, and fades are over.
    pub fn settled(now: &Detected) -> Self {
        let units = now.occluders.universe() as u32;
        let is_occluder: Vec<bool> = (0..units).map(|unit| now.occluders.has(unit)).collect();
        let weights = is_occluder.iter().map(|&is| f64::from(u8::from(is))).collect();
        Self { is_occluder, weights }
    }

    /// Goes on by `dt` seconds, ≥ 0; returns the weights. Units of another city than before begin settled.
    pub fn step(&mut self, now: &Detected, pace: Pace, dt: f64) -> &[f64] {
        if now.occluders.universe() != self.weights.len() {
            *self = Self::settled(now);
            return &self.weights;
        }
        let by = if pace.fade_s > 0.0 { (dt / pace.fade_s).max(0.0) } else { 1.0 };
        let each = self.is_occluder.iter_mut().zip(&mut self.weights).enumerate();
        for (unit, (is_occluder, weight)) in each {
            let unit = unit as u32;
            *is_occluder = now.occluders.has(unit) || (*is_occluder && now.kept.has(unit));
            let step = if *is_occluder { by } else { -by };
            *weight = (*weight + step).clamp(0.0, 1.0);
        }
        &self.weights
    }

    /// Per unit, how far it is drawn as an occluder: 0 not at all, 1 wholly.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The units that are drawn as occluders, be it in part.
    pub fn shown(&self) -> Set {
        Set::of(&self.weights.iter().map(|weight| *weight > 0.0).collect::<Vec<_>>())
    }

    /// Whether a unit is an occluder.
    pub fn is_occluder(&self, unit: u32) -> bool {
        self.is_occluder.get(unit as usize) == Some(&true)
    }

    /// Whether all fades are over.
    pub fn is_settled(&self) -> bool {
        self.is_occluder.iter().zip(&self.weights).all(|(&is, &weight)| weight == f64::from(u8::from(is)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Units that are occluders where their signal is at least 1, and stay so while it is at least 0.
    fn detected(signals: &[f64]) -> Detected {
        let above = |least: f64| Set::of(&signals.iter().map(|s| *s >= least).collect::<Vec<_>>());
        Detected { occluders: above(1.0), kept: above(0.0), list: vec![] }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Between two changes of class the whole margin is crossed, and weights follow without a jump.
        #[test]
        fn a_class_changes_once_per_crossing_of_its_boundary(
            start in -2.0..3.0f64,
            steps in prop::collection::vec((-0.7..0.7f64, 0.0..0.2f64), 1..200),
        ) {
            let pace = Pace { fade_s: 0.3 };
            let mut signal = start;
            let mut memory = Memory::settled(&detected(&[signal]));
            let (mut was, mut weight) = (memory.is_occluder(0), memory.weights()[0]);
            for (move_by, dt) in steps {
                signal += move_by;
                let now = memory.step(&detected(&[signal]), pace, dt)[0];
                prop_assert!((now - weight).abs() <= dt / pace.fade_s + 1e-12, "a jump from {weight} to {now}");
                prop_assert!((0.0..=1.0).contains(&now));
                weight = now;
                let is = memory.is_occluder(0);
                prop_assert!(is || signal < 1.0);
                prop_assert!(!is || signal >= 0.0);
                if is != was {
                    // It has been on the far side of the margin since the last change.
                    let is_beyond = if is { signal >= 1.0 } else { signal < 0.0 };
                    prop_assert!(is_beyond, "a change at {signal}");
                    was = is;
                }
            }
        }

        /// Jitter within the margin changes a class at most once.
        #[test]
        fn jitter_within_the_margin_does_not_flicker(start in any::<bool>(), jitter in prop::collection::vec(0.05..1.5f64, 1..100)) {
            let mut memory = Memory::settled(&detected(&[if start { 1.0 } else { 0.5 }]));
            let mut changes = 0;
            let mut was = memory.is_occluder(0);
            for signal in jitter {
                memory.step(&detected(&[signal]), Pace::default(), 0.04);
                changes += u32::from(memory.is_occluder(0) != was);
                was = memory.is_occluder(0);
            }
            prop_assert!(changes <= 1, "{changes} changes");
        }
    }

    #[test]
    fn fades_end_and_a_fade_of_no_time_is_over_at_once() {
        let pace = Pace { fade_s: 0.5 };
        let mut memory = Memory::settled(&detected(&[0.0, 2.0]));
        assert!(memory.is_settled() && memory.weights() == [0.0, 1.0]);
        memory.step(&detected(&[2.0, -1.0]), pace, 0.25);
        assert!(!memory.is_settled() && memory.weights() == [0.5, 0.5]);
        memory.step(&detected(&[2.0, -1.0]), pace, 0.25);
        assert!(memory.is_settled() && memory.weights() == [1.0, 0.0]);
        let pace = Pace { fade_s: 0.0 };
        let mut at_once = Memory::settled(&detected(&[0.0]));
        assert_eq!(at_once.step(&detected(&[2.0]), pace, 0.0), [1.0]);
        assert_eq!(at_once.step(&detected(&[2.0, 0.0]), pace, 0.0), [1.0, 0.0], "another city");
    }
}
