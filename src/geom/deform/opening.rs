//! A street opened along a route: what stands near it is pushed aside and lowered.
//!
//! Distance to a line of several parts has a crease wherever two parts are equally near, and what is pushed along it would tear.
//! So the way from the route is smoothed: with K(r) = (1 − r²/R²)² for r < R, R = 3/2 reach, and c(s) the points of the route,
//!
//! ```text
//!   W = ∫ K(|c(s) − x|) ds        V = ∫ K(|c(s) − x|) (c(s) − x) ds        o(x) = −V/W        d = |o|
//! ```
//!
//! o is the way to x from the weighted mean of the route near it (a step of mean shift). Along a straight street it is exactly the way
//! from its nearest point, and d the distance; round a corner it turns smoothly. Both integrals have closed forms for each part.
//! With w = `half_width`, q = d/w, S(t) = 3t² − 2t³ and t = clamp((d − w)/(reach − w), 0, 1):
//!
//! ```text
//!   aside:   x' = x + aside·F(d)·o/d     F = (3q − q³)/2 where d ≤ w, else 1 − S(t)
//!   height:  z' = base + (z − base)·(1 − (1 − height)·G(d))     G = 1 where d ≤ w, else 1 − S(t)
//! ```
//!
//! Where hardly anything has a weight the mean may be anywhere (between two far parts of one route it jumps), so what is moved is
//! multiplied with S(clamp((W/R⁵ − 0.05)/0.15, 0, 1)), which is 1 along a straight street.
//!
//! All of it is once continuously differentiable. Along a straight street d' = d + aside·F(d) rises as long as
//! aside < (reach − w)/1.5; round corners less may be possible ([`super::Deformation::safe_strength`]). The end of a route pushes
//! forwards too: a route that is longer than what is seen of it by 3/2 reach shows nothing of that.

use glam::DVec2;

use crate::geom::deform::number::{Matrix, Number, Vector, zeros};

/// Radius of the weights by the reach.
const RADIUS: f64 = 1.5;

/// A street opened along a route, in the frame of the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// The route seen against N, in order, two points at least, metres.
    pub line: Vec<DVec2>,
    /// Where the push is full, metres from the route: half of the street; > 0.
    pub half_width: f64,
    /// Where the push ends, metres from the route; > `half_width`.
    pub reach: f64,
    /// By how many metres each side is moved away, ≥ 0.
    pub aside: f64,
    /// What heights are multiplied with along the route, > 0; 1 leaves them.
    pub height: f64,
    /// The height that stays, z of the lens frame.
    pub base: f64,
}

/// Integrals W, in units of R⁵, up to which a place is not moved, and from which on it is moved in full. Along a straight street W is
/// 0.245 at the reach.
const NO_TRUST: f64 = 0.05;
const FULL_TRUST: f64 = 0.2;

/// o and ∂o (rows), and what both are multiplied with and its gradient, at a place.
struct Offset<S> {
    way: [S; 2],
    slope: [[S; 2]; 2],
    trust: S,
    trust_slope: [S; 2],
}

impl Opening {
    /// Whether it moves nothing.
    pub(super) fn is_identity(&self) -> bool {
        self.aside == 0.0 && self.height == 1.0
    }

    /// How far apart samples may be to see all of it, metres.
    pub(super) fn spacing(&self) -> f64 {
        0.5 * self.half_width.min(self.reach - self.half_width)
    }

    /// The box (x, y) outside which nothing is moved.
    pub(super) fn bounds(&self) -> [DVec2; 2] {
        let low = self.line.iter().fold(DVec2::INFINITY, |low, p| low.min(*p));
        let high = self.line.iter().fold(DVec2::NEG_INFINITY, |high, p| high.max(*p));
        [low - self.radius(), high + self.radius()]
    }

