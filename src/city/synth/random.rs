//! A small random number generator whose numbers are the same on every machine and in every version.

/// SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators", figure 17).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The generator of a place in the city: what it gives depends on nothing else.
    pub fn at(seed: u64, salt: u64, place: [i64; 2]) -> Self {
        let mut state = seed;
        for part in [salt, place[0] as u64, place[1] as u64] {
            state = Self { state: state ^ part.wrapping_mul(0xd6e8_feb8_6659_fd93) }.next();
        }
        Self { state }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number, `low..=high`.
    pub fn range(&mut self, low: i64, high: i64) -> i64 {
        debug_assert!(low <= high);
        low + (self.next() % (high - low + 1) as u64) as i64
    }

    /// A multiple of 100 mm, `low..=high` (multiples themselves).
    pub fn decimetres(&mut self, low: i64, high: i64) -> i64 {
        self.range(low / 100, high / 100) * 100
    }

    /// Whether one of `percent` in a hundred happened.
    pub fn chance(&mut self, percent: i64) -> bool {
        self.range(0, 99) < percent
    }

    /// One of these, each as likely as its weight.
    pub fn pick<T: Copy>(&mut self, choices: &[(i64, T)]) -> T {
        let mut at = self.range(0, choices.iter().map(|(weight, _)| weight).sum::<i64>() - 1);
        for (weight, choice) in choices {
            at -= weight;
            if at < 0 {
                return *choice;
            }
        }
        choices[choices.len() - 1].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_paper() {
        // Reference output of splitmix64.c (Vigna) for seed 1234567.
        let mut random = Random { state: 1_234_567 };
        assert_eq!([random.next(), random.next()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn weights_hold() {
        let mut random = Random::at(1, 2, [3, 4]);
        let heads = (0..10_000).filter(|_| random.pick(&[(3, true), (1, false), (0, false)])).count();
        assert!((7200..7800).contains(&heads), "{heads}");
    }
}
