//! Where and how much a deformation acts: κ over a lens plane (Trapp §3.2.2).

use glam::{DVec2, DVec3};

use crate::geom::{
    aabb::Aabb,
    deform::{
        Interval,
        number::{Number, Vector},
    },
};

/// κ in 0..=1, the part of the operators' displacement that a place gets.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// κ = 1 everywhere: what the operators move is moved.
    Everywhere,
    /// κ from a rectangle of the lens' plane, 0 outside it.
    Plane(ControlPlane),
}

/// A rectangle in the plane of the lens, and κ over it.
///
/// ```text
///        t=1 ┌────────────┐          s = (x − F.x)/w    t = (y − F.y)/h    δ = z − F.z
///      B     │     κ      │ h        κ(s, t)·band(δ); 0 unless 0 ≤ s ≤ 1 and 0 ≤ t ≤ 1
///      ↑     │            │
///      └→ A  F────────────┘ s=1      N = A × B towards the reader
///                  w
/// ```
///
/// κ is 0 along the rectangle's border whatever the profile: what is deformed never tears off.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPlane {
    /// F, in the lens frame: relative to its pivot, along A, B, N; metres.
    pub corner: DVec3,
    /// w and h, metres, > 0.
    pub size: DVec2,
    /// κ over s and t.
    pub profile: Profile,
    /// In which heights over the plane it acts; `None`: in all.
    pub band: Option<Band>,
}

/// κ over s, t in 0..=1. With q(s) = clamp(min(s, 1 − s)/border, 0, 1), S(q) = 3q² − 2q³, ρ² = (2s − 1)² + (2t − 1)²:
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// q(s)·q(t): a plateau with straight slopes. Continuous; its derivative is not.
    Linear {
        /// Width of the slopes as a part of the sides, in 0..=½.
        border: f64,
    },
    /// S(q(s))·S(q(t)): a plateau with smooth slopes; once continuously differentiable.
    Smooth {
        /// As of [`Profile::Linear`].
        border: f64,
    },
    /// (1 − ρ²)² for ρ < 1: a round hill; once continuously differentiable.
    Bump,
    /// (1 − v²)² for |v| < 1, v = (2ρ² − outer² − inner²)/(outer² − inner²): a round wall, 0 within `inner` and beyond `outer`.
    Ring {
        /// ≥ 0.
        inner: f64,
        /// > `inner`, ≤ 1.
        outer: f64,
    },
    /// A grid of numbers, filtered bilinearly.
    Texels(Texels),
}

/// A grid of κ: f32 in 0..=1, filtered by hand at p = s·size − ½.
///
/// Between the outermost texels' middles and the border of the rectangle, half a texel away, κ goes to 0 linearly (Trapp leaves open what
/// is there): any picture may be a lens, and none of them tears.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Texels {
    /// Rows of constant t, beginning with the smallest, each from the smallest s. `None` unless there are `width × height` > 0 numbers
    /// in 0..=1.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Option<Self> {
        let fits = width.checked_mul(height).is_some_and(|count| count > 0 && count == values.len());
        (fits && values.iter().all(|v| (0.0..=1.0).contains(v))).then_some(Self { width, height, values })
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Rows of constant t, as given.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// κ and its derivatives by s and t, for s, t in 0..=1.
    fn at(&self, s: f64, t: f64) -> (f64, [f64; 2]) {
        let (columns, rows) = (Knots::new(s, self.width), Knots::new(t, self.height));
        let value = |i: usize, j: usize| match (columns.texel[i], rows.texel[j]) {
            (Some(x), Some(y)) => f64::from(self.values[y * self.width + x]),
            _ => 0.0,
        };
        let [u, v] = [columns.part, rows.part];
        let (low, high) = (value(0, 0) * (1.0 - u) + value(1, 0) * u, value(0, 1) * (1.0 - u) + value(1, 1) * u);
        let rise = |j: usize| value(1, j) - value(0, j);
        let by_s = columns.rate * (rise(0) * (1.0 - v) + rise(1) * v);
        (low * (1.0 - v) + high * v, [by_s, rows.rate * (high - low)])
    }

    /// Bounds of the same over a box: κ is convex between texels, so its texels bound it, and their differences its derivatives.
    fn over(&self, s: Interval, t: Interval) -> (Interval, [Interval; 2]) {
        let [columns, rows] = [(s, self.width), (t, self.height)].map(|(at, count)| {
            // Knot −1 and `count` are the zeros on the border.
            let low = (at.low * count as f64 - 0.5).next_down().floor().max(-1.0) as isize;
            let high = (at.high * count as f64 - 0.5).next_up().floor().min(count as f64 - 1.0) as isize;
            low..=high
        });
        let value = |x: isize, y: isize| {
            let is_inside = (0..self.width as isize).contains(&x) && (0..self.height as isize).contains(&y);
            if is_inside { f64::from(self.values[y as usize * self.width + x as usize]) } else { 0.0 }
        };
        let rate = |cell: isize, count: usize| {
            let is_half = cell < 0 || cell + 1 >= count as isize;
            count as f64 * if is_half { 2.0 } else { 1.0 }
        };
        let (mut kappa, mut by_s, mut by_t) = (None, None, None);
        let grow = |bounds: &mut Option<Interval>, v: f64| {
            *bounds = Some(bounds.map_or(v.into(), |b| b.union(v.into())));
        };
        for y in rows {
            for x in columns.clone() {
                let corners = [value(x, y), value(x + 1, y), value(x, y + 1), value(x + 1, y + 1)];
                corners.iter().for_each(|&v| grow(&mut kappa, v));
                let [across, up] = [rate(x, self.width), rate(y, self.height)];
                [corners[1] - corners[0], corners[3] - corners[2]].iter().for_each(|v| grow(&mut by_s, v * across));
                [corners[2] - corners[0], corners[3] - corners[1]].iter().for_each(|v| grow(&mut by_t, v * up));
            }
        }
        // One more step than rounding may take: filtering is a handful of operations.
        let wide = |bounds: Option<Interval>| bounds.unwrap_or(0.0.into()) * Interval::new(1.0 - 1e-14, 1.0 + 1e-14);
        (wide(kappa), [wide(by_s), wide(by_t)])
    }
}

