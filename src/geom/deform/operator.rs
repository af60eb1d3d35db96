//! Operators of deformations (after Barr 1984, *Global and local deformations of solid primitives*), free to chain.
//!
//! All of them act in the frame of the lens: x along A, y along B, z along N. Each is written as a displacement g(p) − p, so that an
//! operator that does nothing adds exact zeros.

use glam::{DVec2, DVec3};

use crate::geom::{
    aabb::Aabb,
    deform::{
        Mapped, Opening,
        number::{Matrix, Number, Vector, determinant, plus_identity, zeros},
    },
};

/// What moves points, in metres and radians of the lens frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Operator {
    /// g(p) = p + v. det 1.
    Translate(DVec3),
    /// g(p) = about + factors ∘ (p − about). det: the product of the factors, which is > 0.
    Scale {
        /// > 0 each.
        factors: DVec3,
        /// What stays.
        about: DVec3,
    },
    /// Horizontal shearing: g(p) = p + (z − base)·(slope, 0). det 1.
    Shear {
        /// Metres aside for each metre of height.
        slope: DVec2,
        /// The height that stays.
        base: f64,
    },
    /// g(p) = (r x, r y, z), r(z) linear from `factors[0]` at `z[0]` to `factors[1]` at `z[1]`, the same beyond. det r².
    Taper {
        /// From where to where, ascending.
        z: [f64; 2],
        /// > 0 each.
        factors: [f64; 2],
    },
    /// g(p) = (x cos φ − y sin φ, x sin φ + y cos φ, z), φ(z) linear from `angles[0]` at `z[0]` to `angles[1]` at `z[1]`, the same
    /// beyond. det 1.
    Twist {
        /// From where to where, ascending.
        z: [f64; 2],
        /// Counterclockwise seen against N.
        angles: [f64; 2],
    },
    /// Along y: ŷ = clamp(y, `y[0]`, `y[1]`), u = ŷ − about, φ = ku, ζ = z − base: g(p) = (x, about + u·sinc φ − ζ sin φ +
    /// (y − ŷ) cos φ, base + ζ cos φ + (uφ/2) sinc²(φ/2) + (y − ŷ) sin φ). det 1 − kζ between the ends, 1 beyond: kζ < 1 is
    /// asked for. Towards +z for k > 0. One whole turn (φ = 2π from end to end) is the most that does not meet itself.
    Bend {
        /// k, 1/metres.
        curvature: f64,
        /// Between which y it is bent, ascending; beyond it goes on straight.
        y: [f64; 2],
        /// The y that stays as it is.
        about: f64,
        /// The z at which lengths stay.
        base: f64,
    },
    /// A street opened along a route.
    Open(Opening),
    /// What a user's handler does; det as its derivative has it.
    Map(Mapped),
}

impl Operator {
    /// Heights above or below `base` (a z of the lens frame) times `factor` > 0.
    pub fn heights(factor: f64, base: f64) -> Self {
        Self::Scale { factors: DVec3::new(1.0, 1.0, factor), about: DVec3::new(0.0, 0.0, base) }
    }

    /// A 3D call-out: what is around `about` is shown `factor` > 0 times as large, moved by `offset`.
    pub fn call_out(about: DVec3, factor: f64, offset: DVec3) -> Vec<Self> {
        vec![Self::Scale { factors: DVec3::splat(factor), about }, Self::Translate(offset)]
    }

    /// A panoramic bend, for a frame at the eye with y forward and z up ([`super::Frame::upright`]): what is nearer than `near`
    /// metres stays, what is farther than `far` is raised by `angle` radians around a level line, and a round hollow joins them. The
    /// ground, `depth` metres below the eye, keeps its lengths.
    pub fn panorama(near: f64, far: f64, angle: f64, depth: f64) -> Self {
        Self::Bend { curvature: angle / (far - near), y: [near, far], about: near, base: -depth }
    }

    /// The same with a part of its strength: 0 is the identity to the bit, 1 itself. What parameters change goes linearly: ways,
    /// angles and curvature from 0, factors from 1.
    #[must_use]
    pub fn at_strength(&self, strength: f64) -> Self {
        if strength == 1.0 {
            return self.clone();
        }
        let factor = |f: f64| 1.0 + strength * (f - 1.0);
        match self {
            Self::Translate(way) => Self::Translate(strength * *way),
            Self::Scale { factors, about } => {
                Self::Scale { factors: DVec3::from(factors.to_array().map(factor)), about: *about }
            }
            Self::Shear { slope, base } => Self::Shear { slope: strength * *slope, base: *base },
            Self::Taper { z, factors } => Self::Taper { z: *z, factors: factors.map(factor) },
            Self::Twist { z, angles } => Self::Twist { z: *z, angles: angles.map(|a| strength * a) },
            Self::Bend { curvature, y, about, base } => {
                Self::Bend { curvature: strength * curvature, y: *y, about: *about, base: *base }
            }
            Self::Open(opening) => {
                let (aside, height) = (strength * opening.aside, factor(opening.height));
                Self::Open(Opening { aside, height, ..opening.clone() })
            }
            Self::Map(mapped) => Self::Map(Mapped { strength: strength * mapped.strength, ..mapped.clone() }),
        }
    }

