//! Objects between an eye and what it looks at, decided exactly.
//!
//! ```text
//!   eye ─────╲───────────┌───┐      the shaft: all sight lines from the eye to the base, without the base itself
//!             ╲▔▔▔▔▔▔▔▔▔▔│   │      base: the faces of a box that the eye sees, a triangle, a segment
//!              ╲_________└───┘
//! ```
//!
//! A triangle and a shaft are convex, so they share a point before the base if and only if an extreme point of what they share
//! lies before it: a corner of the triangle, a place where an edge of the triangle crosses a side of the shaft, a place where an
//! edge of the shaft pierces the triangle, or the eye. None of these places is worked out: each question about them is the sign of
//! a determinant of corners as they are given (`orient2d`, `orient3d`), which is exact for all f64 that neither overflow nor
//! underflow in it. All bodies are closed; what only touches the base from behind or beside is not before it.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

use crate::geom::aabb::Aabb;

/// The sight lines from an eye to an axis-aligned box, up to where they enter it. Where the eye is in the box, there are none.
#[derive(Clone, Debug)]
pub struct BoxShaft {
    eye: DVec3,
    /// Box around the eye and the base, metres.
    around: Aabb,
    /// Those that the eye sees, at most three.
    faces: Vec<Face>,
}

/// A face of the box that the eye is before: u and v are the two axes along it.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Across it, u and v.
    axes: [usize; 3],
    /// Where it is on its axis, metres.
    plane: f64,
    /// 1 where it lies towards larger coordinates from the eye, else -1.
    toward: f64,
    /// Low and high end on u, low and high end on v, metres.
    ends: [f64; 4],
}

/// The sight lines from an eye to a triangle, without the triangle. Seen edge-on it hides behind nothing: there are none.
#[derive(Clone, Copy, Debug)]
pub struct TriangleShaft {
    eye: DVec3,
    corners: [DVec3; 3],
    /// Sign of the eye's side of the triangle.
    eye_side: f64,
    /// Sign of the inner side of its three sides.
    inner: f64,
    around: Aabb,
}

/// The sight lines from an eye to a segment, without the segment.
#[derive(Clone, Copy, Debug)]
pub struct SegmentShaft {
    eye: DVec3,
    ends: [DVec3; 2],
    around: Aabb,
}

impl BoxShaft {
    /// The shaft from `eye` to a box that is not empty; flat boxes and points are boxes too.
    pub fn new(eye: DVec3, bounds: &Aabb) -> Self {
        let mut faces = Vec::new();
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            let ends = [bounds.min[u], bounds.max[u], bounds.min[v], bounds.max[v]];
            let axes = [axis, u, v];
            if eye[axis] < bounds.min[axis] {
                faces.push(Face { axes, plane: bounds.min[axis], toward: 1.0, ends });
            } else if eye[axis] > bounds.max[axis] {
                faces.push(Face { axes, plane: bounds.max[axis], toward: -1.0, ends });
            }
        }
        Self { eye, around: bounds.grown(eye), faces }
    }

    /// Whether a closed triangle has a point on a sight line before the box.
    pub fn meets(&self, triangle: &[DVec3; 3]) -> bool {
        self.faces.iter().any(|face| face.meets(self.eye, triangle))
    }

    /// Whether a box may: `false` is certain, also if the box is smaller than meant by what f64 loses in a change of origin.
    pub fn may_meet(&self, bounds: &Aabb) -> bool {
        let bounds = padded(bounds);
        self.around.meets(&bounds) && self.faces.iter().any(|face| face.may_meet(self.eye, &bounds))
    }
}

impl Face {
    /// Side `j` in the plane of its two axes: the eye and the end that it runs through.
    fn line(&self, j: usize, eye: DVec3) -> [Coord<f64>; 2] {
        let across = self.axes[1 + j / 2];
        [plan(eye, self.axes[0], across), Coord { x: self.plane, y: self.ends[j] }]
    }

