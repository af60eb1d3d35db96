//! Borders of classes of numbers: equal intervals, quantiles, natural breaks, standard deviations; and rounding that changes no class.

/// How numbers are put into classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Classing {
    /// Classes of equal width from the smallest to the largest.
    Equal,
    /// Classes of equally many numbers; those of one value stay together.
    Quantile,
    /// Classes whose numbers lie closest together: the least sum of squared distances from the classes' means (Fisher 1958, Jenks 1977).
    Natural,
    /// Borders at whole standard deviations from the mean, or at halves: classes lie around it evenly. The deviation is that of the
    /// numbers themselves (divided by their count).
    Deviation,
}

/// Distinct numbers of which natural breaks are exact; of more, neighbours are taken together first, into so many groups at most: divided
/// at the widest gaps, half of them, and into about equally many numbers, the other half. Breaks are the best of those between groups.
pub const MOST_DISTINCT: usize = 4096;

/// The inner borders of `count` classes of some numbers, ascending: class i holds `borders[i-1] ≤ x < borders[i]`. There are fewer where
/// numbers are too few or too alike. `numbers` ascend and are finite. Borders are rounded to as few digits as leave all but a hundredth of the
/// numbers in their classes, of natural breaks all, and move them by about a twentieth of a class at most.
pub fn borders(numbers: &[f64], how: Classing, count: usize) -> Vec<f64> {
    let (Some(&low), Some(&high)) = (numbers.first(), numbers.last()) else { return Vec::new() };
    if low == high {
        return Vec::new();
    }
    let width = (high - low) / count as f64;
    let exact: Vec<f64> = match how {
        Classing::Equal => (1..count).map(|i| low + width * i as f64).collect(),
        Classing::Quantile => (1..count).map(|i| numbers[i * numbers.len() / count]).collect(),
        Classing::Natural => natural(numbers, count),
        Classing::Deviation => {
            let (mean, deviation) = moments(numbers);
            (1..count).map(|i| mean + deviation * (i as f64 - 0.5 * count as f64)).collect()
        }
    };
    let narrower = |i: usize| {
        let below = if i == 0 { low } else { exact[i - 1] };
        (exact[i] - below).min(exact.get(i + 1).copied().unwrap_or(high) - exact[i])
    };
    let slack = |i: usize| match how {
        Classing::Equal => 0.05 * width,
        Classing::Deviation => 0.05 * moments(numbers).1,
        Classing::Quantile | Classing::Natural => (0.05 * narrower(i)).max(0.25 * gap_below(numbers, exact[i])),
    };
    let movable = if how == Classing::Natural { 0 } else { numbers.len() / 100 };
    let round = |i: usize| rounded(numbers, exact[i], Slack { by: slack(i), movable });
    let mut borders: Vec<f64> = (0..exact.len()).map(round).collect();
    borders.dedup();
    borders.retain(|border| *border > low || how == Classing::Deviation);
    borders
}

/// Mean and standard deviation.
fn moments(numbers: &[f64]) -> (f64, f64) {
    let count = numbers.len() as f64;
    let mean = numbers.iter().map(|n| n / count).sum::<f64>();
    (mean, numbers.iter().map(|n| (n - mean).powi(2) / count).sum::<f64>().sqrt())
}

/// From the largest number below a border to the smallest that is not, 0 where one is missing.
fn gap_below(numbers: &[f64], border: f64) -> f64 {
    let at = numbers.partition_point(|n| *n < border);
    if at == 0 || at == numbers.len() { 0.0 } else { numbers[at] - numbers[at - 1] }
}

/// How far a border may be moved, and over how many numbers.
#[derive(Clone, Copy, Debug)]
struct Slack {
    by: f64,
    movable: usize,
}