    pub(super) fn fault(&self) -> Option<&'static str> {
        let numbers = [self.half_width, self.reach, self.aside, self.height, self.base];
        if !numbers.iter().all(|n| n.is_finite()) || !self.line.iter().all(|p| p.is_finite()) {
            return Some("an opening is not finite");
        }
        if self.line.windows(2).all(|part| part[0].distance(part[1]) <= 0.0) {
            return Some("a route has no length");
        }
        (self.half_width <= 0.0 || self.reach <= self.half_width)
            .then_some("the reach of an opening is not wider than it")
    }

    fn radius(&self) -> f64 {
        RADIUS * self.reach
    }

    /// The displacement and its derivative.
    pub(super) fn jet<S: Number>(&self, p: &Vector<S>) -> (Vector<S>, Matrix<S>) {
        let nothing = ([S::from(0.0); 3], zeros());
        if self.is_identity() {
            return nothing;
        }
        let Some(Offset { way, slope, trust, trust_slope }) = self.offset([p[0], p[1]]) else { return nothing };
        let distance = (way[0].square() + way[1].square()).root();
        if distance.ends()[0] >= self.reach {
            return nothing;
        }
        let (push, push_slope) = self.push(distance);
        let (fade, fade_slope) = self.fade(distance);
        let lower = self.height - 1.0;
        let height = p[2].plus(-self.base).times(lower);

        // Half the gradient of d², (∂o)ᵀ·o.
        let half: [S; 2] = std::array::from_fn(|j| slope[0][j] * way[0] + slope[1][j] * way[1]);
        let moved = [push * way[0], push * way[1], height * fade];
        let mut rows = zeros();
        for i in 0..2 {
            for j in 0..2 {
                rows[i][j] = push * slope[i][j] + push_slope * way[i] * half[j];
            }
        }
        rows[2] = [height * fade_slope * half[0], height * fade_slope * half[1], fade.times(lower)];
        for (row, moved) in rows.iter_mut().zip(moved) {
            *row = row.map(|slope| slope * trust);
            row[0] = row[0] + moved * trust_slope[0];
            row[1] = row[1] + moved * trust_slope[1];
        }
        (moved.map(|way| way * trust), rows)
    }

    /// aside·F(d)/d and its derivative by d, divided by d.
    fn push<S: Number>(&self, distance: S) -> (S, S) {
        let (w, aside) = (self.half_width, self.aside);
        let inner = |d: S| (S::from(1.5) - d.square().times(0.5 / (w * w))).times(aside / w);
        let inner_slope = |_: S| S::from(-aside / (w * w * w));
        let outer = |d: S| self.faded(d).0.times(aside) * d.inverse();
        // (F/d)'/d = (F' − F/d)/d².
        let outer_slope = |d: S| {
            let (fade, slope) = self.faded(d);
            (slope - fade * d.inverse()).times(aside) * d.square().inverse()
        };
        (distance.up_to(w, inner, outer), distance.up_to(w, inner_slope, outer_slope))
    }

    /// G(d) and its derivative by d, divided by d.
    fn fade<S: Number>(&self, distance: S) -> (S, S) {
        let w = self.half_width;
        let value = distance.up_to(w, |_| S::from(1.0), |d| self.faded(d).0);
        (value, distance.up_to(w, |_| S::from(0.0), |d| self.faded(d).1 * d.inverse()))
    }

    /// 1 − S(t) and its derivative by d, for d > `half_width`.
    fn faded<S: Number>(&self, distance: S) -> (S, S) {
        let scale = 1.0 / (self.reach - self.half_width);
        let t = distance.plus(-self.half_width).times(scale).clamp(0.0, 1.0);
        (S::from(1.0) - t.smooth(), -(t.smooth_slope().times(scale)))
    }

    /// The smoothed way from the route; `None` where nothing of it is near, or surely farther than the reach.
    fn offset<S: Number>(&self, at: [S; 2]) -> Option<Offset<S>> {
        // In units of R; the factor R⁵ of W and V and their signs cancel.
        let unit = 1.0 / self.radius();
        let zero = S::from(0.0);
        let (mut weight, mut weight_slope) = (zero, [zero; 2]);
        let (mut mean, mut mean_slope) = ([zero; 2], [[zero; 2]; 2]);
        let mut is_near = false;
        for part in self.line.windows(2) {
            let length = part[0].distance(part[1]);
            let Some(along) = (part[1] - part[0]).try_normalize() else { continue };
            let from = [at[0].plus(-part[0].x).times(unit), at[1].plus(-part[0].y).times(unit)];
            let a = from[0].times(along.x) + from[1].times(along.y);
            let b = from[1].times(along.x) - from[0].times(along.y);
            let Some(sums) = Sums::of(a, b, length * unit) else { continue };
            is_near = true;
            weight = weight + sums.weight;
            // Back from along and across the part to x and y.
            let turned =
                |v: [S; 2]| [v[0].times(along.x) - v[1].times(along.y), v[0].times(along.y) + v[1].times(along.x)];
            let add = |to: &mut [S; 2], v: [S; 2]| *to = [to[0] + v[0], to[1] + v[1]];
            add(&mut weight_slope, turned(sums.weight_slope));
            add(&mut mean, turned(sums.mean));
            // T·D·Tᵀ: the columns first, then the rows.
            let columns = [0, 1].map(|j| turned([sums.mean_slope[0][j], sums.mean_slope[1][j]]));
            for (i, row) in mean_slope.iter_mut().enumerate() {
                add(row, turned([columns[0][i], columns[1][i]]));
            }
        }
        if !is_near || weight.ends()[1] <= NO_TRUST {
            return None;
        }
        let q = weight.plus(-NO_TRUST).times(1.0 / (FULL_TRUST - NO_TRUST));
        let trust_rate =
            q.clamp(0.0, 1.0).smooth_slope() * q.clamp_slope(0.0, 1.0).times(unit / (FULL_TRUST - NO_TRUST));
        // What is not moved says nothing about the rest of an interval: where it counts, W is at least this, and |o| at most R.
        let scale = weight.larger(S::from(NO_TRUST)).inverse();
        let way = mean.map(|v| -(v * scale).clamp(-1.0, 1.0));
        // ∂o = −(∂V + o ⊗ ∂W)/W.
        let slope = [0, 1].map(|i| [0, 1].map(|j| -((mean_slope[i][j] + way[i] * weight_slope[j]) * scale)));
        let way = way.map(|w| w.times(self.radius()));
        let trust_slope = weight_slope.map(|w| w * trust_rate);
        Some(Offset { way, slope, trust: q.clamp(0.0, 1.0).smooth(), trust_slope })
    }
}