    /// The name of its handler (`shaders/effect`).
    pub fn handler(&self) -> &str {
        match self {
            Self::Translate(_) => "translate",
            Self::Scale { .. } => "scale",
            Self::Shear { .. } => "shear",
            Self::Taper { .. } => "taper",
            Self::Twist { .. } => "twist",
            Self::Bend { .. } => "bend",
            Self::Open(_) => "open-street",
            Self::Map(mapped) => mapped.map.name(),
        }
    }

    /// g(p), metres of the lens frame.
    pub fn value(&self, p: DVec3) -> DVec3 {
        p + DVec3::from(self.jet(&p.to_array()).0)
    }

    /// ∂g/∂p at p.
    pub fn jacobian(&self, p: DVec3) -> glam::DMat3 {
        super::matrix(&plus_identity(self.jet(&p.to_array()).1))
    }

    /// det ∂g/∂p at p, in closed form; > 0 wherever the operator may be used.
    pub fn determinant(&self, p: DVec3) -> f64 {
        self.det(&p.to_array())
    }

    /// The displacement g(p) − p and its derivative.
    #[inline]
    pub(super) fn jet<S: Number>(&self, p: &Vector<S>) -> (Vector<S>, Matrix<S>) {
        let (zero, one) = (S::from(0.0), S::from(1.0));
        let [x, y, z] = *p;
        match self {
            Self::Translate(way) => (way.to_array().map(S::from), zeros()),
            Self::Scale { factors, about } => {
                let more = (*factors - DVec3::ONE).to_array();
                let about = about.to_array();
                let mut rows = zeros();
                for i in 0..3 {
                    rows[i][i] = S::from(more[i]);
                }
                (std::array::from_fn(|i| p[i].plus(-about[i]).times(more[i])), rows)
            }
            Self::Shear { slope, base } => {
                let height = z.plus(-base);
                let column = |s: f64| [zero, zero, S::from(s)];
                ([height.times(slope.x), height.times(slope.y), zero], [column(slope.x), column(slope.y), [zero; 3]])
            }
            Self::Taper { z: ends, factors } => {
                let (r, slope) = linear(z, ends, factors);
                let more = r.plus(-1.0);
                ([x * more, y * more, zero], [[more, zero, x * slope], [zero, more, y * slope], [zero; 3]])
            }
            Self::Twist { z: ends, angles } => {
                let (angle, slope) = linear(z, ends, angles);
                let (sin, cos_less) = turn(angle);
                let cos = cos_less.plus(1.0);
                let (dx, dy) = (-(x * sin) - y * cos, x * cos - y * sin);
                let rows = [[cos_less, -sin, dx * slope], [sin, cos_less, dy * slope], [zero; 3]];
                ([x * cos_less - y * sin, x * sin + y * cos_less, zero], rows)
            }
            Self::Bend { curvature: k, y: [low, high], about, base } => {
                let z = z.plus(-base);
                let bent = y.clamp(*low, *high);
                let (u, beyond) = (bent.plus(-about), y - bent);
                let angle = u.times(*k);
                let (sin, cos_less) = turn(angle);
                let cos = cos_less.plus(1.0);
                let rise = u * angle.times(0.5) * angle.times(0.5).sinc().square();
                let dy = u * (angle.sinc() - one) - z * sin + beyond * cos_less;
                let dz = z * cos_less + rise + beyond * sin;
                let along = one - z.times(*k) * y.clamp_slope(*low, *high);
                let rows = [[zero; 3], [zero, cos * along - one, -sin], [zero, sin * along, cos_less]];
                ([zero, dy, dz], rows)
            }
            Self::Open(opening) => opening.jet(p),
            Self::Map(mapped) => S::of_map(|place| mapped.jet(place), mapped.most(), p),
        }
    }

