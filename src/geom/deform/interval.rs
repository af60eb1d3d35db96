//! Interval arithmetic with outward rounding: what holds for an interval holds for every number in it.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DMat3, DVec3};

use crate::geom::deform::number::{Matrix, Number, Vector};

/// How far sums of a few numbers about 1, and the platform's sine and cosine, may be off: a few ulps.
const UNIT_ERROR: f64 = 1e-15;
/// How far a short polynomial may be off, relative: a rounding for each of its few operations.
const FORMULA_ERROR: f64 = 8.0 * f64::EPSILON;

/// All numbers from `low` to `high`, both among them and maybe infinite. Where nothing is known (∞ − ∞) it is everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Smallest number.
    pub low: f64,
    /// Largest number, ≥ `low`.
    pub high: f64,
}

impl Interval {
    /// Every number.
    pub const EVERYTHING: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// From `low` to `high`; everything where one of them is no number.
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high { Self { low, high } } else { Self::EVERYTHING }
    }

    /// `high − low`.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// The number in the middle; meaningless for infinite ends.
    pub fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Whether `number` is in it.
    pub fn contains(self, number: f64) -> bool {
        self.low <= number && number <= self.high
    }

    /// The smallest interval around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What both hold; where that is nothing (of two that hold the same unknown number), this one.
    #[must_use]
    pub fn narrowed(self, low: f64, high: f64) -> Self {
        let narrow = Self { low: self.low.max(low), high: self.high.min(high) };
        if narrow.low <= narrow.high { narrow } else { self }
    }

    /// The smallest interval with both numbers and a step more on both sides, for what rounding lost; everything if there is a NaN.
    fn outward(low: f64, high: f64) -> Self {
        Self::new(low.next_down(), high.next_up())
    }

    /// Bounds of a function without turning points in it.
    fn monotone(self, f: impl Fn(f64) -> f64) -> Self {
        let (a, b) = (f(self.low), f(self.high));
        let (low, high) = (a.min(b), a.max(b));
        Self::outward(low - FORMULA_ERROR * low.abs(), high + FORMULA_ERROR * high.abs())
    }

    /// cos, of which the turning points are the multiples of π.
    fn cosine(self) -> Self {
        const TURN: f64 = std::f64::consts::TAU;
        if self.width().is_nan() || self.width() >= TURN || self.low.abs() > 1e6 {
            return Self { low: -1.0, high: 1.0 };
        }
        let (a, b) = (self.low.cos(), self.high.cos());
        // Whether a place `phase` of the turn, with room for rounding, is in the interval.
        let passes = |phase: f64| {
            let room = 1e-9;
            let next = ((self.low - room - phase) / TURN).ceil() * TURN + phase;
            next <= self.high + room
        };
        let low = if passes(std::f64::consts::PI) { -1.0 } else { a.min(b) - UNIT_ERROR };
        let high = if passes(0.0) { 1.0 } else { a.max(b) + UNIT_ERROR };
        Self { low: low.max(-1.0), high: high.min(1.0) }
    }
}

impl From<f64> for Interval {
    fn from(number: f64) -> Self {
        Self { low: number, high: number }
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        // 0 · ∞ is 0 here: an infinite end stands for numbers without a bound, each of them finite.
        let times = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let ends = [
            times(self.low, other.low),
            times(self.low, other.high),
            times(self.high, other.low),
            times(self.high, other.high),
        ];
        let (low, high) = ends.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &e| (l.min(e), h.max(e)));
        // Zeros of factors that are zero are exact: what is level stays so.
        if low == 0.0 && high == 0.0 { Self { low, high } } else { Self::outward(low, high) }
    }
}

impl Number for Interval {
    fn sin_cos(self) -> (Self, Self) {
        if self == Self::from(0.0) {
            return (Self::from(0.0), Self::from(1.0));
        }
        let quarter = std::f64::consts::FRAC_PI_2;
        ((self - Self::from(quarter)).cosine(), self.cosine())
    }

    fn sinc(self) -> Self {
        // |sinc'| ≤ 0.4362: so far from the middle it changes at most.
        let (middle, half) = (self.middle(), 0.5 * self.width());
        if !middle.is_finite() || half == 0.0 && middle == 0.0 {
            return if half == 0.0 { Self::from(1.0) } else { Self { low: -0.2173, high: 1.0 } };
        }
        let (value, reach) = (middle.sinc(), 0.4363 * half + UNIT_ERROR);
        Self { low: (value - reach).max(-0.2173), high: (value + reach).min(1.0) }
    }

    fn root(self) -> Self {
        let ends = Self::outward(self.low.root(), self.high.root());
        Self { low: ends.low.max(0.0), high: ends.high.max(0.0) }
    }

    fn square(self) -> Self {
        let (a, b) = (self.low * self.low, self.high * self.high);
        let low = if self.contains(0.0) { 0.0 } else { a.min(b).next_down().max(0.0) };
        Self::new(low, a.max(b).next_up())
    }

    fn inverse(self) -> Self {
        if self.contains(0.0) { Self::EVERYTHING } else { self.monotone(f64::recip) }
    }

    fn clamp(self, low: f64, high: f64) -> Self {
        Self { low: Number::clamp(self.low, low, high), high: Number::clamp(self.high, low, high) }
    }

    fn clamp_slope(self, low: f64, high: f64) -> Self {
        let is_inside = low <= self.low && self.high <= high;
        let is_outside = self.high < low || high < self.low;
        Self { low: f64::from(u8::from(is_inside)), high: f64::from(u8::from(!is_outside)) }
    }

    fn smaller(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    fn larger(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }

    fn ends(self) -> [f64; 2] {
        [self.low, self.high]
    }

    fn integral(low: Self, high: Self, h: Self, primitive: impl Fn(f64, f64) -> f64) -> Self {
        // It rises with the width of the range and with h.
        let over = |low: f64, high: f64, h: f64| {
            let [low, high] = [low, high].map(|t| Number::clamp(t, -h, h));
            if low < high { primitive(high, h) - primitive(low, h) } else { 0.0 }
        };
        let least = over(low.high, high.low, h.low) - UNIT_ERROR;
        Self::new(least.max(0.0), over(low.low, high.high, h.high) + UNIT_ERROR)
    }

    fn up_to(self, bound: f64, then: impl FnOnce(Self) -> Self, otherwise: impl FnOnce(Self) -> Self) -> Self {
        if self.high <= bound {
            then(self)
        } else if self.low > bound {
            otherwise(self)
        } else {
            then(Self { low: self.low, high: bound }).union(otherwise(Self { low: bound, high: self.high }))
        }
    }

    fn of_map(
        _jet: impl Fn(DVec3) -> (DVec3, DMat3),
        most: f64,
        _place: &Vector<Self>,
    ) -> (Vector<Self>, Matrix<Self>) {
        // Nothing is known of how it changes.
        ([Self::new(-most, most); 3], [[Self::EVERYTHING; 3]; 3])
    }

    fn smooth(self) -> Self {
        self.monotone(|q| q * q * (3.0 - 2.0 * q)).narrowed(0.0, 1.0)
    }
}
