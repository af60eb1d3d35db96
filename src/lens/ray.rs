//! Lenses that bend rays: where they stand in the picture, and what they do to the rays that come through them (Wang et al. §3).

use std::path::PathBuf;

use glam::DVec2;

use crate::lens::{chosen::Choice, handled::Handled};

/// What a lens that bends rays has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct RayLens {
    /// Its middle, shares of the picture's width and height, y down.
    pub center: DVec2,
    /// From its middle to its rim, a share of the picture's height; of a feature-based one how wide the band around its core is.
    pub radius: f64,
    /// Its outline in the picture.
    pub outline: RayOutline,
    /// An image whose light pixels are its outline, in place of that: over the square around it, as large as its longer side lets it be; of a magnifier.
    pub mask: Option<PathBuf>,
    /// How it bends them.
    pub bend: Bend,
    /// How what it shows is found.
    pub method: RayMethod,
    /// How finely, > 0: of [`RayMethod::Image`] texels of its image to a pixel, where it magnifies most; of [`RayMethod::Vertices`] how many
    /// times shorter sides of triangles are than where nothing is said.
    pub fineness: f64,
    /// The city objects that it acts on; the others are seen as without it. `None`: all.
    pub only: Option<Choice>,
    /// Whether lines that are straight without it are drawn over what it shows.
    pub grid: bool,
}

/// The outline of such a lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum RayOutline {
    /// Round.
    #[default]
    Circle,
    /// With edges along those of the picture.
    Square,
}

/// How what such a lens shows is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum RayMethod {
    /// Each pixel follows its ray through the triangles.
    #[default]
    Rays,
    /// Each pixel looks along its ray into an image of what the eye sees without it: what is hidden there is missing.
    Image,
    /// The triangles are cut into smaller ones, whose corners are put where it shows them; their sides are straight.
    Vertices,
}

/// How a lens bends rays.
#[derive(Clone, Debug, PartialEq)]
pub enum Bend {
    /// Behind a plane across the view axis what is seen through it is larger (Wang et al. §3.1).
    Magnify(Magnify),
    /// The same, where its core is what rays to the focal point meet of a feature (Wang et al. §3.2).
    Feature(Feature),
    /// Pixels lie closer together in its middle than at its rim (Wang et al. §3.3).
    Sample(Sampling),
    /// From the eye into all directions (Wang et al. §3.4).
    Fisheye(Fisheye),
    /// As a handler of the user's says ([`crate::lens::own_bend`]).
    Own(Handled),
}

/// What a magnifier does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnify {
    /// How many times as large its core shows what lies at [`Self::at`], and all beyond, > 0.
    pub magnification: f64,
    /// From its plane to where that is reached, along the view axis, metres, > 0; `None`: to what its middle shows.
    pub at: Option<f64>,
    /// From the eye to its plane, along the view axis, metres, > 0; `None`: half of the way to what its middle shows.
    pub distance: Option<f64>,
    /// How wide the band is in which rays find back to where they would go, a share of the radius, 0..=1.
    pub border: f64,
}

/// What a feature-based lens does.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// How it magnifies; its border says nothing.
    pub magnify: Magnify,
    /// The feature.
    pub of: Choice,
}

/// What a sampling-rate lens does.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// How densely it samples, from its middle to its rim.
    pub rate: SamplingRate,
}

/// Sampling rates over the share of the radius, 0..=1: how many pixels there are to one, but for a factor that all have.
#[derive(Clone, Debug, PartialEq)]
pub enum SamplingRate {
    /// From this at the middle down to 1 at the rim, without a kink at either.
    Cubic(f64),
    /// Straight between such places and rates, the first at 0, the last at 1; rates > 0.
    Points(Vec<DVec2>),
}

/// What a fisheye does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fisheye {
    /// The angle from rim to rim, radians, > 0: up to a whole turn, of a hemispherical one half of one.
    pub angle: f64,
    /// How angles lie in the picture.
    pub projection: FisheyeProjection,
}

/// How angles from the axis lie in the picture of a fisheye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FisheyeProjection {
    /// By themselves: equal ones are equally far apart.
    #[default]
    Angular,
    /// By their sines: as a half ball looks from afar.
    Hemispherical,
}

/// How many times as large a lens shows things of which nothing is said.
const MAGNIFICATION: f64 = 2.5;