    /// On which side of side `j` a point is: > 0 within, 0 on it.
    fn side(&self, j: usize, eye: DVec3, p: DVec3) -> f64 {
        let [a, b] = self.line(j, eye);
        let side = robust::orient2d(a, b, plan(p, self.axes[0], self.axes[1 + j / 2])) * self.toward;
        if j.is_multiple_of(2) { side } else { -side }
    }

    /// The two ends of its edge at side `j`.
    fn edge(&self, j: usize) -> [DVec3; 2] {
        let other = if j < 2 { [2, 3] } else { [0, 1] };
        other.map(|k| if j < 2 { self.corner(j, k) } else { self.corner(k, j) })
    }

    fn corner(&self, u_end: usize, v_end: usize) -> DVec3 {
        let mut corner = DVec3::ZERO;
        corner[self.axes[0]] = self.plane;
        corner[self.axes[1]] = self.ends[u_end];
        corner[self.axes[2]] = self.ends[v_end];
        corner
    }

    fn is_before(&self, p: DVec3) -> bool {
        let (p, plane) = (p[self.axes[0]], self.plane);
        if self.toward > 0.0 { p < plane } else { p > plane }
    }

    fn is_ahead(&self, eye: DVec3, p: DVec3) -> bool {
        let (p, eye) = (p[self.axes[0]], eye[self.axes[0]]);
        if self.toward > 0.0 { p >= eye } else { p <= eye }
    }

    fn meets(&self, eye: DVec3, t: &[DVec3; 3]) -> bool {
        let before = t.map(|p| self.is_before(p));
        let ahead = t.map(|p| self.is_ahead(eye, p));
        if before == [false; 3] || ahead == [false; 3] {
            return false;
        }
        let mut sides = [[0.0; 3]; 4];
        for (j, side) in sides.iter_mut().enumerate() {
            *side = t.map(|p| self.side(j, eye, p));
            if side.iter().all(|s| *s < 0.0) {
                return false;
            }
        }
        let holds = |i: usize| before[i] && ahead[i] && sides.iter().all(|side| side[i] >= 0.0);
        if (0..3).any(holds) || in_triangle(eye, t) {
            return true;
        }
        let crosses = |j: usize, i: usize| {
            let k = (i + 1) % 3;
            if !are_opposite(sides[j][i], sides[j][k]) {
                return false;
            }
            // In the plane of the side's axes the side is a line: the edge crosses it from the eye on, and before the base.
            let ([from, to], across) = (self.line(j, eye), self.axes[1 + j / 2]);
            let [q, r] = [t[i], t[k]].map(|p| plan(p, self.axes[0], across));
            let [near, far] = [robust::orient2d(q, r, from), robust::orient2d(q, r, to)];
            let is_between = near == 0.0 || are_opposite(near, far);
            let [a, b] = self.edge(j).map(|end| orient(t[i], t[k], eye, end));
            far != 0.0 && is_between && !are_alike(a, b)
        };
        (0..4).any(|j| (0..3).any(|i| crosses(j, i)))
            || [(0, 2), (0, 3), (1, 2), (1, 3)].into_iter().any(|(u, v)| pierces(eye, self.corner(u, v), t))
    }

    /// Whether a box may reach the part of the shaft before this face.
    fn may_meet(&self, eye: DVec3, bounds: &Aabb) -> bool {
        let axis = self.axes[0];
        let (nearest, farthest) = if self.toward > 0.0 { (bounds.min, bounds.max) } else { (bounds.max, bounds.min) };
        if !self.is_before(nearest) || !self.is_ahead(eye, farthest) {
            return false;
        }
        (0..4).all(|j| {
            let across = self.axes[1 + j / 2];
            let out = if j == 0 || j == 2 { self.toward } else { -self.toward };
            let [along, over] = [self.plane - eye[axis], self.ends[j] - eye[across]];
            // along · (p_across − eye) − over · (p_axis − eye), at the corner where it is largest.
            let most = |factor: f64, k: usize| {
                let at = if factor >= 0.0 { bounds.max[k] } else { bounds.min[k] };
                factor * (at - eye[k])
            };
            let [a, b] = [most(along * out, across), most(-over * out, axis)];
            a + b >= -PAD * (a.abs() + b.abs())
        })
    }
}

