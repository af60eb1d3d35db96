//! How far a deformed edge, or the inside of a triangle, is from what is drawn for it.

use std::cmp::Ordering;

use glam::DVec3;

use crate::geom::deform::{Deformers, Support};

/// Parts in which an edge is looked at: as many as it takes to see all that deforms it, six at least. With more than these it is halved.
const PARTS: usize = 6;
const MOST_PARTS: usize = 64;
/// Where so many see all, and already say that an edge is near enough, no more are looked at to decide about halving.
const FEWEST_PARTS: usize = 3;
/// What the second differences next to a part count for: a kink within it is off by no more than a quarter of both; two of them, by more.
const KINK: f64 = 0.75;
/// What may be between all samples (an edge that cuts a corner of the control), by the tolerance.
const UNSEEN: f64 = 0.1;
/// No edge that meets a support is said to be nearer than this, by the tolerance: one may cut a corner of the control between two samples.
const LEAST_SAID: f64 = 0.25;
/// How far the inside of a triangle may be off, by the tolerance.
const INSIDE: f64 = 2.0;

/// Triangles whose corners are no farther apart, by what samples may be, are not looked into: as many parts are looked at of an edge.
const CLOSE: f64 = PARTS as f64;

/// What decides about halving; the same for all edges.
#[derive(Clone, Copy)]
pub struct Refiner<'a> {
    /// What is bent.
    pub deformers: &'a Deformers,
    /// As of [`super::refined`].
    pub pixels_per_m: &'a (dyn Fn(DVec3) -> f64 + Sync),
    /// An edge is halved if it is farther off, pixels.
    pub tolerance_px: f64,
    /// Edges shorter than this are not halved, metres.
    pub shortest_m: f64,
}

/// How far a deformed edge is from the straight line between its ends, at worst: the distance between the two places that the same part
/// of the way along the edge has. So what slides along itself counts too, and what stands on an edge goes with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Metres; infinite where the edge is too long to see all that deforms it.
    pub metres: f64,
    /// The same in pixels.
    pub pixels: f64,
}

impl Chord {
    const NONE: Self = Self { metres: 0.0, pixels: 0.0 };
    const TOO_LONG: Self = Self { metres: f64::INFINITY, pixels: f64::INFINITY };
}