impl RayLens {
    /// In the middle of the picture.
    pub fn new(bend: Bend) -> Self {
        Self {
            center: DVec2::splat(0.5),
            radius: 0.25,
            outline: RayOutline::Circle,
            mask: None,
            bend,
            method: RayMethod::default(),
            fineness: 1.0,
            only: None,
            grid: false,
        }
    }

    /// A magnifier of which nothing is said.
    pub fn magnifier() -> Self {
        Self::new(Bend::Magnify(Magnify { magnification: MAGNIFICATION, at: None, distance: None, border: 0.4 }))
    }

    /// A feature-based lens of which nothing is said: of no feature.
    pub fn feature() -> Self {
        let magnify = Magnify { magnification: MAGNIFICATION, at: None, distance: None, border: 1.0 };
        Self { radius: 0.1, ..Self::new(Bend::Feature(Feature { magnify, of: Choice::default() })) }
    }

    /// A sampling-rate lens of which nothing is said.
    pub fn sampling() -> Self {
        Self::new(Bend::Sample(Sampling { rate: SamplingRate::Cubic(MAGNIFICATION) }))
    }

    /// A fisheye of which nothing is said: half of all directions, over all of the picture's height.
    pub fn fisheye() -> Self {
        let bend = Fisheye { angle: std::f64::consts::PI, projection: FisheyeProjection::Angular };
        Self { radius: 0.5, ..Self::new(Bend::Fisheye(bend)) }
    }

    /// A lens of a user's handler, none so far.
    pub fn own() -> Self {
        Self::new(Bend::Own(Handled::nameless()))
    }
}

impl Bend {
    /// How it magnifies behind a plane, if it does.
    pub fn magnify(&self) -> Option<&Magnify> {
        match self {
            Self::Magnify(magnify) | Self::Feature(Feature { magnify, .. }) => Some(magnify),
            Self::Sample(_) | Self::Fisheye(_) | Self::Own(_) => None,
        }
    }

    /// The same, to be changed.
    pub fn magnify_mut(&mut self) -> Option<&mut Magnify> {
        match self {
            Self::Magnify(magnify) | Self::Feature(Feature { magnify, .. }) => Some(magnify),
            Self::Sample(_) | Self::Fisheye(_) | Self::Own(_) => None,
        }
    }

    /// What a feature-based lens does, if it is one.
    pub fn feature(&self) -> Option<&Feature> {
        match self {
            Self::Feature(feature) => Some(feature),
            Self::Magnify(_) | Self::Sample(_) | Self::Fisheye(_) | Self::Own(_) => None,
        }
    }
}

impl SamplingRate {
    /// Whether it is the same everywhere: it changes nothing.
    pub fn is_even(&self) -> bool {
        match self {
            Self::Cubic(middle) => *middle == 1.0,
            Self::Points(points) => points.windows(2).all(|pair| pair[0].y == pair[1].y),
        }
    }

    /// The rate at a share of the radius, 0..=1.
    pub fn at(&self, s: f64) -> f64 {
        match self {
            Self::Cubic(middle) => 1.0 + (middle - 1.0) * (1.0 - s * s * (3.0 - 2.0 * s)),
            Self::Points(points) => {
                let next = points.partition_point(|p| p.x <= s).clamp(1, points.len() - 1);
                let [a, b] = [points[next - 1], points[next]];
                a.y + (b.y - a.y) * ((s - a.x) / (b.x - a.x)).clamp(0.0, 1.0)
            }
        }
    }

    /// Where it has no derivative, ascending, without 0 and 1.
    fn kinks(&self) -> Vec<f64> {
        match self {
            Self::Cubic(_) => Vec::new(),
            Self::Points(points) => points[1..points.len() - 1].iter().map(|p| p.x).collect(),
        }
    }
}

/// Knots of a [`SampledRadius`].
pub const SAMPLED_KNOTS: usize = crate::shader::RAY_NUMBERS;
/// Points of a drawn rate, at most.
pub const MOST_POINTS: usize = 32;

/// Which radius of the picture a sampling-rate lens shows at each of its own, both shares of the lens' radius:
/// `D(r) = I(r) / I(1)`, `I(r) = ∫0..r ds / sr(s)` (Wang et al. §3.3, whose sum over pixels goes beyond the rim).
#[derive(Clone, Debug, PartialEq)]
pub struct SampledRadius {
    /// Ascending from 0 to 1: the radius of the lens, that of the picture, and its derivative.
    pub knots: Vec<[f64; 3]>,
}

/// Parts into which the integral between two knots is cut, each with five points: the error of a smooth rate is below 10⁻⁹.
const PARTS: usize = 4;
/// Gauss–Legendre, five points: places in −1..1 and weights.
const GAUSS: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_08],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_08],
];

