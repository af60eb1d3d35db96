//! Times that are compared are taken in turn, in one process; what is said of them is a median and its 95 % interval.
//!
//! The interval comes from order statistics: with n values, the number of them below the true median is binomial with
//! p = ½, whatever the distribution of times is. No normal distribution is assumed and no random number drawn.

use serde::Serialize;

/// A median with an interval that holds the true one in 95 of 100 runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The middle value; the mean of the middle two of an even number.
    pub median: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// The estimate from these values, in any order. Fewer than six have no 95 % interval: then it is the least to the greatest.
    /// `None` of no values, or where one is not finite.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() || values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let rank = lower_rank(n).max(1);
        Some(Self {
            median: 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
            low: sorted[rank - 1],
            high: sorted[n - rank],
        })
    }
}

/// The largest k such that the k-th smallest to the k-th greatest of n values hold the median with 95 %; 0: none do.
fn lower_rank(n: usize) -> usize {
    // P(fewer than k values lie below the median) = Σ_{i<k} C(n,i)/2ⁿ, at most 2.5 % on either side. In logarithms,
    // because 2⁻ⁿ is no double from n = 1075 on.
    let mut ln_probability = -(n as f64) * std::f64::consts::LN_2;
    let mut below = 0.0;
    for k in 0..n {
        below += ln_probability.exp();
        if below > 0.025 {
            return k;
        }
        ln_probability += ((n - k) as f64 / (k + 1) as f64).ln();
    }
    0
}

/// Times `count` things in turn, `rounds` times over: one list per thing, in the order of the rounds.
///
/// Every other round goes the other way, so that none always runs on what the same neighbour left in the caches.
///
/// # Errors
/// The first of `timed`, which is given the number of the thing.
pub fn in_turn<E>(
    count: usize,
    rounds: usize,
    mut timed: impl FnMut(usize) -> Result<f64, E>,
) -> Result<Vec<Vec<f64>>, E> {
    let mut times = vec![Vec::with_capacity(rounds.min(4096)); count];
    for round in 0..rounds {
        for step in 0..count {
            let i = if round % 2 == 0 { step } else { count - 1 - step };
            times[i].push(timed(i)?);
        }
    }
    Ok(times)
}

/// `a / b`, round by round: what a machine does slowly in one round, it does slowly to both.
pub fn ratios(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_printed_tables() {
        // Conover, Practical Nonparametric Statistics: 95 % limits of the median by the sign test.
        for (n, rank) in [(5, 0), (6, 1), (8, 1), (9, 2), (12, 3), (15, 4), (20, 6), (25, 8), (30, 10), (50, 18)] {
            assert_eq!(lower_rank(n), rank, "n = {n}");
        }
        // Far beyond what 2⁻ⁿ allows: n/2 − 0.98 √n.
        assert!((lower_rank(10_000) as f64 - (5000.0 - 98.0)).abs() <= 1.0);
    }

    #[test]
    fn the_median_of_numbers_in_a_row() {
        let mut values: Vec<f64> = (1..=20).map(f64::from).collect();
        values.reverse();
        assert_eq!(Estimate::of(&values), Some(Estimate { median: 10.5, low: 6.0, high: 15.0 }));
        assert_eq!(Estimate::of(&[3.0, 1.0, 2.0]), Some(Estimate { median: 2.0, low: 1.0, high: 3.0 }));
        assert_eq!(Estimate::of(&[7.0]), Some(Estimate { median: 7.0, low: 7.0, high: 7.0 }));
        assert_eq!(Estimate::of(&[]), None);
        assert_eq!(Estimate::of(&[1.0, f64::NAN]), None);
    }

    #[test]
    fn one_outlier_moves_nothing_much() {
        let mut values = vec![1.0; 20];
        values.push(1e9);
        assert_eq!(Estimate::of(&values), Some(Estimate { median: 1.0, low: 1.0, high: 1.0 }));
    }

    #[test]
    fn a_machine_that_slows_down_leaves_ratios_alone() {
        // B takes three times as long as A, and every round is twice as slow as the one before.
        let mut slowness = 1.0;
        let mut order = Vec::new();
        let times = in_turn(2, 4, |i| {
            if order.len() % 2 == 0 && !order.is_empty() {
                slowness *= 2.0;
            }
            order.push(i);
            Ok::<_, ()>(slowness * [1.0, 3.0][i])
        });
        let times = times.unwrap();
        assert_eq!(order, [0, 1, 1, 0, 0, 1, 1, 0]);
        assert_eq!(times[0], [1.0, 2.0, 4.0, 8.0]);
        assert_eq!(ratios(&times[1], &times[0]), [3.0; 4]);
    }

    #[test]
    fn the_first_failure_ends_it() {
        let mut calls = 0;
        let failed = in_turn(3, 5, |i| {
            calls += 1;
            if i == 1 { Err("no") } else { Ok(1.0) }
        });
        assert_eq!((failed, calls), (Err("no"), 2));
    }
}