/// The integrals W and V over one part of a route and their derivatives, along it and across.
struct Sums<S> {
    weight: S,
    weight_slope: [S; 2],
    mean: [S; 2],
    mean_slope: [[S; 2]; 2],
}

impl<S: Number> Sums<S> {
    /// For a place `a` along and `b` across a part of length `length`, all in units of R; `None` if it is surely farther than R.
    ///
    /// With τ the way along the part from the place and h² = 1 − b², the weight is K = (h² − τ²)² between τ₀ and τ₁, the ends of the
    /// part or where it is h away. At those K is 0, so they add nothing to the derivatives; the ends of the part do.
    fn of(a: S, b: S, length: f64) -> Option<Self> {
        let one = S::from(1.0);
        let squared = (one - b.square()).larger(S::from(0.0));
        if squared.ends()[1] <= 0.0 {
            return None;
        }
        let h = squared.root();
        let ends = [-a, S::from(length) - a];
        if ends[1].ends()[1] <= -h.ends()[1] || ends[0].ends()[0] >= h.ends()[1] {
            return None;
        }
        let ends = ends.map(|t| t.larger(-h).smaller(h));
        let [low, high] = ends;
        let over = |f: &dyn Fn(S) -> S| f(high) - f(low);
        let rest = |t: S| (squared - t.square()).larger(S::from(0.0));
        let kernel = |t: S| rest(t).square();
        let weight = S::integral(low, high, h, |t, h| t * (h.powi(4) - 2.0 / 3.0 * (h * t).powi(2) + 0.2 * t.powi(4)));
        let first = over(&|t| -(rest(t) * kernel(t)).times(1.0 / 6.0));
        let along = -over(&kernel);
        let across = b.times(-4.0) * S::integral(low, high, h, |t, h| t * (h * h - t * t / 3.0));
        let mean_slope = [[-over(&|t| t * kernel(t)), b * over(&kernel)], [-(b * along), -weight - b * across]];
        Some(Self { weight, weight_slope: [along, across], mean: [first, -(b * weight)], mean_slope })
    }
}
