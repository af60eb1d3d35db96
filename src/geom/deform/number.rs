//! Numbers that formulas of deformations are written in once: f64 for values, intervals for proofs.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DMat3, DVec3};

/// What a formula needs of a number. The f64 gives one value; an [`Interval`](super::Interval) holds the values for all numbers in its arguments.
/// At kinks an f64 takes the derivative of the inner side.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + From<f64>
{
    /// Sine and cosine of radians.
    fn sin_cos(self) -> (Self, Self);
    /// sin x / x; 1 at 0.
    fn sinc(self) -> Self;
    /// Square root; of what is below 0, 0.
    fn root(self) -> Self;
    /// The square, never below 0.
    fn square(self) -> Self;
    /// 1/x.
    fn inverse(self) -> Self;
    /// The nearest number in `low..=high`.
    fn clamp(self, low: f64, high: f64) -> Self;
    /// Derivative of [`Number::clamp`]: 1 inside (closed), 0 outside.
    fn clamp_slope(self, low: f64, high: f64) -> Self;
    /// The smaller one.
    fn smaller(self, other: Self) -> Self;
    /// The larger one.
    fn larger(self, other: Self) -> Self;
    /// Its smallest and largest value.
    fn ends(self) -> [f64; 2];
    /// Of a function of τ and h that is ≥ 0 where |τ| ≤ h and rises with h, the integral from `low` to `high`, both of which are
    /// within ±h; `primitive` is its antiderivative, of numbers about 1.
    fn integral(low: Self, high: Self, h: Self, primitive: impl Fn(f64, f64) -> f64) -> Self;
    /// `then` where this is at most `bound`, else `otherwise`; an interval across the bound holds both.
    fn up_to(self, bound: f64, then: impl FnOnce(Self) -> Self, otherwise: impl FnOnce(Self) -> Self) -> Self;

    /// A map that is known at places alone, and its derivative (columns: by x, y, z); `most`: how far anything goes along an axis.
    fn of_map(jet: impl Fn(DVec3) -> (DVec3, DMat3), most: f64, place: &Vector<Self>) -> (Vector<Self>, Matrix<Self>);

    /// 3q² − 2q³ of a number in 0..=1: from 0 to 1, level at both ends.
    fn smooth(self) -> Self {
        self.square() * (Self::from(3.0) - Self::from(2.0) * self)
    }

    /// Derivative of [`Number::smooth`], 6q(1 − q), written so that an interval stays narrow.
    fn smooth_slope(self) -> Self {
        Self::from(1.5) - Self::from(6.0) * (self - Self::from(0.5)).square()
    }

    /// Product with a plain number.
    fn times(self, factor: f64) -> Self {
        self * Self::from(factor)
    }

    /// Sum with a plain number.
    fn plus(self, term: f64) -> Self {
        self + Self::from(term)
    }
}

impl Number for f64 {
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }

    fn sinc(self) -> Self {
        // The next term of the series is below 2⁻⁵³ there.
        if self.abs() < 1e-3 { 1.0 - self * self / 6.0 + self.powi(4) / 120.0 } else { self.sin() / self }
    }

    fn root(self) -> Self {
        self.max(0.0).sqrt()
    }

    fn square(self) -> Self {
        self * self
    }

    fn inverse(self) -> Self {
        self.recip()
    }

    fn clamp(self, low: f64, high: f64) -> Self {
        self.max(low).min(high)
    }

    fn clamp_slope(self, low: f64, high: f64) -> Self {
        if (low..=high).contains(&self) { 1.0 } else { 0.0 }
    }

    fn smaller(self, other: Self) -> Self {
        self.min(other)
    }

    fn larger(self, other: Self) -> Self {
        self.max(other)
    }

    fn ends(self) -> [f64; 2] {
        [self, self]
    }

    fn integral(low: Self, high: Self, h: Self, primitive: impl Fn(f64, f64) -> f64) -> Self {
        primitive(high, h) - primitive(low, h)
    }

    fn up_to(self, bound: f64, then: impl FnOnce(Self) -> Self, otherwise: impl FnOnce(Self) -> Self) -> Self {
        if self <= bound { then(self) } else { otherwise(self) }
    }

    fn of_map(jet: impl Fn(DVec3) -> (DVec3, DMat3), _most: f64, place: &Vector<Self>) -> (Vector<Self>, Matrix<Self>) {
        let (way, slope) = jet(DVec3::from(*place));
        (way.to_array(), slope.transpose().to_cols_array_2d())
    }
}

/// Three numbers: a place or a way in the lens frame.
pub(super) type Vector<S> = [S; 3];
/// Rows of a 3×3 matrix.
pub(super) type Matrix<S> = [[S; 3]; 3];

/// The matrix of nothing but zeros.
pub(super) fn zeros<S: Number>() -> Matrix<S> {
    [[S::from(0.0); 3]; 3]
}

/// I + m.
pub(super) fn plus_identity<S: Number>(mut m: Matrix<S>) -> Matrix<S> {
    for (i, row) in m.iter_mut().enumerate() {
        row[i] = row[i].plus(1.0);
    }
    m
}

/// a·b.
pub(super) fn product<S: Number>(a: &Matrix<S>, b: &Matrix<S>) -> Matrix<S> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

/// a + b.
pub(super) fn sum<S: Number>(a: &Matrix<S>, b: &Matrix<S>) -> Matrix<S> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// Determinant, along the first row.
pub(super) fn determinant<S: Number>(m: &Matrix<S>) -> S {
    let minor = |j: usize, k: usize| m[1][j] * m[2][k] - m[1][k] * m[2][j];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}
