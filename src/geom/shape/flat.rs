//! Flat lenses (Ropinski & Hinrichs §6): a figure in a plane, and all that an eye sees through it.
//!
//! ```text
//!                  │ figure
//!        before it │          ___--- inside: the sight line came through the figure,
//!  eye ·-----------┿--------·'       from the plane (which belongs to it) to infinity
//!                  │ ‾‾‾--- behind nothing: there is no exit
//! ```
//!
//! Which side of the plane the eye is on does not matter: what is inside lies beyond the plane, seen from the eye. An eye in the
//! plane, and parallel sight lines along it, see the figure edge on: it holds nothing then.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::geom::{
    ray::Ray,
    shape::{error::ShapeError, limits::MAX_CORNERS},
};

/// Half the edge of the box around what has no end, metres: beyond everything, and a number.
pub const ENDLESS_M: f64 = 1e30;

/// Below this sine of the angle between the plane and the sight lines (in perspective: the one to the figure's middle) a figure
/// is seen edge on: about 1e-7 degrees, a thousandth of a pixel of the narrowest view.
const EDGE_ON: f64 = 1e-9;

/// A figure in its own x, y plane, around (0, 0); closed.
#[derive(Clone, Debug, PartialEq)]
pub enum FlatFigure {
    /// A disc.
    Disc {
        /// Metres, ≥ 0.
        radius: f64,
    },
    /// A rectangle.
    Rectangle {
        /// Full edges along x and y, metres, ≥ 0.
        size: DVec2,
    },
    /// A polygon, convex or not, either way round; where it crosses itself, all that it goes around is in it.
    Polygon {
        /// At least three, at most [`MAX_CORNERS`]; metres.
        points: Vec<DVec2>,
    },
}

/// The lines along which an eye sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sightlines {
    /// From a point: perspective.
    From(DVec3),
    /// Parallel, of this direction, of any length but 0: orthographic.
    Along(DVec3),
}

/// What an eye sees through a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// The figure's origin, metres.
    pub(super) center: DVec3,
    /// Turns its axes into the world's; its z is the plane's normal.
    pub(super) rotation: DQuat,
    /// Its figure.
    figure: FlatFigure,
    /// The eye.
    pub(super) sight: Sightlines,
}

impl FlatFigure {
    /// Refuses numbers that are none, negative lengths, too few and too many points.
    pub(super) fn check(&self) -> Result<(), ShapeError> {
        let lengths: [(&str, f64); 2] = match self {
            Self::Disc { radius } => [("radius", *radius); 2],
            Self::Rectangle { size } => [("size", size.x), ("size", size.y)],
            Self::Polygon { points } => {
                return match points.len() {
                    n if n > MAX_CORNERS => Err(ShapeError::ManyCorners(n)),
                    n if n < 3 => Err(ShapeError::FewCorners(n)),
                    _ if !points.iter().all(|p| p.is_finite()) => Err(ShapeError::NotFinite),
                    _ => Ok(()),
                };
            }
        };
        match lengths.into_iter().find(|(_, l)| !l.is_finite() || *l < 0.0) {
            Some((name, length)) if length.is_finite() => Err(ShapeError::Negative(name, length)),
            Some(_) => Err(ShapeError::NotFinite),
            None => Ok(()),
        }
    }

    /// Whether it has no area: it holds nothing then.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Disc { radius } => *radius <= 0.0,
            Self::Rectangle { size } => size.min_element() <= 0.0,
            Self::Polygon { points } => {
                let from = points.first().copied().unwrap_or_default();
                let far = points.iter().map(|p| *p - from).max_by(|a, b| a.length().total_cmp(&b.length()));
                let far = far.unwrap_or_default();
                points.iter().all(|p| far.perp_dot(*p - from) == 0.0)
            }
        }
    }

    /// Its corners, in order; none of a disc.
    pub fn corners(&self) -> Vec<DVec2> {
        match self {
            Self::Disc { .. } => Vec::new(),
            Self::Rectangle { size } => {
                [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|c| DVec2::from(c) * *size).to_vec()
            }
            Self::Polygon { points } => points.clone(),
        }
    }

    /// The box around it: least and greatest x and y.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        match self {
            Self::Disc { radius } => (DVec2::splat(-radius), DVec2::splat(*radius)),
            _ => self
                .corners()
                .into_iter()
                .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p))),
        }
    }

    /// Distance to its border, metres, negative in it.
    pub fn signed_distance(&self, p: DVec2) -> f64 {
        match self {
            Self::Disc { radius } => p.length() - radius,
            Self::Rectangle { size } => {
                let q = p.abs() - 0.5 * *size;
                q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Polygon { points } => {
                let distance = edges(points).map(|[a, b]| to_segment(p, a, b)).fold(f64::INFINITY, f64::min);
                if winding(points, p) == 0 { distance } else { -distance }
            }
        }
    }

    /// Whether it holds `p`.
    pub fn holds(&self, p: DVec2) -> bool {
        self.signed_distance(p) <= 0.0
    }

    /// Whether it shares a point with a convex polygon, which may be a point or a segment.
    fn meets(&self, polygon: &[DVec2]) -> bool {
        if polygon.iter().any(|p| self.holds(*p)) {
            return true;
        }
        if let Self::Disc { radius } = self {
            return winding(polygon, DVec2::ZERO) != 0
                || edges(polygon).any(|[a, b]| to_segment(DVec2::ZERO, a, b) <= *radius);
        }
        let own = self.corners();
        own.first().is_some_and(|p| winding(polygon, *p) != 0)
            || edges(&own).any(|e| edges(polygon).any(|other| segments_meet(e, other)))
    }
}