impl SampledRadius {
    /// That of a rate.
    pub fn new(rate: &SamplingRate) -> Self {
        let inverse = |s: f64| rate.at(s).recip();
        let kinks = rate.kinks();
        let over = |a: f64, b: f64| {
            let half = 0.5 * (b - a);
            GAUSS.iter().map(|[x, weight]| weight * inverse(a + half * (1.0 + x))).sum::<f64>() * half
        };
        // A knot at each kink, and the others at equal steps.
        let steps = SAMPLED_KNOTS - 1 - kinks.len();
        let mut places: Vec<f64> = (0..=steps).map(|k| k as f64 / steps as f64).chain(kinks).collect();
        places.sort_by(f64::total_cmp);
        let mut integrals = vec![0.0];
        for pair in places.windows(2) {
            let at = |part: usize| pair[0] + (pair[1] - pair[0]) * part as f64 / PARTS as f64;
            let own: f64 = (0..PARTS).map(|part| over(at(part), at(part + 1))).sum();
            integrals.push(integrals[integrals.len() - 1] + own);
        }
        let whole = integrals[integrals.len() - 1];
        let knot = |(place, integral): (f64, f64)| [place, integral / whole, inverse(place) / whole];
        Self { knots: places.into_iter().zip(integrals).map(knot).collect() }
    }

    /// How many times as large it shows things where it shows them largest, along or across the radius; at least 1.
    pub fn magnifies(&self) -> f64 {
        let least = |[place, shown, slope]: &[f64; 3]| if *place > 0.0 { slope.min(shown / place) } else { *slope };
        self.knots.iter().map(least).fold(1.0, f64::min).recip()
    }

    /// The radius at one of the lens', 0..=1: cubic between knots.
    pub fn at(&self, r: f64) -> f64 {
        let next = self.knots.partition_point(|knot| knot[0] <= r).clamp(1, self.knots.len() - 1);
        let [[from, a, a_slope], [to, b, b_slope]] = [self.knots[next - 1], self.knots[next]];
        let step = to - from;
        let t = if step > 0.0 { ((r - from) / step).clamp(0.0, 1.0) } else { 1.0 };
        let (t2, t3) = (t * t, t * t * t);
        a * (2.0 * t3 - 3.0 * t2 + 1.0)
            + a_slope * step * (t3 - 2.0 * t2 + t)
            + b * (3.0 * t2 - 2.0 * t3)
            + b_slope * step * (t3 - t2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ a..b of f, halved until both halves agree.
    fn adaptive(f: &dyn Fn(f64) -> f64, [a, b]: [f64; 2], depth: u32) -> f64 {
        let simpson = |a: f64, b: f64| (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b));
        let middle = 0.5 * (a + b);
        let (whole, halves) = (simpson(a, b), simpson(a, middle) + simpson(middle, b));
        if depth == 0 || (depth < 40 && (whole - halves).abs() < 1e-13) {
            return halves;
        }
        adaptive(f, [a, middle], depth - 1) + adaptive(f, [middle, b], depth - 1)
    }

    #[test]
    fn sampled_radii_are_the_integrals() {
        let drawn = |points: &[[f64; 2]]| SamplingRate::Points(points.iter().copied().map(DVec2::from).collect());
        let rates = [
            SamplingRate::Cubic(1.0),
            SamplingRate::Cubic(2.5),
            SamplingRate::Cubic(8.0),
            SamplingRate::Cubic(0.4),
            drawn(&[[0.0, 1.0], [1.0, 3.0]]),
            drawn(&[[0.0, 3.0], [0.3, 3.0], [0.6, 1.0], [1.0, 1.0]]),
            drawn(&[[0.0, 0.5], [0.45, 2.0], [0.5, 4.0], [1.0, 0.7]]),
        ];
        for rate in &rates {
            let sampled = SampledRadius::new(rate);
            let inverse = |s: f64| rate.at(s).recip();
            let whole = adaptive(&inverse, [0.0, 1.0], 44);
            for i in 0..=200 {
                let r = f64::from(i) / 200.0;
                let expected = adaptive(&inverse, [0.0, r], 44) / whole;
                let found = sampled.at(r);
                assert!((found - expected).abs() < 1e-6, "{rate:?} at {r}: {found} is not {expected}");
            }
            assert_eq!((sampled.at(0.0), sampled.at(1.0)), (0.0, 1.0));
        }
    }
}
