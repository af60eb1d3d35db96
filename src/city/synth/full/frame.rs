//! Frames in which houses stand, and strips of ground along the sides of a block.
//!
//! A frame has two whole vectors at right angles, about a quarter of a metre long. Whatever is built of whole multiples of them
//! has whole corners, right angles and parallel edges: its roofs are exactly planar in whatever direction its street runs.

use crate::city::synth::full::field::P2;

/// The length of a step of frames, millimetres; each frame's own is within 1 mm of it.
pub const STEP: i64 = 250;

/// Lengths of so many millimetres in steps, rounded down.
pub const fn steps(millimetres: i64) -> i64 {
    millimetres / STEP
}

/// A place and two steps from it: along, and to the left of that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Its origin, millimetres.
    pub origin: P2,
    /// A step along, millimetres.
    pub u: P2,
    /// A step to the left, millimetres.
    pub v: P2,
}

impl Frame {
    /// The frame at `a` that looks at `b`.
    pub fn towards(a: P2, b: P2) -> Self {
        let [x, y] = [b[0] - a[0], b[1] - a[1]].map(|d| d as f64);
        let length = (x * x + y * y).sqrt();
        let step = |d: f64| (d * STEP as f64 / length).round() as i64;
        let u = [step(x), step(y)];
        Self { origin: a, u, v: [-u[1], u[0]] }
    }

    /// The place `x` steps along and `y` to the left.
    pub fn at(&self, x: i64, y: i64) -> P2 {
        [self.origin[0] + x * self.u[0] + y * self.v[0], self.origin[1] + x * self.u[1] + y * self.v[1]]
    }

    /// The same directions from another place of it.
    pub fn moved(&self, x: i64, y: i64) -> Self {
        Self { origin: self.at(x, y), ..*self }
    }

    /// The corners of a rectangle of its, counter-clockwise.
    pub fn rectangle(&self, [x0, y0]: P2, [x1, y1]: P2) -> [P2; 4] {
        [self.at(x0, y0), self.at(x1, y0), self.at(x1, y1), self.at(x0, y1)]
    }
}

/// All places on one side of a line: those whose product with `normal` is `least` or more.
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: P2,
    least: i64,
}

fn dot(a: P2, b: P2) -> i64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A rectangle of ground along a side of a block, for houses wall to wall.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    /// Origin at the left end of the side, seen from the street; y leads away from it.
    pub frame: Frame,
    /// Where it begins along the side, steps.
    pub from: i64,
    /// Where it ends, steps.
    pub to: i64,
    /// How far it is from the street, steps.
    pub front: i64,
    /// How deep it is, steps.
    pub depth: i64,
}

impl Strip {
    /// The longest strip along side `side` of a block (corners counter-clockwise) that keeps within it and behind none of `others`.
    pub fn along(block: &[P2; 4], side: usize, front: i64, depth: i64, others: &[Self]) -> Option<Self> {
        let frame = Frame::towards(block[side], block[(side + 1) % 4]);
        let edges = (0..4).map(|i| {
            let (a, b) = (block[i], block[(i + 1) % 4]);
            let normal = [a[1] - b[1], b[0] - a[0]];
            Side { normal, least: dot(normal, a) }
        });
        // Behind the backs of the others.
        let backs = others.iter().map(|other| {
            let normal = other.frame.v;
            Side { normal, least: dot(normal, other.frame.at(0, other.front + other.depth)) }
        });
        let (mut from, mut to) = (i64::MIN, i64::MAX);
        for Side { normal, least } in edges.chain(backs) {
            let rate = dot(normal, frame.u);
            let room = [front, front + depth].map(|y| dot(normal, frame.at(0, y)) - least);
            let room = room[0].min(room[1]);
            match rate {
                0 if room < 0 => return None,
                0 => {}
                1.. => from = from.max(-room.div_euclid(rate)),
                _ => to = to.min(room.div_euclid(-rate)),
            }
        }
        (from < to).then_some(Self { frame, from, to, front, depth })
    }

    /// Its length, steps.
    pub fn length(&self) -> i64 {
        self.to - self.from
    }

    /// The frame of a house that begins `along` steps after its beginning and stands `back` from its front.
    pub fn house(&self, along: i64, back: i64) -> Frame {
        self.frame.moved(self.from + along, self.front + back)
    }
}

/// The largest rectangle of ground in a block, as a strip along its longest side.
pub fn yard(block: &[P2; 4], margin: i64) -> Option<Strip> {
    let side = longest_side(block);
    let opposite = Frame::towards(block[side], block[(side + 1) % 4]);
    let reach = |corner: P2| {
        let away = [corner[0] - opposite.origin[0], corner[1] - opposite.origin[1]];
        dot(away, opposite.v) / dot(opposite.v, opposite.v)
    };
    let depth = reach(block[(side + 2) % 4]).min(reach(block[(side + 3) % 4])) - 2 * margin;
    let strip = Strip::along(block, side, margin, depth.max(1), &[])?;
    let inner = Strip { from: strip.from + margin, to: strip.to - margin, ..strip };
    (depth > 0 && inner.from < inner.to).then_some(inner)
}

/// The longest side of a block.
pub fn longest_side(block: &[P2; 4]) -> usize {
    let length = |i: usize| {
        let (a, b) = (block[i], block[(i + 1) % 4]);
        let d = [b[0] - a[0], b[1] - a[1]];
        dot(d, d)
    };
    (0..4).max_by_key(|i| (length(*i), 4 - i)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_stay_in_their_block_and_apart() {
        let block = [[0, 0], [90_000, 14_000], [80_000, 75_000], [-12_000, 60_000]];
        let mut strips: Vec<Strip> = Vec::new();
        for side in [0, 2, 1, 3] {
            strips.push(Strip::along(&block, side, 2, 44, &strips).unwrap());
        }
        let corners = |s: &Strip| s.frame.rectangle([s.from, s.front], [s.to, s.front + s.depth]);
        for (i, strip) in strips.iter().enumerate() {
            assert!(strip.length() > 80, "{strip:?}");
            for corner in corners(strip) {
                for k in 0..4 {
                    let (a, b) = (block[k], block[(k + 1) % 4]);
                    assert!(dot([a[1] - b[1], b[0] - a[0]], [corner[0] - a[0], corner[1] - a[1]]) >= 0);
                }
                for other in &strips[..i] {
                    let back = other.frame.at(0, other.front + other.depth);
                    assert!(dot(other.frame.v, [corner[0] - back[0], corner[1] - back[1]]) >= 0);
                }
            }
            // One step more would not do.
            let longer = Strip { to: strip.to + 1, ..*strip };
            let is_inside = |corner: P2| {
                (0..4).all(|k| {
                    let (a, b) = (block[k], block[(k + 1) % 4]);
                    dot([a[1] - b[1], b[0] - a[0]], [corner[0] - a[0], corner[1] - a[1]]) >= 0
                }) && strips[..i].iter().all(|other| {
                    let back = other.frame.at(0, other.front + other.depth);
                    dot(other.frame.v, [corner[0] - back[0], corner[1] - back[1]]) >= 0
                })
            };
            assert!(!corners(&longer).into_iter().all(is_inside), "side of strip {i}");
        }
    }

    #[test]
    fn no_strip_where_there_is_no_room() {
        let block = [[0, 0], [20_000, 0], [20_000, 9_000], [0, 9_000]];
        assert!(Strip::along(&block, 0, 2, 44, &[]).is_none());
        assert!(yard(&block, 8).is_some_and(|y| y.depth == 20));
    }
}