impl Refiner<'_> {
    /// Whether an edge is to be halved.
    pub fn halves(&self, a: DVec3, b: DVec3) -> bool {
        self.meets(a, b) && self.chord_in(FEWEST_PARTS, a, b).pixels > self.tolerance_px
    }

    /// Whether an edge is too short to be halved; the same from both ends.
    pub fn is_short(&self, a: DVec3, b: DVec3) -> bool {
        let (a, b) = in_order(a, b);
        a.distance(b) < self.shortest_m
    }

    /// The middle of an edge, in the world at rest; the same bits from both ends.
    pub fn middle(a: DVec3, b: DVec3) -> DVec3 {
        0.5 * (a + b)
    }

    /// Where an edge is halved, from one end to the other, both among them: the corners that triangles beside it have on it.
    pub fn halved(&self, a: DVec3, b: DVec3) -> Vec<DVec3> {
        let mut places = vec![a];
        self.halve(a, b, &mut places);
        places
    }

    fn halve(&self, a: DVec3, b: DVec3, places: &mut Vec<DVec3>) {
        if self.is_short(a, b) || !self.halves(a, b) {
            places.push(b);
            return;
        }
        let middle = Self::middle(a, b);
        self.halve(a, middle, places);
        self.halve(middle, b, places);
    }

    /// Whether an edge meets the support of a deformation.
    pub fn meets(&self, a: DVec3, b: DVec3) -> bool {
        let (a, b) = in_order(a, b);
        self.deformers.supports().any(|support| support.range(a, b).is_some())
    }

    /// The predicted chord error of an edge: not less than 1/1.05 of the true one, and as a rule not more than twice as much where
    /// that is near the tolerance.
    ///
    /// Between two samples the deformed edge is at most as far off as the farther of both, and what a kink between them adds, which the
    /// second differences of both show; and a tenth of the tolerance more, for what is between them.
    pub fn chord(&self, a: DVec3, b: DVec3) -> Chord {
        self.chord_in(PARTS, a, b)
    }

    /// The same, where `fewest` parts that see all suffice if they say that the edge is near enough.
    fn chord_in(&self, fewest: usize, a: DVec3, b: DVec3) -> Chord {
        let (a, b) = in_order(a, b);
        let mut trace = Trace::default();
        let start = trace.place(self.deformers, a).0;
        let (end, mut step) = trace.place(self.deformers, b);
        // Beyond the supports nothing moves: it is enough to look at what is in them.
        let ranges = self.deformers.supports().filter_map(|support| support.range(a, b));
        let Some([from, to]) = ranges.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])]) else {
            return Chord::NONE;
        };
        step *= to - from;
        let mut parts = if step <= 1.0 { fewest } else { PARTS };
        loop {
            // A step of ∞ is more than all.
            parts = parts.max(step.ceil().min(1e9) as usize);
            if parts > MOST_PARTS {
                return Chord::TOO_LONG;
            }
            let samples = self.samples(&mut trace, [a, b], [start - a, end - b], [from, to], parts);
            if samples.step <= 1.0 + 1e-9 {
                let chord = samples.chord(self.tolerance_px);
                if parts >= PARTS || chord.pixels <= self.tolerance_px {
                    return chord;
                }
            }
            step = samples.step * parts as f64;
            parts = PARTS.max(parts + 1);
        }
    }

    /// Looks at an edge between two parts of its way, of which the ends go `ways`.
    fn samples(
        &self,
        trace: &mut Trace,
        [a, b]: [DVec3; 2],
        ways: [DVec3; 2],
        [from, to]: [f64; 2],
        parts: usize,
    ) -> Samples {
        let mut samples =
            Samples { off: Vec::with_capacity(parts + 1), scale: Vec::with_capacity(parts + 1), step: 0.0 };
        for i in 0..=parts {
            let t = if i == parts { to } else { from + (to - from) * i as f64 / parts as f64 };
            let rest = a.lerp(b, t);
            let (shown, step) = trace.place(self.deformers, rest);
            if i > 0 {
                samples.step = samples.step.max(step);
            }
            // By ways rather than places: where nothing moves, nothing is off.
            let off = if t == 0.0 || t == 1.0 { DVec3::ZERO } else { (shown - rest) - ways[0].lerp(ways[1], t) };
            samples.off.push(off);
            samples.scale.push((self.pixels_per_m)(shown));
        }
        samples
    }

    /// Where the inside of a triangle is off by more than twice the tolerance, as weights of its corners; `None`: nowhere.
    pub(super) fn worst_inside(&self, corners: &[DVec3; 3]) -> Option<DVec3> {
        let mut trace = Trace::default();
        let steps = [0, 1, 2, 0].map(|i| trace.place(self.deformers, corners[i]).1);
        // Then edges see all that there is.
        if steps.into_iter().fold(0.0, f64::max) <= CLOSE {
            return None;
        }
        let ways = corners.map(|p| self.deformers.value(p) - p);
        let mut worst = Worst { pixels: INSIDE * self.tolerance_px, weights: None };
        for support in self.deformers.supports() {
            // Only what the support has of it can be off, as a fan of triangles.
            let part = support.part_of_triangle(corners);
            for pair in part.windows(2).skip(1) {
                self.look_inside(corners, &ways, [part[0], pair[0], pair[1]], &mut worst);
            }
        }
        worst.weights
    }

    /// Looks at a piece of a triangle whose corners go `ways`.
    fn look_inside(&self, corners: &[DVec3; 3], ways: &[DVec3; 3], piece: [DVec3; 3], worst: &mut Worst) {
        let mut trace = Trace::default();
        let [a, b, c] = piece;
        let steps = [a, b, c, a].map(|p| trace.place(self.deformers, p).1);
        let step = steps.into_iter().fold(0.0, f64::max);
        if step <= CLOSE {
            return;
        }
        let is_large = step > MOST_PARTS as f64;
        let parts = if is_large { 3 } else { step.ceil() as usize };
        let mixed = |of: &[DVec3; 3], w: DVec3| of[0] * w.x + of[1] * w.y + of[2] * w.z;
        for i in 1..parts {
            for j in 1..parts - i {
                let rest = mixed(&piece, DVec3::new(i as f64, j as f64, (parts - i - j) as f64) / parts as f64);
                let Some(weights) = weights(corners, rest) else { continue };
                let shown = self.deformers.value(rest);
                let off = (shown - rest).distance(mixed(ways, weights));
                // What is too large to see all in it is as bad as can be.
                let pixels = if is_large { f64::MAX } else { off * (self.pixels_per_m)(shown) };
                if pixels > worst.pixels {
                    *worst = Worst { pixels, weights: Some(weights) };
                }
            }
        }
    }

    /// Whether a triangle meets the support of a deformation.
    pub(super) fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        self.deformers.supports().any(|support| support.meets_triangle(corners))
    }
}

/// The place in a triangle that is off by most.
struct Worst {
    /// By how much, or what it must be off by to count.
    pixels: f64,
    /// Where: weights of the corners; `None` so far.
    weights: Option<DVec3>,
}

/// The places of one sample before each operator, to see how far the next one is.
#[derive(Default)]
struct Trace {
    last: Vec<DVec3>,
}