/// The two texels next to a place along one side, `None` for the zero on the border.
struct Knots {
    texel: [Option<usize>; 2],
    /// From the first to the second, 0..=1.
    part: f64,
    /// Derivative of `part` by s.
    rate: f64,
}

impl Knots {
    fn new(s: f64, count: usize) -> Self {
        let (size, last) = (count as f64, count - 1);
        let p = s * size - 0.5;
        if p < 0.0 {
            Self { texel: [None, Some(0)], part: (2.0 * p + 1.0).max(0.0), rate: 2.0 * size }
        } else if p >= last as f64 {
            Self { texel: [Some(last), None], part: (2.0 * (p - last as f64)).min(1.0), rate: 2.0 * size }
        } else {
            let first = p.floor();
            Self { texel: [Some(first as usize), Some(first as usize + 1)], part: p - first, rate: size }
        }
    }
}

/// A range of δ, metres over the plane, with smooth ends: S(c((δ − low)/fade))·S(c((high − δ)/fade)), c clamping to 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Where it begins; −∞ without a beginning.
    pub low: f64,
    /// Where it ends; ∞ without an end.
    pub high: f64,
    /// Over how many metres it comes and goes, > 0.
    pub fade: f64,
}

/// κ over a place and its gradient in the lens frame, 1/metres.
pub(super) struct Kappa<S> {
    pub(super) value: S,
    pub(super) slope: Vector<S>,
}

/// A number over which a grid of texels can be asked.
pub(super) trait Sampled: Number {
    fn texels(texels: &Texels, s: Self, t: Self) -> (Self, [Self; 2]);
}

impl Sampled for f64 {
    fn texels(texels: &Texels, s: Self, t: Self) -> (Self, [Self; 2]) {
        texels.at(s, t)
    }
}

impl Sampled for Interval {
    fn texels(texels: &Texels, s: Self, t: Self) -> (Self, [Self; 2]) {
        texels.over(s, t)
    }
}

impl Control {
    /// The box of the lens frame, closed, outside which κ = 0.
    pub(super) fn support(&self) -> Aabb {
        match self {
            Self::Everywhere => Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
            Self::Plane(plane) => {
                let (low, high) = plane.band.map_or((f64::NEG_INFINITY, f64::INFINITY), |band| (band.low, band.high));
                let far = plane.corner.truncate() + plane.size;
                Aabb {
                    min: plane.corner.truncate().extend(plane.corner.z + low),
                    max: far.extend(plane.corner.z + high),
                }
            }
        }
    }

    /// κ at a place in the support.
    pub(super) fn at<S: Sampled>(&self, p: &Vector<S>) -> Kappa<S> {
        match self {
            Self::Everywhere => Kappa { value: S::from(1.0), slope: [S::from(0.0); 3] },
            Self::Plane(plane) => plane.at(p),
        }
    }

    /// How far apart samples along x, y and z may be to see all of it, metres.
    pub(super) fn spacing(&self) -> DVec3 {
        let Self::Plane(plane) = self else { return DVec3::INFINITY };
        let parts = match &plane.profile {
            Profile::Linear { border } | Profile::Smooth { border } => DVec2::splat(0.5 * border),
            Profile::Bump => DVec2::splat(0.125),
            Profile::Ring { inner, outer } => DVec2::splat(0.125 * (outer - inner)),
            Profile::Texels(texels) => 0.5 / DVec2::new(texels.width as f64, texels.height as f64),
        };
        (parts * plane.size).extend(plane.band.map_or(f64::INFINITY, |band| 0.5 * band.fade))
    }

