//! Whether lines cross, exactly: lines are polylines on a lattice of 1/256 pixel, and predicates are of integers.
//!
//! Two lines cross when they share any point, touching included. One thing is no crossing: two lines that end at the same focus and meet nowhere else.
//! A line crosses an overlay when it shares any point with its rectangle, border included.

use glam::DVec2;

use crate::overlay::rect::Rect;

/// Lattice steps per pixel.
pub const STEPS: i64 = 256;

/// The largest coordinate of a line's point, pixels; what is further away is drawn there.
pub const FURTHEST: f64 = (1 << 20) as f64;

/// A point on the lattice.
pub type Lattice = [i64; 2];

/// The nearest lattice point to a place, pixels; `None` if that is not finite.
pub fn lattice(place: DVec2) -> Option<Lattice> {
    let step = |x: f64| (x.clamp(-FURTHEST, FURTHEST) * STEPS as f64).round() as i64;
    place.is_finite().then(|| [step(place.x), step(place.y)])
}

/// The place of a lattice point, pixels; exact.
pub fn pixels(point: Lattice) -> DVec2 {
    DVec2::new(point[0] as f64, point[1] as f64) / STEPS as f64
}

/// A line's points on the lattice, from its overlay to its focus; neighbours differ, and there are two at least.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    points: Vec<Lattice>,
    low: Lattice,
    high: Lattice,
}

impl Way {
    /// Makes a way of points that may repeat; `None` if all are one.
    pub fn new(mut points: Vec<Lattice>) -> Option<Self> {
        points.dedup();
        let (first, rest) = points.split_first()?;
        if rest.is_empty() {
            return None;
        }
        let corner = |pick: fn(i64, i64) -> i64| rest.iter().fold(*first, |a, b| [pick(a[0], b[0]), pick(a[1], b[1])]);
        let (low, high) = (corner(i64::min), corner(i64::max));
        Some(Self { points, low, high })
    }

    /// Its points, from the overlay to the focus.
    pub fn points(&self) -> &[Lattice] {
        &self.points
    }

    /// Its length, lattice steps.
    pub fn length(&self) -> f64 {
        self.points
            .windows(2)
            .map(|p| (p[1][0] - p[0][0]) as f64)
            .zip(self.points.windows(2).map(|p| (p[1][1] - p[0][1]) as f64))
            .map(|(x, y)| x.hypot(y))
            .sum()
    }

    /// The way without its last `length` pixels; `None` if nothing is left.
    pub fn shortened(&self, length: f64) -> Option<Self> {
        let mut left = length * STEPS as f64;
        let mut points = self.points.clone();
        while let [.., before, end] = points[..] {
            let along = DVec2::new((end[0] - before[0]) as f64, (end[1] - before[1]) as f64);
            let long = along.length();
            if long > left {
                let kept = along * (1.0 - left / long);
                *points.last_mut()? = [before[0] + kept.x.round() as i64, before[1] + kept.y.round() as i64];
                return Self::new(points);
            }
            left -= long;
            points.pop();
        }
        None
    }

    /// Whether it crosses another.
    pub fn crosses(&self, other: &Self) -> bool {
        if (0..2).any(|i| self.high[i] < other.low[i] || other.high[i] < self.low[i]) {
            return false;
        }
        let (last, other_last) = (self.points.len() - 2, other.points.len() - 2);
        self.points.windows(2).enumerate().filter(|(_, p)| other.is_near(p)).any(|(i, p)| {
            let mut others = other.points.windows(2).enumerate();
            others.any(|(j, q)| segments_cross([p[0], p[1]], [q[0], q[1]], i == last && j == other_last))
        })
    }

    /// Whether the box around it touches that around a segment.
    fn is_near(&self, segment: &[Lattice]) -> bool {
        let (p, q) = (segment[0], segment[1]);
        (0..2).all(|i| p[i].min(q[i]) <= self.high[i] && self.low[i] <= p[i].max(q[i]))
    }

    /// Whether it crosses the rectangle of an overlay.
    pub fn crosses_overlay(&self, rect: &Rect) -> bool {
        let [low, high] = on_lattice(rect);
        if (0..2).any(|i| self.high[i] < low[i] || high[i] < self.low[i]) {
            return false;
        }
        self.points.windows(2).any(|p| segment_passes([p[0], p[1]], rect))
    }
}

/// Whether two segments of lines cross; `are_last`: both are the last ones of their lines.
#[inline]
pub fn segments_cross(p: [Lattice; 2], q: [Lattice; 2], are_last: bool) -> bool {
    if are_last && p[1] == q[1] {
        // Both end here: they share more than the end only where one lies along the other.
        let focus = p[1];
        let along = |a: Lattice| [a[0] - focus[0], a[1] - focus[1]];
        return orient(p[0], focus, q[0]) == 0 && dot(along(p[0]), along(q[0])) > 0;
    }
    segments_meet(p[0], p[1], q[0], q[1])
}

/// Whether a segment of a line crosses the rectangle of an overlay.
#[inline]
pub fn segment_passes([p, q]: [Lattice; 2], rect: &Rect) -> bool {
    let [low, high] = on_lattice(rect);
    // Two convex shapes are apart if an edge's normal parts them: x, y, or that of the segment.
    let apart = |i: usize| p[i].max(q[i]) < low[i] || high[i] < p[i].min(q[i]);
    if apart(0) || apart(1) {
        return false;
    }
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let sides = corners.map(|c| orient(p, q, c).signum());
    !(sides.iter().all(|s| *s > 0) || sides.iter().all(|s| *s < 0))
}