    /// Its determinant where it has a closed form, else that of its Jacobian.
    pub(super) fn det<S: Number>(&self, p: &Vector<S>) -> S {
        match self {
            Self::Translate(_) | Self::Shear { .. } | Self::Twist { .. } => S::from(1.0),
            Self::Scale { factors, .. } => S::from(factors.x) * S::from(factors.y) * S::from(factors.z),
            Self::Taper { z, factors } => {
                // r enters twice, and its sign is lost: a taper through 0 is turned inside out twice over.
                let r = linear(p[2], z, factors).0;
                r * r
            }
            Self::Bend { curvature, y: [low, high], base, .. } => {
                S::from(1.0) - p[2].plus(-base).times(*curvature) * p[1].clamp_slope(*low, *high)
            }
            Self::Open(opening) => determinant(&plus_identity(opening.jet(p).1)),
            Self::Map(_) => determinant(&plus_identity(self.jet(p).1)),
        }
    }

    /// How far apart samples along x, y and z may be to see all that the operator does, metres; ∞ where it is linear.
    pub(super) fn spacing(&self) -> DVec3 {
        // A sixth of a radian between samples of an arc; half of a linear part between its kinks.
        const ARC: f64 = 1.0 / 6.0;
        let mut spacing = DVec3::INFINITY;
        match self {
            Self::Translate(_) | Self::Scale { .. } | Self::Shear { .. } => {}
            Self::Taper { z, factors } => {
                if factors[0] != factors[1] {
                    spacing.z = 0.5 * (z[1] - z[0]);
                }
            }
            Self::Twist { z, angles } => {
                let rate = (angles[1] - angles[0]).abs() / (z[1] - z[0]);
                if rate > 0.0 {
                    spacing.z = (ARC / rate).min(0.5 * (z[1] - z[0]));
                }
            }
            Self::Bend { curvature, y, .. } => {
                if *curvature != 0.0 {
                    spacing.y = (ARC / curvature.abs()).min(0.5 * (y[1] - y[0]));
                }
            }
            Self::Open(opening) => {
                if !opening.is_identity() {
                    let spacing_m = opening.spacing();
                    (spacing.x, spacing.y) = (spacing_m, spacing_m);
                }
            }
            Self::Map(mapped) => spacing = DVec3::splat(mapped.detail),
        }
        spacing
    }

    /// The part of the lens frame outside which g(p) = p to the bit.
    pub(super) fn support(&self) -> Aabb {
        let mut support = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        match self {
            Self::Bend { y, about, .. } if *about == y[0] => support.min.y = y[0],
            Self::Bend { y, about, .. } if *about == y[1] => support.max.y = y[1],
            Self::Open(opening) => {
                let [low, high] = opening.bounds();
                support = Aabb { min: low.extend(f64::NEG_INFINITY), max: high.extend(f64::INFINITY) };
            }
            _ => {}
        }
        support
    }

    /// Why it may not be used at all, in words, or nothing. What depends on the place (kz < 1 of a bend) is not asked here, but by
    /// [`super::Deformation::safe_strength`].
    pub(super) fn fault(&self) -> Option<&'static str> {
        let ascends = |[low, high]: [f64; 2]| low < high && (high - low).is_finite();
        match self {
            Self::Translate(way) if !way.is_finite() => Some("a translation is not finite"),
            Self::Scale { factors, about } if !factors.is_finite() || !about.is_finite() => {
                Some("a scale is not finite")
            }
            Self::Shear { slope, base } if !slope.is_finite() || !base.is_finite() => Some("a shear is not finite"),
            Self::Taper { z, .. } | Self::Twist { z, .. } if !ascends(*z) => Some("a range of heights does not ascend"),
            Self::Taper { factors: ends, .. } | Self::Twist { angles: ends, .. }
                if !ends.iter().all(|f| f.is_finite()) =>
            {
                Some("a factor or an angle is not finite")
            }
            Self::Bend { y, .. } if !ascends(*y) => Some("the ends of a bend do not ascend"),
            Self::Bend { curvature, about, base, .. } if ![curvature, about, base].iter().all(|n| n.is_finite()) => {
                Some("a bend is not finite")
            }
            Self::Open(opening) => opening.fault(),
            Self::Map(mapped) => mapped.fault(),
            _ => None,
        }
    }
}

/// What goes linearly from `values[0]` at `ends[0]` to `values[1]` at `ends[1]` and is the same beyond, and its derivative.
fn linear<S: Number>(at: S, ends: &[f64; 2], values: &[f64; 2]) -> (S, S) {
    let rate = (values[1] - values[0]) / (ends[1] - ends[0]);
    (
        at.clamp(ends[0], ends[1]).plus(-ends[0]).times(rate).plus(values[0]),
        at.clamp_slope(ends[0], ends[1]).times(rate),
    )
}

/// sin φ and cos φ − 1, the latter without the loss of a difference.
fn turn<S: Number>(angle: S) -> (S, S) {
    let half = angle.times(0.5).sin_cos().0;
    (angle.sin_cos().0, -(half.square().times(2.0)))
}