impl Trace {
    /// Where a place is shown, and how far its steps are from those of the last one asked for, by what they may be.
    fn place(&mut self, deformers: &Deformers, place: DVec3) -> (DVec3, f64) {
        let (mut i, mut step) = (0, 0.0_f64);
        let shown = deformers.traced(place, &mut |p, spacing| {
            match self.last.get_mut(i) {
                Some(last) => {
                    // Numbers that are none are left out of it.
                    step = step.max(2.0 * ((p - *last).abs() / spacing).max_element());
                    *last = p;
                }
                None => self.last.push(p),
            }
            i += 1;
        });
        (shown, step)
    }
}

/// How far off an edge is at equal parts of it.
struct Samples {
    off: Vec<DVec3>,
    /// Pixels per metre there.
    scale: Vec<f64>,
    /// The longest way between two samples, by what it may be.
    step: f64,
}

impl Samples {
    /// With something for what no sample sees.
    fn chord(&self, tolerance_px: f64) -> Chord {
        let (unseen_px, least_px) = (UNSEEN * tolerance_px, LEAST_SAID * tolerance_px);
        let bend = |i: usize| match (i.checked_sub(1).map(|i| self.off[i]), self.off.get(i + 1)) {
            (Some(before), Some(after)) => (before + *after - 2.0 * self.off[i]).length(),
            _ => 0.0,
        };
        let mut worst = Chord::NONE;
        for i in 0..self.off.len() - 1 {
            let off = self.off[i].length().max(self.off[i + 1].length());
            let metres = off + KINK * (bend(i) + bend(i + 1));
            let scale = self.scale[i].max(self.scale[i + 1]);
            worst.metres = worst.metres.max(metres + unseen_px / scale).max(least_px / scale);
            worst.pixels = worst.pixels.max(metres * scale + unseen_px).max(least_px);
        }
        worst
    }
}

impl Support {
    /// Whether a triangle of the world meets it; it does if one of its edges does.
    pub fn meets_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = *corners;
        // An edge's ends are taken in their order: whoever asks about it gets the same answer.
        let meets = |a, b| {
            let (a, b) = in_order(a, b);
            self.range(a, b).is_some()
        };
        meets(a, b) || meets(b, c) || meets(c, a) || !self.part_of_triangle(corners).is_empty()
    }

    /// From which to which part of the way a segment is in it; `None`: nowhere.
    fn range(&self, a: DVec3, b: DVec3) -> Option<[f64; 2]> {
        let (a, b) = (self.frame.from_world(a), self.frame.from_world(b));
        let way = (b - a).to_array();
        let (from, low, high) = (a.to_array(), self.bounds.min.to_array(), self.bounds.max.to_array());
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for i in 0..3 {
            if way[i] == 0.0 {
                if from[i] < low[i] || from[i] > high[i] {
                    return None;
                }
                continue;
            }
            let [t0, t1] = [(low[i] - from[i]) / way[i], (high[i] - from[i]) / way[i]];
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
        // An end that is in it is so whatever rounding says.
        let [enter, leave] = [if self.holds(a) { 0.0 } else { enter }, if self.holds(b) { 1.0 } else { leave }];
        match enter <= leave {
            true => Some([enter, leave]),
            false => (self.holds(a) || self.holds(b)).then_some([0.0, 1.0]),
        }
    }

    /// What it has of a triangle of the world, as a convex polygon of the world.
    fn part_of_triangle(&self, corners: &[DVec3; 3]) -> Vec<DVec3> {
        let local = corners.map(|p| self.frame.from_world(p));
        let (low, high) = (local[0].min(local[1]).min(local[2]), local[0].max(local[1]).max(local[2]));
        if self.bounds.is_empty() || low.cmpgt(self.bounds.max).any() || high.cmplt(self.bounds.min).any() {
            return Vec::new();
        }
        let sides = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| {
            [(axis, axis.dot(self.bounds.max.min(high))), (-axis, -axis.dot(self.bounds.min.max(low)))]
        });
        crate::geom::triangle::clipped(&local, sides).into_iter().map(|p| self.frame.to_world(p)).collect()
    }
}

/// What the corners of a triangle count for at a place inside it; `None` on its border.
fn weights([a, b, c]: &[DVec3; 3], place: DVec3) -> Option<DVec3> {
    let normal = (*b - *a).cross(*c - *a);
    let area = |p: &DVec3, q: &DVec3| (*p - place).cross(*q - place).dot(normal);
    let areas = DVec3::new(area(b, c), area(c, a), area(a, b));
    let weights = areas / areas.element_sum();
    (weights.is_finite() && weights.min_element() > 1e-9).then_some(weights)
}

/// Both ends of an edge, in the order of their coordinates.
fn in_order(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    if order(a, b) == Ordering::Greater { (b, a) } else { (a, b) }
}

/// The order of places: by x, then y, then z.
pub fn order(a: DVec3, b: DVec3) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}
