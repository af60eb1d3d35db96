//! Rectangles on whole pixels.

use glam::DVec2;

/// From corner `min` up to corner `max`, whole pixels; `max` is the first pixel that is no more of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rect {
    /// Left and top.
    pub min: [i32; 2],
    /// Right and bottom, above `min`.
    pub max: [i32; 2],
}

/// A stretch along an axis, whole pixels; `high` is the first pixel that is no more of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Where it begins.
    pub low: i32,
    /// Where it ends.
    pub high: i32,
}

impl Span {
    /// Its length, pixels.
    pub fn length(self) -> i32 {
        self.high - self.low
    }
}

/// Whole numbers from the first to the last, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// The least.
    pub first: i32,
    /// The largest.
    pub last: i32,
}

impl Interval {
    /// The part of both, if there is any.
    pub fn overlap(self, other: Self) -> Option<Self> {
        let both = Self { first: self.first.max(other.first), last: self.last.min(other.last) };
        (both.first <= both.last).then_some(both)
    }
}

impl Rect {
    /// From its upper left corner and its size, pixels.
    pub fn new(min: [i32; 2], size: [i32; 2]) -> Self {
        Self { min, max: [min[0] + size[0], min[1] + size[1]] }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [i32; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    /// Its extent along an axis (0 x, 1 y).
    pub fn span(&self, axis: usize) -> Span {
        Span { low: self.min[axis], high: self.max[axis] }
    }

    /// Its middle, pixels.
    pub fn middle(&self) -> DVec2 {
        let middle = |i: usize| f64::from(self.min[i]) * 0.5 + f64::from(self.max[i]) * 0.5;
        DVec2::new(middle(0), middle(1))
    }

    /// Whether less than `gap` pixels are between the two, in x and in y; with a gap of 0: whether they overlap.
    pub fn within(&self, other: &Self, gap: i32) -> bool {
        (0..2).all(|i| self.min[i] < other.max[i].saturating_add(gap) && other.min[i] < self.max[i].saturating_add(gap))
    }

    /// Whether `point` (pixels) is in it, or nearer to it than `clearance` both in x and in y. A point on its border is in it.
    pub fn covers(&self, point: DVec2, clearance: f64) -> bool {
        self.covers_in(0, point, clearance) && self.covers_in(1, point, clearance)
    }

    /// The same in one axis (0 x, 1 y).
    pub fn covers_in(&self, axis: usize, point: DVec2, clearance: f64) -> bool {
        covers(self.min[axis], self.max[axis], point[axis], clearance)
    }

    /// Whether all of `other` is in it.
    pub fn holds(&self, other: &Self) -> bool {
        (0..2).all(|i| self.min[i] <= other.min[i] && other.max[i] <= self.max[i])
    }

    /// Largest shift of an edge between the two, pixels.
    pub fn distance(&self, other: &Self) -> i32 {
        (0..2).map(|i| (self.min[i] - other.min[i]).abs().max((self.max[i] - other.max[i]).abs())).max().unwrap_or(0)
    }

    /// The share `t` (0..1) of the way to `other`, each edge rounded down: what is apart by whole pixels on both ends stays so between them.
    pub fn towards(&self, other: &Self, t: f64) -> Self {
        let between = |a: i32, b: i32| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).floor() as i32;
        let corner = |a: [i32; 2], b: [i32; 2]| [between(a[0], b[0]), between(a[1], b[1])];
        Self { min: corner(self.min, other.min), max: corner(self.max, other.max) }
    }
}

/// Whether an interval of pixels covers a coordinate, clearance included.
fn covers(low: i32, high: i32, at: f64, clearance: f64) -> bool {
    let (low, high) = (f64::from(low), f64::from(high));
    if clearance > 0.0 { low - clearance < at && at < high + clearance } else { low <= at && at <= high }
}

/// The first and the last pixel from which an interval of `length` pixels (1 and up) covers a coordinate: asked of the same predicate as all else.
pub fn closed_by(at: f64, clearance: f64, length: i32) -> Interval {
    // Truncation is at most one off, and this is cheaper than rounding.
    let near = if at < f64::from(at as i32) { at as i32 - 1 } else { at as i32 };
    let (mut first, mut last) = ((at - clearance) as i32 - length - 1, (at + clearance) as i32 + 1);
    while first < near && !covers(first, first + length, at, clearance) {
        first += 1;
    }
    while last > near && !covers(last, last + length, at, clearance) {
        last -= 1;
    }
    Interval { first, last }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_knows_its_neighbours() {
        let a = Rect::new([10, 20], [30, 40]);
        assert_eq!((a.max, a.size(), a.middle()), ([40, 60], [30, 40], DVec2::new(25.0, 40.0)));
        let beside = Rect::new([45, 20], [5, 5]);
        assert!(!a.within(&beside, 5) && a.within(&beside, 6) && beside.within(&a, 6));
        assert!(!a.within(&Rect::new([40, 20], [5, 5]), 0) && a.within(&Rect::new([39, 20], [5, 5]), 0));
        assert!(a.holds(&a) && !a.holds(&beside));
    }

    #[test]
    fn a_point_is_covered_up_to_the_clearance() {
        let a = Rect::new([10, 20], [30, 40]);
        assert!(a.covers(DVec2::new(40.0, 60.0), 0.0) && !a.covers(DVec2::new(40.1, 60.0), 0.0));
        assert!(a.covers(DVec2::new(45.9, 30.0), 6.0) && !a.covers(DVec2::new(46.0, 30.0), 6.0));
    }

    #[test]
    fn half_of_the_way_keeps_what_is_between() {
        let (a, b) = (Rect::new([0, 0], [10, 10]), Rect::new([17, 3], [20, 5]));
        assert_eq!((a.towards(&b, 0.0), a.towards(&b, 1.0)), (a, b));
        assert_eq!(a.towards(&b, 0.5), Rect { min: [8, 1], max: [23, 9] });
        assert_eq!(a.distance(&b), 27);
    }
}