/// The sides of a polygon.
fn edges(points: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> {
    (0..points.len()).map(|i| [points[i], points[(i + 1) % points.len()]])
}

/// How often a polygon goes around a point that is not on its border. Twin: `is_in_polygon` in `shape/flat.wgsl`.
fn winding(points: &[DVec2], p: DVec2) -> i32 {
    let crossing = |[a, b]: [DVec2; 2]| {
        let side = (b - a).perp_dot(p - a);
        match (a.y <= p.y, b.y <= p.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    edges(points).map(crossing).sum()
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + t * along)
}

fn segments_meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let (p, q, r, s) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    if p == 0.0 && q == 0.0 {
        // On one line: their boxes decide.
        return a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    }
    !apart(p, q) && !apart(r, s)
}

impl Flat {
    /// What an eye sees through a figure that passed its check.
    pub(super) fn new(center: DVec3, rotation: DQuat, figure: FlatFigure, sight: Sightlines) -> Self {
        Self { center, rotation, figure, sight }
    }

    /// The figure's axes; the third is the plane's normal.
    pub fn axes(&self) -> DMat3 {
        DMat3::from_quat(self.rotation)
    }

    /// The figure's origin, metres.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The figure.
    pub fn figure(&self) -> &FlatFigure {
        &self.figure
    }

    /// The corners of the box around the figure, metres.
    pub fn corners_of_bounds(&self) -> [DVec3; 4] {
        let (low, high) = self.figure.bounds();
        [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|p| self.at(p))
    }

    /// Which way sight lines cross the plane: 1 with its normal, -1 against it, 0 where they see it edge on.
    pub fn side(&self) -> f64 {
        let normal = self.axes().z_axis;
        let (along, length) = match self.sight {
            Sightlines::From(eye) => ((self.center - eye).dot(normal), self.center.distance(eye)),
            Sightlines::Along(direction) => (direction.dot(normal), direction.length()),
        };
        if along.abs() > EDGE_ON * length { along.signum() } else { 0.0 }
    }

    /// Whether it holds nothing: its figure has no area, or is seen edge on.
    pub(super) fn holds_nothing(&self) -> bool {
        self.figure.is_empty() || self.side() == 0.0
    }

    fn at(&self, p: DVec2) -> DVec3 {
        self.center + self.rotation * p.extend(0.0)
    }

    /// Where the sight line to `p` crosses the plane, in the figure's coordinates, if it does so before `p` or there.
    fn crossing(&self, p: DVec3) -> Option<DVec2> {
        let back = self.rotation.conjugate();
        let own = back * (p - self.center);
        let side = self.side();
        if side == 0.0 || own.z * side < 0.0 {
            return None;
        }
        let crossed = match self.sight {
            Sightlines::Along(direction) => {
                let direction = back * direction;
                own - own.z / direction.z * direction
            }
            Sightlines::From(eye) => {
                let eye = back * (eye - self.center);
                own + own.z / (own.z - eye.z) * (eye - own)
            }
        };
        Some(crossed.truncate())
    }

    /// Whether it holds `p`.
    pub(super) fn holds(&self, p: DVec3) -> bool {
        !self.figure.is_empty() && self.crossing(p).is_some_and(|q| self.figure.holds(q))
    }

    /// Where one of the eye's sight lines is in it, and no other ray.
    pub(super) fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        if self.holds_nothing() {
            return None;
        }
        let back = self.rotation.conjugate();
        let (o, d) = (back * (ray.origin - self.center), back * ray.direction);
        let entry = -o.z / d.z;
        // It crosses in the eyes' direction, and in perspective in front of the eye.
        let is_met = d.z * self.side() > 0.0 && (entry > 0.0 || matches!(self.sight, Sightlines::Along(_)));
        (is_met && self.figure.holds((o + entry * d).truncate())).then_some((entry, f64::INFINITY))
    }

    /// Whether a triangle shares a point with it: what is beyond the plane, seen in the plane, against the figure.
    pub(super) fn meets(&self, corners: &[DVec3; 3]) -> bool {
        let normal = self.side() * self.axes().z_axis;
        let height = |p: DVec3| normal.dot(p - self.center);
        let mut seen = Vec::with_capacity(4);
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            let (hp, hq) = (height(p), height(q));
            seen.extend(self.crossing(p).filter(|_| hp >= 0.0));
            if (hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0) {
                // In the plane itself: it is seen where it is.
                let on = p + hp / (hp - hq) * (q - p);
                seen.push((self.rotation.conjugate() * (on - self.center)).truncate());
            }
        }
        !seen.is_empty() && self.figure.meets(&seen)
    }

    /// Distance to the figure and to the sides that its border throws away from the eye, negative inside; to 1e-9 of the
    /// figure's size for a disc, exact else.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        let own = self.rotation.conjugate() * (p - self.center);
        let to_figure = own.z.hypot(self.figure.signed_distance(own.truncate()).max(0.0));
        let to_sides = match &self.figure {
            FlatFigure::Disc { radius } => self.to_round_side(p, *radius),
            _ => {
                let corners = self.figure.corners();
                edges(&corners).map(|e| self.to_side(p, e.map(|c| self.at(c)))).fold(f64::INFINITY, f64::min)
            }
        };
        let distance = to_figure.min(to_sides);
        if self.holds(p) { -distance } else { distance.max(f64::MIN_POSITIVE) }
    }

    /// Away from the eye, from a point of the figure; of any length but 0.
    fn away(&self, from: DVec3) -> DVec3 {
        match self.sight {
            Sightlines::From(eye) => from - eye,
            Sightlines::Along(direction) => direction,
        }
    }

    /// To the sight line that leaves the figure at a point.
    fn to_line(&self, p: DVec3, from: DVec3) -> f64 {
        let away = self.away(from);
        p.distance(from + ((p - from).dot(away) / away.length_squared()).max(0.0) * away)
    }

    /// To the side behind an edge.
    fn to_side(&self, p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
        let along = b - a;
        let t = if along == DVec3::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        let border = p.distance(a + t * along).min(self.to_line(p, a)).min(self.to_line(p, b));
        let Some(normal) = along.cross(self.away(a)).try_normalize() else { return border };
        // Of the foot: its share along the edge, and how far beyond it.
        let foot = p - normal.dot(p - a) * normal;
        let own = self.rotation.conjugate() * (foot - self.center);
        let (from, to) = [a, b].map(|c| (self.rotation.conjugate() * (c - self.center)).truncate()).into();
        let is_over = self.crossing(self.center + self.rotation * own).is_some_and(|q| {
            let t = (q - from).dot(to - from) / (to - from).length_squared();
            (0.0..=1.0).contains(&t)
        });
        if is_over { normal.dot(p - a).abs() } else { border }
    }

    /// To the side behind a circle: the nearest of its sight lines, among many and then between their neighbours.
    fn to_round_side(&self, p: DVec3, radius: f64) -> f64 {
        const STEPS: u32 = 128;
        let distance = |angle: f64| self.to_line(p, self.at(radius * DVec2::from_angle(angle)));
        let step = std::f64::consts::TAU / f64::from(STEPS);
        let all: Vec<f64> = (0..STEPS).map(|i| distance(f64::from(i) * step)).collect();
        let least = |i: usize| all[i] <= all[(i + 1) % all.len()] && all[i] <= all[(i + all.len() - 1) % all.len()];
        let refined = |i: usize| {
            let (mut low, mut high) = ((i as f64 - 1.0) * step, (i as f64 + 1.0) * step);
            for _ in 0..80 {
                let third = (high - low) / 3.0;
                if distance(low + third) < distance(high - third) { high -= third } else { low += third }
            }
            distance(0.5 * (low + high))
        };
        (0..all.len()).filter(|i| least(*i)).map(refined).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests;
