//! Numbers that look random and come again (splitmix64).

/// A generator; the same seed gives the same numbers.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator of mutation `number` of a run.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut start = Self(seed ^ number.wrapping_mul(0xd6e8_feb8_6659_fd93));
        start.next();
        start
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 to `end` − 1; 0 where `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// One of a list that is not empty.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }

    /// Once in `n`.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// A number, to a hundredth.
    #[allow(dead_code, reason = "not all binaries have use for it")]
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        let steps = ((high - low) * 100.0) as usize + 1;
        ((low * 100.0).round() + self.below(steps) as f64) / 100.0
    }

    /// A range of at most `longest` inside 0..`length`.
    #[allow(dead_code, reason = "not all binaries have use for it")]
    pub fn range(&mut self, length: usize, longest: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        let end = (start + self.below(longest.max(1)) + 1).min(length);
        start..end.max(start)
    }
}