impl TriangleShaft {
    /// The shaft from `eye` to a triangle; `None` where the eye is in its plane, or it has no area.
    pub fn new(eye: DVec3, corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let eye_side = orient(a, b, c, eye);
        let inner = orient(eye, a, b, c);
        (eye_side != 0.0).then(|| Self { eye, corners, eye_side, inner, around: Aabb::from_points([eye, a, b, c]) })
    }

    /// Whether a closed triangle has a point on a sight line before this one.
    pub fn meets(&self, t: &[DVec3; 3]) -> bool {
        if !self.around.meets(&Aabb::from_points(*t)) {
            return false;
        }
        let [a, b, c] = self.corners;
        let before = t.map(|p| are_alike(orient(a, b, c, p), self.eye_side));
        if before == [false; 3] {
            return false;
        }
        let mut sides = [[0.0; 3]; 3];
        for (j, side) in sides.iter_mut().enumerate() {
            *side = t.map(|p| orient(self.eye, self.corners[j], self.corners[(j + 1) % 3], p));
            if side.iter().all(|s| are_opposite(*s, self.inner)) {
                return false;
            }
        }
        let is_within = |i: usize| sides.iter().all(|side| !are_opposite(side[i], self.inner));
        let crosses = |j: usize, i: usize| {
            are_opposite(sides[j][i], sides[j][(i + 1) % 3])
                && crosses([t[i], t[(i + 1) % 3]], self.eye, [self.corners[j], self.corners[(j + 1) % 3]])
        };
        (0..3).any(|i| before[i] && is_within(i))
            || in_triangle(self.eye, t)
            || (0..3).any(|j| (0..3).any(|i| crosses(j, i)))
            || self.corners.iter().any(|corner| pierces(self.eye, *corner, t))
    }
}

impl SegmentShaft {
    /// The shaft from `eye` to the segment between two points.
    pub fn new(eye: DVec3, ends: [DVec3; 2]) -> Self {
        let [a, b] = ends;
        let ends = match are_in_line(eye, a, b) {
            true if in_triangle(eye, &[a, b, b]) => [eye; 2],
            // Seen along itself it is its near end.
            true => [if eye.distance_squared(a) < eye.distance_squared(b) { a } else { b }; 2],
            false => ends,
        };
        Self { eye, ends, around: Aabb::from_points([eye, ends[0], ends[1]]) }
    }

    /// Whether a closed triangle has a point on a sight line before the segment. One in the plane of the eye and the segment is
    /// seen edge-on: it counts where a corner of it does, or where it holds the eye.
    pub fn meets(&self, t: &[DVec3; 3]) -> bool {
        if !self.around.meets(&Aabb::from_points(*t)) {
            return false;
        }
        let Self { eye, ends: [a, b], .. } = *self;
        let is_between = |p: DVec3| in_triangle(p, &[eye, a, b]) && !in_triangle(p, &[a, b, b]);
        let sides = t.map(|p| orient(eye, a, b, p));
        let is_crossed = |i: usize| {
            let k = (i + 1) % 3;
            are_opposite(sides[i], sides[k]) && crosses([t[i], t[k]], eye, [a, b])
        };
        t.iter().any(|p| is_between(*p))
            || in_triangle(eye, t)
            || (0..3).any(is_crossed)
            || [a, b].into_iter().any(|end| pierces(eye, end, t))
    }

    /// Whether a box may; `false` is certain.
    pub fn may_meet(&self, bounds: &Aabb) -> bool {
        let bounds = padded(bounds);
        let Self { eye, ends: [a, b], around } = *self;
        // By the plane of the three points.
        let normal = (a - eye).cross(b - eye);
        let reach = normal.abs().dot(0.5 * bounds.size());
        let distance = normal.dot(bounds.center() - eye);
        let lost = normal.length() * PAD * (eye.abs().max_element() + bounds.center().abs().max_element());
        let scale = PAD * (a - eye).length() * (b - eye).length() * (bounds.center() - eye).length();
        around.meets(&bounds) && distance.abs() <= reach + lost + scale
    }
}