/// The corners of a rectangle, lattice steps.
pub fn on_lattice(rect: &Rect) -> [Lattice; 2] {
    [rect.min, rect.max].map(|corner| corner.map(|v| i64::from(v) * STEPS))
}

/// The crossings between two overlays and their lines: pairs of lines, and lines over the other's rectangle.
pub fn between(rect: &Rect, ways: &[Way], other_rect: &Rect, other_ways: &[Way]) -> u32 {
    let lines = ways.iter().map(|a| other_ways.iter().filter(|b| a.crosses(b)).count()).sum::<usize>();
    let over = ways.iter().filter(|a| a.crosses_overlay(other_rect)).count();
    let under = other_ways.iter().filter(|b| b.crosses_overlay(rect)).count();
    (lines + over + under) as u32
}

/// Twice the signed area of a triangle. Coordinates are at most [`FURTHEST`] · [`STEPS`] = 2²⁸, so that products stay below 2⁵⁹: exact.
#[inline]
fn orient(a: Lattice, b: Lattice, c: Lattice) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The scalar product; as exact.
fn dot(u: Lattice, v: Lattice) -> i64 {
    u[0] * v[0] + u[1] * v[1]
}

/// Whether the closed segments `a b` and `c d` share any point.
#[inline]
fn segments_meet(a: Lattice, b: Lattice, c: Lattice, d: Lattice) -> bool {
    let apart = |i: usize| (a[i].max(b[i]) < c[i].min(d[i])) | (c[i].max(d[i]) < a[i].min(b[i]));
    if apart(0) | apart(1) {
        return false;
    }
    let sides = |p, q, r, s| orient(p, q, r).signum() * orient(p, q, s).signum();
    // Collinear segments whose boxes meet do meet; for all others both tests must straddle or touch: both are made, as which
    // one of them decides could not be foretold.
    (sides(a, b, c, d) <= 0) & (sides(c, d, a, b) <= 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(points: &[[i64; 2]]) -> Way {
        Way::new(points.iter().map(|p| [p[0] * STEPS, p[1] * STEPS]).collect()).unwrap()
    }

    #[test]
    fn lines_cross_where_they_share_a_point() {
        let a = way(&[[0, 0], [10, 10]]);
        assert!(a.crosses(&way(&[[0, 10], [10, 0]])), "an X");
        assert!(a.crosses(&way(&[[0, 10], [5, 5]])), "a T at a focus");
        assert!(a.crosses(&way(&[[5, 5], [5, 20]])), "a T at a start");
        assert!(!a.crosses(&way(&[[0, 1], [9, 10]])), "side by side");
        assert!(a.crosses(&way(&[[20, 0], [20, 5], [0, 5]])), "in the second segment");
    }

    #[test]
    fn lines_that_meet_in_their_focus_alone_do_not_cross() {
        let a = way(&[[0, 0], [10, 10]]);
        assert!(!a.crosses(&way(&[[0, 10], [10, 10]])));
        assert!(!a.crosses(&way(&[[20, 20], [10, 10]])), "from the other side");
        assert!(a.crosses(&way(&[[5, 5], [10, 10]])), "along each other");
        assert!(a.crosses(&way(&[[0, 10], [10, 0], [10, 10]])), "in the focus, and before");
        assert!(a.crosses(&way(&[[10, 10], [20, 10]])), "the focus of one, the start of the other");
    }

    #[test]
    fn a_line_crosses_an_overlay_border_included() {
        let rect = Rect::new([10, 10], [10, 10]);
        for (points, crosses) in [
            ([[0, 0], [30, 30]], true),
            ([[0, 12], [12, 0]], false),
            ([[0, 20], [20, 0]], true),
            ([[0, 25], [25, 25]], false),
            ([[12, 12], [15, 15]], true),
            ([[0, 20], [30, 20]], true),
            ([[20, 0], [20, 9]], false),
        ] {
            assert_eq!(way(&points).crosses_overlay(&rect), crosses, "{points:?}");
        }
    }

    #[test]
    fn a_way_is_shortened_from_its_focus() {
        let a = way(&[[0, 0], [10, 0], [10, 10]]);
        assert_eq!(a.shortened(4.0), Some(way(&[[0, 0], [10, 0], [10, 6]])));
        assert_eq!(a.shortened(10.0), Some(way(&[[0, 0], [10, 0]])));
        assert_eq!(a.shortened(13.0), Some(way(&[[0, 0], [7, 0]])));
        assert_eq!(a.shortened(20.0), None);
        assert_eq!(a.length(), 20.0 * STEPS as f64);
    }

    #[test]
    fn places_become_lattice_points() {
        assert_eq!(lattice(DVec2::new(1.5, -0.001)), Some([384, 0]));
        assert_eq!(lattice(DVec2::new(f64::NAN, 0.0)), None);
        assert_eq!(lattice(DVec2::new(1e300, 0.0)).map(pixels), Some(DVec2::new(FURTHEST, 0.0)));
        assert!(Way::new(vec![[1, 1], [1, 1]]).is_none() && Way::new(vec![]).is_none());
    }
}