/// The number of fewest digits near a border that divides the numbers nearly as it does; the border itself where there is none.
fn rounded(numbers: &[f64], border: f64, slack: Slack) -> f64 {
    let at = numbers.partition_point(|n| *n < border);
    let passed = |n: f64| numbers.partition_point(|x| *x < n).abs_diff(at);
    let divides = |n: &f64| (n - border).abs() <= slack.by && passed(*n) <= slack.movable;
    let most = border.abs().max(slack.by);
    if !(most.is_finite() && most > 0.0) {
        return border;
    }
    let first = most.log10().floor() as i32 + 1;
    let at_digit = |power: i32| {
        // Powers of ten below 1 are no f64s, their inverses are.
        let scale = 10.0_f64.powi(power.abs());
        if power >= 0 { (border / scale).round() * scale } else { (border * scale).round() / scale }
    };
    (0..17).map(|i| at_digit(first - i)).find(divides).unwrap_or(border)
}

/// Distinct numbers, or groups of neighbouring ones: how many there are, their sum and sum of squares from an origin, and their smallest and
/// largest.
#[derive(Clone, Copy, Debug)]
struct Group {
    count: f64,
    sum: f64,
    squares: f64,
    low: f64,
    high: f64,
}

/// Numbers that ascend, as groups.
fn groups(numbers: &[f64]) -> Vec<Group> {
    let origin = numbers[numbers.len() / 2];
    let mut groups: Vec<Group> = Vec::new();
    for run in numbers.chunk_by(|a, b| a == b) {
        let (count, off) = (run.len() as f64, run[0] - origin);
        groups.push(Group { count, sum: count * off, squares: count * off * off, low: run[0], high: run[0] });
    }
    if groups.len() <= MOST_DISTINCT {
        return groups;
    }
    let half = MOST_DISTINCT / 2;
    let mut widest: Vec<usize> = (1..groups.len()).collect();
    let gap = |i: &usize| groups[*i].low - groups[*i - 1].high;
    widest.select_nth_unstable_by(half - 1, |i, j| gap(j).total_cmp(&gap(i)).then(i.cmp(j)));
    widest.truncate(half - 1);
    let mut begins = vec![false; groups.len()];
    widest.into_iter().for_each(|i| begins[i] = true);
    let each = numbers.len() as f64 / half as f64;
    let mut joined: Vec<Group> = Vec::new();
    let mut before = 0.0;
    for (i, group) in groups.into_iter().enumerate() {
        let begins = begins[i] || (before / each) as usize != ((before + group.count) / each) as usize;
        match joined.last_mut().filter(|_| !begins) {
            Some(last) => {
                (last.count, last.sum) = (last.count + group.count, last.sum + group.sum);
                (last.squares, last.high) = (last.squares + group.squares, group.high);
            }
            None => joined.push(group),
        }
        before += group.count;
    }
    joined
}

