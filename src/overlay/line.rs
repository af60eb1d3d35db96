//! The ways of context lines: from the border of an overlay to a point, or to the outline of an area.
//!
//! A straight line leaves its overlay at the point of the edge that is nearest to its focus. Therefore, if two lines to overlays of one size cross,
//! changing the places of the two overlays makes the lines shorter: the order of least length has no crossing ([`crate::overlay::order`]).

use glam::DVec2;

use crate::overlay::{
    crossings::{Lattice, STEPS, Way, lattice, pixels},
    lane::Side,
    rect::Rect,
    request::{Focus, LineKind},
};

/// The distance of the beginnings of lines from the corners of an overlay, pixels; a quarter of the edge where that is less.
pub const INSET: i64 = 14;

/// Segments of a curve.
const CURVE_SEGMENTS: i64 = 12;

/// A focus on the lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Where the line heads: the point, or a point in the area.
    pub at: Lattice,
    /// The area's outline, pixels; empty for a point.
    outline: Vec<DVec2>,
}

impl Target {
    /// `None` for what has no finite point. An area's line heads for its centre of gravity, or for the nearest point of its outline where that
    /// lies outside of the area.
    pub fn new(focus: &Focus) -> Option<Self> {
        match focus {
            Focus::Point(place) => Some(Self { at: lattice(*place)?, outline: Vec::new() }),
            Focus::Area(outline) => {
                let outline: Vec<DVec2> = outline.iter().filter_map(|p| lattice(*p)).map(pixels).collect();
                Some(Self { at: lattice(middle_of(&outline)?)?, outline })
            }
        }
    }
}

/// The points of a line in pixels, from its overlay to its focus.
pub fn way(rect: &Rect, side: Side, target: &Target, kind: LineKind) -> Option<Way> {
    let (port, axis) = port(rect, side, target.at)?;
    let end = target.at;
    let bend = |share_num: i64, share_den: i64| {
        let mut point = port;
        point[axis] += (end[axis] - port[axis]) * share_num / share_den;
        point
    };
    let points = match kind {
        LineKind::Straight => vec![port, end],
        LineKind::Orthogonal => vec![port, bend(1, 1), end],
        LineKind::Curved => {
            let control = bend(3, 5);
            let n = CURVE_SEGMENTS;
            let at = |k: i64| {
                [0, 1].map(|i| {
                    let sum = (n - k) * (n - k) * port[i] + 2 * k * (n - k) * control[i] + k * k * end[i];
                    (sum + n * n / 2).div_euclid(n * n)
                })
            };
            (0..=n).map(at).collect()
        }
    };
    Way::new(cut(points, &target.outline))
}

/// The points of a straight line from a place in the picture to a focus, pixels; `None` where there is none.
pub fn straight(from: DVec2, focus: &Focus) -> Option<Vec<DVec2>> {
    let target = Target::new(focus)?;
    let way = Way::new(cut(vec![lattice(from)?, target.at], &target.outline))?;
    Some(way.points().iter().map(|p| pixels(*p)).collect())
}

/// Where a line to `focus` leaves an overlay that stands on `side`, and the axis that it leaves along (0 x, 1 y); `None` if the overlay covers the focus.
///
/// It leaves through the inner edge if the focus is beyond that, otherwise through the edge that the focus is furthest beyond.
fn port(rect: &Rect, side: Side, focus: Lattice) -> Option<(Lattice, usize)> {
    let low = [0, 1].map(|i| i64::from(rect.min[i]) * STEPS);
    let high = [0, 1].map(|i| i64::from(rect.max[i]) * STEPS);
    let beyond = |inner: Side| match inner {
        Side::Left => focus[0] - high[0],
        Side::Right => low[0] - focus[0],
        Side::Top => focus[1] - high[1],
        Side::Bottom => low[1] - focus[1],
    };
    let other = || Side::ALL.into_iter().rev().max_by_key(|s| beyond(*s)).filter(|s| beyond(*s) > 0);
    let edge = if beyond(side) > 0 { side } else { other()? };
    let (axis, along) = (edge.depth_axis(), edge.along_axis());
    let inset = (INSET * STEPS).min((high[along] - low[along]) / 4);
    let mut port = [0; 2];
    port[axis] = if edge.is_first() { high[axis] } else { low[axis] };
    port[along] = focus[along].clamp(low[along] + inset, high[along] - inset);
    Some((port, axis))
}

