//! Values of WGSL on the host.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::DVec3;

/// A number, and its derivatives by the three coordinates of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its gradient.
    pub slope: DVec3,
}

/// A scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// `f32`.
    Real(Dual),
    /// `i32`.
    Int(i32),
    /// `u32`.
    Uint(u32),
    /// `bool`.
    Bool(bool),
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A scalar.
    Scalar(Scalar),
    /// A vector: how many of these count.
    Vector(usize, [Scalar; 4]),
    /// A matrix (its columns), a struct or an array.
    Many(Vec<Value>),
}

impl Dual {
    /// A number that does not depend on the place.
    pub fn constant(value: f64) -> Self {
        Self { value, slope: DVec3::ZERO }
    }

    /// A coordinate of the place.
    pub fn coordinate(value: f64, axis: usize) -> Self {
        Self { value, slope: DVec3::AXES[axis] }
    }

    /// A function of it, by the function's value and derivative.
    pub fn mapped(self, value: f64, rate: f64) -> Self {
        // 0 times an endless rate is 0: what does not change changes nothing.
        let slope = if self.slope == DVec3::ZERO { DVec3::ZERO } else { self.slope * rate };
        Self { value, slope }
    }

    /// The square root.
    pub fn root(self) -> Self {
        let root = self.value.sqrt();
        self.mapped(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + other.slope * self.value }
    }
}

impl Div for Dual {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - other.slope * value) / other.value }
    }
}

impl Value {
    /// A vector of numbers.
    pub fn vector<const N: usize>(numbers: [Dual; N]) -> Self {
        Self::lanes(numbers.into_iter().map(Scalar::Real))
    }

    /// A vector of scalars, four of them at most.
    pub(super) fn lanes(scalars: impl IntoIterator<Item = Scalar>) -> Self {
        let mut all = [Scalar::Bool(false); 4];
        let mut count = 0;
        for (lane, scalar) in all.iter_mut().zip(scalars) {
            *lane = scalar;
            count += 1;
        }
        Self::Vector(count, all)
    }

    /// Its scalars: one, or those of a vector.
    pub(super) fn scalars(&self) -> &[Scalar] {
        match self {
            Self::Scalar(scalar) => std::slice::from_ref(scalar),
            Self::Vector(count, all) => &all[..*count],
            Self::Many(_) => &[],
        }
    }

    /// Its numbers, if it is a vector of so many.
    pub fn reals<const N: usize>(&self) -> Option<[Dual; N]> {
        let scalars = self.scalars();
        if scalars.len() != N {
            return None;
        }
        let mut out = [Dual::constant(0.0); N];
        for (to, scalar) in out.iter_mut().zip(scalars) {
            *to = scalar.real()?;
        }
        Some(out)
    }

    /// An element: of a vector, a matrix, a struct or an array; beyond the last one, that.
    pub(super) fn element(&self, index: usize) -> Option<Self> {
        match self {
            Self::Scalar(_) => None,
            Self::Vector(count, all) => Some(Self::Scalar(all[index.min(count.checked_sub(1)?)])),
            Self::Many(all) => all.get(index).or_else(|| all.last()).cloned(),
        }
    }

    /// Puts a value at a path of elements.
    pub(super) fn put(&mut self, path: &[usize], value: Self) -> Option<()> {
        let Some((&index, rest)) = path.split_first() else {
            *self = value;
            return Some(());
        };
        match self {
            Self::Scalar(_) => None,
            Self::Vector(count, all) => {
                let Self::Scalar(scalar) = value else { return None };
                all[index.min(count.checked_sub(1)?)] = scalar;
                Some(())
            }
            Self::Many(all) => {
                let last = all.len().checked_sub(1)?;
                all[index.min(last)].put(rest, value)
            }
        }
    }

    /// Yes or no, if it is a `bool`.
    pub(super) fn truth(&self) -> Option<bool> {
        match self {
            Self::Scalar(Scalar::Bool(is)) => Some(*is),
            _ => None,
        }
    }

    /// A whole number.
    pub(super) fn whole(&self) -> Option<i64> {
        match self {
            Self::Scalar(Scalar::Int(n)) => Some(i64::from(*n)),
            Self::Scalar(Scalar::Uint(n)) => Some(i64::from(*n)),
            _ => None,
        }
    }
}

impl Scalar {
    /// Its number, if it is an `f32`.
    pub(super) fn real(self) -> Option<Dual> {
        match self {
            Self::Real(dual) => Some(dual),
            _ => None,
        }
    }
}