/// Natural breaks, midway between the classes' ends. For each number of classes the best last border of the first so many groups is never
/// before that of fewer groups, so that it is looked for by halves: classes × groups × log groups steps.
fn natural(numbers: &[f64], count: usize) -> Vec<f64> {
    let groups = groups(numbers);
    let total = groups.len();
    let count = count.min(total);
    let mut sums = vec![[0.0; 3]];
    for group in &groups {
        let [n, sum, squares] = sums[sums.len() - 1];
        sums.push([n + group.count, sum + group.sum, squares + group.squares]);
    }
    let spread = |from: usize, to: usize| {
        let [n, sum, squares]: [f64; 3] = std::array::from_fn(|k| sums[to][k] - sums[from][k]);
        if to == from { 0.0 } else { (squares - sum * sum / n).max(0.0) }
    };
    // best[j]: the least of the first j groups in so many classes.
    let mut best: Vec<f64> = (0..=total).map(|to| spread(0, to)).collect();
    let mut lasts: Vec<Vec<u32>> = Vec::new();
    for classes in 2..=count {
        let mut next = vec![f64::INFINITY; total + 1];
        let mut last = vec![0_u32; total + 1];
        let mut open = vec![[classes, total, classes - 1, total - 1]];
        while let Some([first, end, least, most]) = open.pop() {
            if first > end {
                continue;
            }
            let middle = (first + end) / 2;
            let mut found = least;
            let costs = (least..=most.min(middle - 1)).map(|from| (from, best[from] + spread(from, middle)));
            for (from, cost) in costs {
                if cost < next[middle] {
                    (next[middle], found) = (cost, from);
                }
            }
            last[middle] = found as u32;
            if middle > first {
                open.push([first, middle - 1, least, found]);
            }
            open.push([middle + 1, end, found, most]);
        }
        best = next;
        lasts.push(last);
    }
    let mut borders = Vec::new();
    let mut to = total;
    for last in lasts.iter().rev() {
        to = last[to] as usize;
        borders.push(0.5 * groups[to - 1].high + 0.5 * groups[to].low);
    }
    borders.reverse();
    borders
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The counts of classes.
    fn counts(numbers: &[f64], borders: &[f64]) -> Vec<usize> {
        let mut counts = vec![0; borders.len() + 1];
        numbers.iter().for_each(|n| counts[borders.partition_point(|b| b <= n)] += 1);
        counts
    }

    /// The sum of squared distances from the classes' means.
    fn spread(numbers: &[f64], borders: &[f64]) -> f64 {
        let class = |i: usize| numbers.iter().copied().filter(move |n| borders.partition_point(|b| b <= n) == i);
        let of = |i: usize| {
            let (count, sum) = class(i).fold((0.0, 0.0), |(count, sum), n| (count + 1.0, sum + n));
            class(i).map(|n| (n - sum / f64::max(count, 1.0)).powi(2)).sum::<f64>()
        };
        (0..=borders.len()).map(of).sum()
    }

    /// The least spread of any division of the distinct numbers, all tried.
    fn least_spread(numbers: &[f64], count: usize) -> f64 {
        let mut distinct = numbers.to_vec();
        distinct.dedup();
        let places = distinct.len() - 1;
        let mut least = f64::INFINITY;
        for chosen in 0_u32..1 << places {
            if chosen.count_ones() as usize == count - 1 {
                let at = (0..places).filter(|i| chosen >> i & 1 == 1);
                least = least.min(spread(numbers, &at.map(|i| distinct[i + 1]).collect::<Vec<f64>>()));
            }
        }
        least
    }

    /// Numbers that look like chance, ascending.
    fn numbers(seed: u64, count: usize, step: f64) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        let mut all: Vec<f64> = (0..count).map(|_| ((next() % 1000) as f64 / step).floor() * step * 0.37).collect();
        all.sort_unstable_by(f64::total_cmp);
        all
    }

    #[test]
    fn natural_breaks_are_the_best_of_all_divisions() {
        for seed in 1..40 {
            let numbers = numbers(seed, 12 + seed as usize % 5, if seed % 3 == 0 { 90.0 } else { 1.0 });
            let mut distinct = numbers.clone();
            distinct.dedup();
            for count in 2..=5.min(distinct.len()) {
                let found = borders(&numbers, Classing::Natural, count);
                assert_eq!(found.len(), count - 1, "{numbers:?}");
                let (own, least) = (spread(&numbers, &found), least_spread(&numbers, count));
                assert!((own - least).abs() <= 1e-9 * (1.0 + least), "{numbers:?} {count}: {found:?} {own} {least}");
            }
        }
        // Clusters that anyone sees; as many classes as values; more classes than values.
        let clear = [1.0, 1.1, 1.2, 5.0, 5.1, 90.0];
        assert_eq!(counts(&clear, &borders(&clear, Classing::Natural, 3)), [3, 2, 1]);
        assert_eq!(counts(&[1.0, 2.0, 2.0, 7.0], &borders(&[1.0, 2.0, 2.0, 7.0], Classing::Natural, 9)), [1, 2, 1]);
        assert_eq!(borders(&[3.0; 5], Classing::Natural, 4), [] as [f64; 0]);
    }

    #[test]
    fn natural_breaks_of_many_numbers_are_bounded_and_nearly_the_best() {
        // Far more distinct numbers than groups; three humps whose borders are known.
        let hump = |middle: f64| (0..30_000).map(move |i| middle + (f64::from(i) / 30_000.0 - 0.5));
        let mut all: Vec<f64> = [0.0, 3.0, 9.0].into_iter().flat_map(hump).collect();
        all.sort_unstable_by(f64::total_cmp);
        assert!(groups(&all).len() <= MOST_DISTINCT);
        assert_eq!(groups(&all).iter().map(|g| g.count).sum::<f64>(), 90_000.0);
        let found = borders(&all, Classing::Natural, 3);
        assert_eq!(counts(&all, &found), [30_000; 3]);
        // Even numbers are divided evenly, to a group.
        let even: Vec<f64> = (0..50_000).map(f64::from).collect();
        let each = counts(&even, &borders(&even, Classing::Natural, 5));
        assert!(each.iter().all(|n| n.abs_diff(10_000) < 50), "{each:?}");
    }

    #[test]
    fn closed_forms() {
        let even: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!(borders(&even, Classing::Equal, 4), [25.0, 50.0, 75.0]);
        assert_eq!(borders(&even, Classing::Quantile, 4), [25.0, 50.0, 75.0]);
        // −1 and 1: mean 0, deviation 1.
        let two = [-1.0, -1.0, 1.0, 1.0];
        assert_eq!(borders(&two, Classing::Deviation, 4), [-1.0, 0.0, 1.0]);
        assert_eq!(borders(&two, Classing::Deviation, 5), [-1.5, -0.5, 0.5, 1.5]);
        let shifted = two.map(|n| 7.0 + 2.0 * n);
        assert_eq!(borders(&shifted, Classing::Deviation, 4), [5.0, 7.0, 9.0]);
        for how in [Classing::Equal, Classing::Quantile, Classing::Natural, Classing::Deviation] {
            assert_eq!(borders(&[], how, 5), [] as [f64; 0]);
            assert_eq!(borders(&[4.1; 9], how, 5), [] as [f64; 0], "{how:?}");
        }
    }

    #[test]
    fn quantiles_with_ties_keep_equal_numbers_together() {
        let ties = [1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 8.0, 9.0, 9.0];
        let found = borders(&ties, Classing::Quantile, 5);
        // Independently: the numbers at the fifths, each once, none the smallest.
        let mut expected: Vec<f64> = (1..5).map(|i| ties[2 * i]).collect();
        expected.dedup();
        assert_eq!(found.len(), expected.len());
        assert_eq!(counts(&ties, &found), counts(&ties, &expected));
        assert_eq!(counts(&ties, &found), [1, 7, 2]);
    }

    #[test]
    fn borders_are_round_and_few_numbers_change_their_class() {
        for seed in 1..60 {
            let numbers = numbers(seed, 200, if seed % 2 == 0 { 37.0 } else { 0.013 });
            let low = numbers[0];
            let width = (numbers[199] - low) / 5.0;
            let exact: Vec<f64> = (1..5).map(|i| low + width * f64::from(i)).collect();
            let round = borders(&numbers, Classing::Equal, 5);
            // Of 200 two may pass each border.
            let passed = |(a, b): (&f64, &f64)| numbers.iter().filter(|n| (*n < a) != (*n < b)).count();
            assert!(exact.iter().zip(&round).all(|pair| passed(pair) <= 2), "{exact:?} {round:?}");
            assert!(exact.iter().zip(&round).all(|(a, b)| (a - b).abs() <= 0.0501 * width), "{exact:?} {round:?}");
        }
        assert_eq!(borders(&[1.0, 2.0, 3.0, 100.0], Classing::Equal, 3), [34.0, 67.0]);
        let rounded = |numbers: &[f64], border, by| rounded(numbers, border, Slack { by, movable: 0 });
        assert_eq!(rounded(&[1900.0, 1964.0, 1965.0, 2000.0], 1965.0, 9.0), 1965.0);
        assert_eq!(rounded(&[1900.0, 1930.0, 1965.0, 2000.0], 1962.3, 9.0), 1960.0);
        assert_eq!(rounded(&[0.0, 1.0], 0.123_456, 0.01), 0.12);
        assert_eq!(rounded(&[0.0, 1.0], 0.123_456, 0.0), 0.123_456);
        assert_eq!(rounded(&[-5.0, 5.0], 0.004, 0.01), 0.0);
        assert_eq!(rounded(&[-5.0, 5.0], -1234.5, 40.0), -1200.0);
        // Amounts to the millimetre: two digits where so many numbers may pass.
        let fine: Vec<f64> = (0..2000).map(|i| 3.0007 + f64::from(i) * 0.031_3).collect();
        let round = borders(&fine, Classing::Quantile, 4);
        assert_eq!(round, [19.0, 34.0, 50.0], "{round:?}");
    }
}