/// `points` up to where they first meet `outline`; all of them if they do not.
fn cut(points: Vec<Lattice>, outline: &[DVec2]) -> Vec<Lattice> {
    if outline.is_empty() {
        return points;
    }
    for i in 1..points.len() {
        let (from, to) = (pixels(points[i - 1]), pixels(points[i]));
        let along = to - from;
        let first = edges(outline)
            .filter_map(|(a, b)| {
                let edge = b - a;
                let turn = along.perp_dot(edge);
                let t = (a - from).perp_dot(edge) / turn;
                let s = (a - from).perp_dot(along) / turn;
                (turn != 0.0 && (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
            })
            .fold(f64::INFINITY, f64::min);
        if let Some(end) = lattice(from + along * first) {
            return [&points[..i], &[end]].concat();
        }
    }
    points
}

fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    ring.iter().enumerate().map(|(i, a)| (*a, ring[(i + 1) % ring.len()]))
}

/// The centre of gravity of a ring if it lies in it, otherwise the nearest point of the ring to it.
fn middle_of(ring: &[DVec2]) -> Option<DVec2> {
    let base = *ring.first()?;
    let (mut twice_area, mut moment) = (0.0, DVec2::ZERO);
    for (a, b) in edges(ring).map(|(a, b)| (a - base, b - base)) {
        let part = a.perp_dot(b);
        twice_area += part;
        moment += (a + b) * part;
    }
    let mean = ring.iter().sum::<DVec2>() / ring.len() as f64;
    let centre = base + moment / (3.0 * twice_area);
    // A ring without area, or one whose parts cancel.
    let centre = if centre.is_finite() && ring.iter().any(|p| p.distance(mean) * 2.0 >= centre.distance(mean)) {
        centre
    } else {
        mean
    };
    let inside = edges(ring).filter(|(a, b)| (a.y > centre.y) != (b.y > centre.y)).fold(false, |inside, (a, b)| {
        let x = a.x + (b.x - a.x) * (centre.y - a.y) / (b.y - a.y);
        inside != (x > centre.x)
    });
    if inside {
        return Some(centre);
    }
    let nearest = edges(ring).map(|(a, b)| {
        let along = b - a;
        let length = along.length_squared();
        let t = if length > 0.0 { ((centre - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        a + along * t
    });
    nearest.min_by(|p, q| p.distance_squared(centre).total_cmp(&q.distance_squared(centre)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(side: Side, focus: &Focus, kind: LineKind) -> Option<Vec<[f64; 2]>> {
        let rect = Rect::new([10, 100], [100, 80]);
        let way = way(&rect, side, &Target::new(focus)?, kind)?;
        Some(way.points().iter().map(|p| pixels(*p).to_array()).collect())
    }

    fn to(x: f64, y: f64) -> Focus {
        Focus::Point(DVec2::new(x, y))
    }

    #[test]
    fn straight_lines_leave_at_the_nearest_point_of_the_edge() {
        let line = |side, x, y| points(side, &to(x, y), LineKind::Straight);
        assert_eq!(line(Side::Left, 300.0, 150.25), Some(vec![[110.0, 150.25], [300.0, 150.25]]));
        assert_eq!(line(Side::Left, 300.0, 500.0), Some(vec![[110.0, 166.0], [300.0, 500.0]]), "14 from the corner");
        assert_eq!(
            line(Side::Left, 60.0, 500.0),
            Some(vec![[60.0, 180.0], [60.0, 500.0]]),
            "not beyond the inner edge"
        );
        assert_eq!(line(Side::Right, -90.0, 0.0), Some(vec![[10.0, 114.0], [-90.0, 0.0]]));
        assert_eq!(line(Side::Top, 60.0, 300.0), Some(vec![[60.0, 180.0], [60.0, 300.0]]));
        assert_eq!(line(Side::Bottom, 60.0, 0.0), Some(vec![[60.0, 100.0], [60.0, 0.0]]));
        assert_eq!(line(Side::Left, 60.0, 150.0), None, "covered");
        assert_eq!(line(Side::Left, f64::NAN, 150.0), None);
    }

    #[test]
    fn orthogonal_lines_have_one_bend() {
        let line = points(Side::Left, &to(300.0, 500.0), LineKind::Orthogonal);
        assert_eq!(line, Some(vec![[110.0, 166.0], [300.0, 166.0], [300.0, 500.0]]));
        assert_eq!(
            points(Side::Left, &to(300.0, 150.0), LineKind::Orthogonal).map(|l| l.len()),
            Some(2),
            "none where none is needed"
        );
    }

    #[test]
    fn curves_leave_square_and_never_turn_back() {
        for focus in [to(300.0, 500.0), to(115.0, -400.0), to(2000.0, 181.0)] {
            let line = points(Side::Left, &focus, LineKind::Curved).unwrap();
            let (first, last) = (line[0], *line.last().unwrap());
            for i in 0..2 {
                let way = (last[i] - first[i]).signum();
                assert!(line.windows(2).all(|p| (p[1][i] - p[0][i]) * way >= 0.0), "{line:?}");
            }
            // The slope grows from nothing: the first segment is the flattest.
            let slope = |p: &[[f64; 2]]| ((p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).abs();
            assert!(slope(&line[..2]) < 0.25 * slope(&line[line.len() - 2..]), "{line:?}");
        }
    }

    #[test]
    fn lines_to_areas_end_at_the_outline() {
        let square = |x: f64, y: f64, s: f64| {
            Focus::Area(vec![DVec2::new(x, y), DVec2::new(x + s, y), DVec2::new(x + s, y + s), DVec2::new(x, y + s)])
        };
        let line = points(Side::Left, &square(200.0, 100.0, 80.0), LineKind::Straight);
        assert_eq!(line, Some(vec![[110.0, 140.0], [200.0, 140.0]]));
        let line = points(Side::Left, &square(200.0, 300.0, 80.0), LineKind::Orthogonal);
        assert_eq!(line, Some(vec![[110.0, 166.0], [240.0, 166.0], [240.0, 300.0]]));
        assert_eq!(points(Side::Left, &Focus::Area(vec![]), LineKind::Straight), None);
        let flat = Focus::Area(vec![DVec2::new(200.0, 140.0), DVec2::new(300.0, 140.0)]);
        assert_eq!(
            points(Side::Left, &flat, LineKind::Straight),
            Some(vec![[110.0, 140.0], [250.0, 140.0]]),
            "an area without area"
        );
    }

    #[test]
    fn a_line_to_an_area_shaped_like_a_u_ends_at_it() {
        let u = [[200, 100], [300, 100], [300, 110], [210, 110], [210, 170], [300, 170], [300, 180], [200, 180]];
        let outline: Vec<DVec2> = u.iter().map(|p| DVec2::new(f64::from(p[0]), f64::from(p[1]))).collect();
        let line = points(Side::Left, &Focus::Area(outline), LineKind::Straight);
        assert_eq!(line, Some(vec![[110.0, 140.0], [200.0, 140.0]]));
    }
}