    /// Why it may not be used, in words, or nothing.
    pub(super) fn fault(&self) -> Option<&'static str> {
        let Self::Plane(ControlPlane { corner, size, profile, band }) = self else { return None };
        if !corner.is_finite() || !size.is_finite() || size.min_element() <= 0.0 {
            return Some("the control plane has no area");
        }
        match profile {
            Profile::Linear { border } | Profile::Smooth { border } if !(*border > 0.0 && *border <= 0.5) => {
                return Some("the border of a profile is not in 0..=1/2");
            }
            Profile::Ring { inner, outer } if !(*inner >= 0.0 && inner < outer && *outer <= 1.0) => {
                return Some("the radii of a ring do not ascend from 0 to 1");
            }
            _ => {}
        }
        let is_fine = band.is_none_or(|band| band.low < band.high && band.fade > 0.0 && band.fade.is_finite());
        (!is_fine).then_some("the band of heights does not ascend")
    }
}

impl ControlPlane {
    fn at<S: Sampled>(&self, p: &Vector<S>) -> Kappa<S> {
        let corner = self.corner.to_array();
        let unit = |i: usize, size: f64| p[i].plus(-corner[i]).times(1.0 / size).clamp(0.0, 1.0);
        let (value, [by_s, by_t]) = self.profile.at(unit(0, self.size.x), unit(1, self.size.y));
        let slope = [by_s.times(1.0 / self.size.x), by_t.times(1.0 / self.size.y)];
        let Some(band) = &self.band else { return Kappa { value, slope: [slope[0], slope[1], S::from(0.0)] } };
        let level = band.at(p[2].plus(-corner[2]));
        let slope = [slope[0] * level.value, slope[1] * level.value, value * level.slope];
        Kappa { value: value * level.value, slope }
    }
}

impl Profile {
    /// κ and its derivatives by s and t, for s, t in 0..=1.
    fn at<S: Sampled>(&self, s: S, t: S) -> (S, [S; 2]) {
        let product = |a: Factor<S>, b: Factor<S>| (a.value * b.value, [a.slope * b.value, a.value * b.slope]);
        let one = S::from(1.0);
        let centred = || [s, t].map(|x| x.times(2.0).plus(-1.0));
        match self {
            Self::Linear { border } => product(trapezoid(s, *border), trapezoid(t, *border)),
            Self::Smooth { border } => product(smoothed(trapezoid(s, *border)), smoothed(trapezoid(t, *border))),
            Self::Bump => {
                let [x, y] = centred();
                let rest = (one - x.square() - y.square()).larger(S::from(0.0));
                (rest.square(), [x, y].map(|c| -(c * rest).times(8.0)))
            }
            Self::Ring { inner, outer } => {
                let [x, y] = centred();
                let (middle, half) = (0.5 * (outer * outer + inner * inner), 0.5 * (outer * outer - inner * inner));
                let v = (x.square() + y.square()).plus(-middle).times(1.0 / half).clamp(-1.0, 1.0);
                let rest = one - v.square();
                (rest.square(), [x, y].map(|c| -(rest * v * c).times(16.0 / half)))
            }
            Self::Texels(texels) => S::texels(texels, s, t),
        }
    }
}

impl Band {
    fn at<S: Number>(&self, delta: S) -> Factor<S> {
        let ramp = |from: S| {
            let q = from.times(1.0 / self.fade);
            Factor { value: q.clamp(0.0, 1.0), slope: q.clamp_slope(0.0, 1.0).times(1.0 / self.fade) }
        };
        let (up, down) = (smoothed(ramp(delta.plus(-self.low))), smoothed(ramp(S::from(self.high) - delta)));
        Factor { value: up.value * down.value, slope: up.slope * down.value - up.value * down.slope }
    }
}

/// A factor of κ over one number, and its derivative.
struct Factor<S> {
    value: S,
    slope: S,
}

/// clamp(min(s, 1 − s)/border, 0, 1), for s in 0..=1 and border ≤ ½.
fn trapezoid<S: Number>(s: S, border: f64) -> Factor<S> {
    let rate = 1.0 / border;
    let (up, down) = (s.times(rate), (S::from(1.0) - s).times(rate));
    let slope = up.clamp_slope(0.0, 1.0).times(rate) - down.clamp_slope(0.0, 1.0).times(rate);
    Factor { value: up.smaller(down).clamp(0.0, 1.0), slope }
}

/// 3q² − 2q³.
fn smoothed<S: Number>(q: Factor<S>) -> Factor<S> {
    Factor { value: q.value.smooth(), slope: q.value.smooth_slope() * q.slope }
}
