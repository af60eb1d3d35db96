//! Sets of units, a bit each.

/// A set of the numbers 0..n.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Set {
    words: Vec<u64>,
    len: usize,
}

impl Set {
    /// None of `len` numbers.
    pub fn new(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    /// Those of some flags that are set.
    pub fn of(flags: &[bool]) -> Self {
        let mut set = Self::new(flags.len());
        flags.iter().enumerate().filter(|(_, flag)| **flag).for_each(|(i, _)| set.insert(i as u32));
        set
    }

    /// The number of numbers that there are, in it or not.
    pub fn universe(&self) -> usize {
        self.len
    }

    /// Adds a number.
    pub fn insert(&mut self, i: u32) {
        self.words[i as usize / 64] |= 1 << (i % 64);
    }

    /// Whether it has a number.
    pub fn has(&self, i: u32) -> bool {
        self.words.get(i as usize / 64).is_some_and(|word| word >> (i % 64) & 1 == 1)
    }

    /// The number of its members.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Those it has, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.words.iter().enumerate().flat_map(|(at, &word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros();
                left &= left.wrapping_sub(1);
                (bit < 64).then_some(at as u32 * 64 + bit)
            })
        })
    }

    /// Those that either has.
    #[must_use]
    pub fn or(self, other: &Self) -> Self {
        self.each(other, |a, b| a | b)
    }

    /// Those that both have.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        self.each(other, |a, b| a & b)
    }

    /// Those that the other does not have.
    #[must_use]
    pub fn without(self, other: &Self) -> Self {
        self.each(other, |a, b| a & !b)
    }

    /// All others.
    #[must_use]
    pub fn complement(mut self) -> Self {
        self.words.iter_mut().for_each(|word| *word = !*word);
        if let (Some(last), 1..) = (self.words.last_mut(), self.len % 64) {
            *last &= (1 << (self.len % 64)) - 1;
        }
        self
    }

    fn each(mut self, other: &Self, join: impl Fn(u64, u64) -> u64) -> Self {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a = join(*a, *b));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_what_flags_are() {
        for len in [0, 1, 63, 64, 65, 200] {
            let flags = |step: usize| (0..len).map(|i| i % step == 0).collect::<Vec<bool>>();
            let (a, b) = (flags(2), flags(3));
            let (in_a, in_b) = (Set::of(&a), Set::of(&b));
            let of = |join: &dyn Fn(bool, bool) -> bool| {
                Set::of(&a.iter().zip(&b).map(|(a, b)| join(*a, *b)).collect::<Vec<_>>())
            };
            assert_eq!(in_a.clone().or(&in_b), of(&|a, b| a || b));
            assert_eq!(in_a.clone().and(&in_b), of(&|a, b| a && b));
            assert_eq!(in_a.clone().without(&in_b), of(&|a, b| a && !b));
            assert_eq!(in_a.clone().complement(), of(&|a, _| !a));
            assert_eq!(in_a.iter().collect::<Vec<_>>(), (0..len as u32).step_by(2).collect::<Vec<_>>());
            assert_eq!((in_a.count(), in_a.universe()), (len.div_ceil(2), len));
            assert!((0..len as u32).all(|i| in_b.has(i) == b[i as usize]) && !in_b.has(len as u32 + 64));
        }
    }
}