/// Relative error of a few sums and products of f64, amply.
const PAD: f64 = 256.0 * f64::EPSILON;

/// A box with room for what its coordinates lost in a change of origin.
fn padded(bounds: &Aabb) -> Aabb {
    let pad = PAD * bounds.min.abs().max(bounds.max.abs()).max_element();
    Aabb { min: bounds.min - pad, max: bounds.max + pad }
}

fn plan(p: DVec3, x: usize, y: usize) -> Coord<f64> {
    Coord { x: p[x], y: p[y] }
}

/// Sign of the volume that three points span from a fourth.
fn orient(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    robust::orient3d(a, b, c, d)
}

fn are_opposite(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

fn are_alike(a: f64, b: f64) -> bool {
    (a < 0.0 && b < 0.0) || (a > 0.0 && b > 0.0)
}

/// Whether an edge that crosses the plane of the eye and two points does so in their triangle, and not on the line of the two.
fn crosses([q, r]: [DVec3; 2], eye: DVec3, [a, b]: [DVec3; 2]) -> bool {
    let base = orient(q, r, a, b);
    let fits = |side: f64| side == 0.0 || are_alike(side, base);
    base != 0.0 && fits(orient(q, r, eye, a)) && fits(orient(q, r, b, eye))
}

/// Whether the way from the eye to `end` goes through a triangle that it does not lie along, before `end` and after the eye.
fn pierces(eye: DVec3, end: DVec3, t: &[DVec3; 3]) -> bool {
    if !are_opposite(orient(t[0], t[1], t[2], eye), orient(t[0], t[1], t[2], end)) {
        return false;
    }
    let turns = [0, 1, 2].map(|i| orient(eye, end, t[i], t[(i + 1) % 3]));
    !(turns.iter().any(|s| *s < 0.0) && turns.iter().any(|s| *s > 0.0))
}

/// Whether a point is in a closed triangle, also one without area: seen along each axis it is.
fn in_triangle(p: DVec3, t: &[DVec3; 3]) -> bool {
    let around = Aabb::from_points(*t);
    let is_near = p.cmpge(around.min).all() && p.cmple(around.max).all();
    is_near && orient(t[0], t[1], t[2], p) == 0.0 && (0..3).all(|axis| in_shadow(p, t, axis))
}

/// The same in plan along an axis; `p` is in the box around the triangle.
fn in_shadow(p: DVec3, t: &[DVec3; 3], axis: usize) -> bool {
    let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
    let [a, b, c] = t.map(|corner| plan(corner, x, y));
    let p = plan(p, x, y);
    let turns = [robust::orient2d(a, b, p), robust::orient2d(b, c, p), robust::orient2d(c, a, p)];
    !(turns.iter().any(|s| *s < 0.0) && turns.iter().any(|s| *s > 0.0))
}

fn are_in_line(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| {
        let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
        robust::orient2d(plan(a, x, y), plan(b, x, y), plan(c, x, y)) == 0.0
    })
}

/// Whether the closed segment between two points meets a closed box; exact: no plane of an axis, and none through the segment and
/// along an axis, is between them.
pub fn segment_meets_box([from, to]: [DVec3; 2], bounds: &Aabb) -> bool {
    if bounds.is_empty() || !Aabb::from_points([from, to]).meets(bounds) {
        return false;
    }
    (0..3).all(|axis| {
        let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
        let (a, b) = (plan(from, x, y), plan(to, x, y));
        let ends = [bounds.min, bounds.max].map(|p| DVec2::new(p[x], p[y]));
        let corners = [0, 1, 2, 3].map(|i: usize| Coord { x: ends[i & 1].x, y: ends[i >> 1].y });
        let sides = corners.map(|corner| robust::orient2d(a, b, corner));
        !(sides.iter().all(|s| *s < 0.0) || sides.iter().all(|s| *s > 0.0))
    })
}

#[cfg(test)]
mod tests;
