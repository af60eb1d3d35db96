//! Paths through keys: where an eye or a lens is at a time.
//!
//! A place goes along a centripetal Catmull-Rom curve (Yuksel, Schaefer and Keyser 2011): it passes through its keys, has no loops
//! between them, and a direction at each. How far along the curve it is at a time is a matter of its own: a monotone cubic through
//! the keys' times (Steffen 1990), so that it never turns back between two keys and its speed is continuous; or a straight line,
//! which is constant speed. Before the first key everything is as there, after the last one as there.

use glam::DVec3;

use crate::view::camera::{Camera, CameraError, Projection, default_near_m};

/// Pieces that a curve between two keys is measured in.
const PIECES: usize = 32;
/// Nodes and weights of the Gauss-Legendre rule of five points on -1..1.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// The relation of time to the way along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Speed {
    /// Each key at its time, with continuous speed between them.
    #[default]
    Keys,
    /// From the first key's time to the last one's at one speed; the times between say nothing.
    Constant,
}

/// A number over time: a monotone cubic through its keys, no greater and no less than the keys on either side.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Change per second at each key.
    slopes: Vec<f64>,
}

impl Curve {
    /// Through `values` at `times`, seconds, ascending; both of one length, at least one.
    pub fn new(times: &[f64], values: &[f64]) -> Self {
        let n = times.len().min(values.len());
        let step = |i: usize| times[i + 1] - times[i];
        let secant = |i: usize| if step(i) > 0.0 { (values[i + 1] - values[i]) / step(i) } else { 0.0 };
        let slope = |i: usize| {
            if i == 0 || i + 1 == n {
                return match n {
                    0 | 1 => 0.0,
                    _ => secant(i.min(n - 2)),
                };
            }
            let (before, after, h, k) = (secant(i - 1), secant(i), step(i - 1), step(i));
            if before * after <= 0.0 || h <= 0.0 || k <= 0.0 {
                return 0.0;
            }
            let of_parabola = (before * k + after * h) / (h + k);
            before.signum() * (2.0 * before.abs()).min(2.0 * after.abs()).min(of_parabola.abs())
        };
        Self { times: times[..n].to_vec(), values: values[..n].to_vec(), slopes: (0..n).map(slope).collect() }
    }

    /// Its value at a time, seconds.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|t| *t <= time);
        let (Some(i), true) = (after.checked_sub(1), after < self.times.len()) else {
            return self.values.get(after.saturating_sub(1)).copied().unwrap_or(0.0);
        };
        let h = self.times[after] - self.times[i];
        let x = (time - self.times[i]) / h;
        let [low, high] = [self.values[i], self.values[after]];
        let (start, end) = (self.slopes[i] * h, self.slopes[after] * h);
        let cubic = start + end - 2.0 * (high - low);
        let square = 3.0 * (high - low) - 2.0 * start - end;
        (low + x * (start + x * (square + x * cubic))).clamp(low.min(high), low.max(high))
    }
}

/// A place over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    line: Line,
    /// Metres along the path over seconds.
    way: Way,
    /// Seconds at each key.
    times: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
enum Way {
    Keys(Curve),
    Constant { from: f64, to: f64, length: f64 },
}

/// The curve between two keys: a cubic over 0..1.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    /// Coefficients, constant first.
    cubic: [DVec3; 4],
    /// Metres along the path where it begins.
    start: f64,
    /// Metres from there to each 32nd of it.
    lengths: [f64; PIECES + 1],
}

impl Piece {
    fn new(low: DVec3, high: DVec3, [from, to]: [DVec3; 2], start: f64) -> Self {
        let square = 3.0 * (high - low) - 2.0 * from - to;
        let mut piece =
            Self { cubic: [low, from, square, from + to - 2.0 * (high - low)], start, lengths: [0.0; PIECES + 1] };
        let node = |i: usize| i as f64 / PIECES as f64;
        for i in 0..PIECES {
            piece.lengths[i + 1] = piece.lengths[i] + piece.length(node(i), node(i + 1));
        }
        piece
    }

    fn at(&self, x: f64) -> DVec3 {
        let [a, b, c, d] = self.cubic;
        a + x * (b + x * (c + x * d))
    }

    fn speed(&self, x: f64) -> f64 {
        let [_, b, c, d] = self.cubic;
        (b + x * (2.0 * c + x * 3.0 * d)).length()
    }

    /// Where it goes at a parameter, of length 1; on the way to its end where it rests there. `None`: it goes nowhere.
    fn direction(&self, x: f64) -> Option<DVec3> {
        let [_, b, c, d] = self.cubic;
        (b + x * (2.0 * c + x * 3.0 * d)).try_normalize().or_else(|| (b + c + d).try_normalize())
    }

    /// Metres of its part, by quadrature.
    fn length(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        half * GAUSS.iter().map(|(node, weight)| weight * self.speed(middle + half * node)).sum::<f64>()
    }

    fn whole(&self) -> f64 {
        self.lengths[PIECES]
    }

    /// The place so many metres from its beginning.
    fn after(&self, metres: f64) -> DVec3 {
        self.at(self.parameter(metres))
    }

    /// The parameter of that place.
    fn parameter(&self, metres: f64) -> f64 {
        let node = |i: usize| i as f64 / PIECES as f64;
        let i = self.lengths.partition_point(|l| *l <= metres).clamp(1, PIECES) - 1;
        let rest = metres - self.lengths[i];
        // Halved until f64 ends: where the curve turns back on itself its speed is 0, and nothing steeper is safe.
        let from = node(i);
        let (mut low, mut high) = (from, node(i + 1));
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if self.length(from, middle) < rest { low = middle } else { high = middle }
        }
        high
    }
}

/// The form of a line through points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Whether it goes on from the last point to the first.
    pub is_closed: bool,
    /// Whether it is a centripetal Catmull-Rom curve; else straight from point to point.
    pub is_smooth: bool,
}

/// A line through points, by the metres along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    pieces: Vec<Piece>,
    first: DVec3,
    /// Metres along it at each point; of a closed one at last where it is back at the first.
    marks: Vec<f64>,
}

impl Line {
    /// Through `points`, metres, at least one.
    pub fn new(points: &[DVec3], form: Form) -> Self {
        let (pieces, marks) = pieces(points, form);
        Self { pieces, first: points.first().copied().unwrap_or_default(), marks }
    }

    /// Its length, metres.
    pub fn length(&self) -> f64 {
        self.marks.last().copied().unwrap_or(0.0)
    }

    /// Metres along it at each point, from 0; of a closed line at last where it is back at the first.
    pub fn marks(&self) -> &[f64] {
        &self.marks
    }

    /// The place so many metres along it; its ends beyond them.
    pub fn at(&self, metres: f64) -> DVec3 {
        self.piece_at(metres).map_or(self.first, |i| self.pieces[i].after(metres - self.pieces[i].start))
    }

    /// Where it goes from there, of length 1; at a corner and where points are one, where it goes on, and at its end where it came from.
    /// `None`: all its points are one.
    pub fn direction(&self, metres: f64) -> Option<DVec3> {
        let at = self.piece_at(metres).unwrap_or(0);
        let own = self.pieces.get(at)?;
        let onward = self.pieces[at + 1..].iter().find_map(|piece| piece.direction(0.0));
        own.direction(own.parameter(metres - own.start))
            .or(onward)
            .or_else(|| self.pieces[..at].iter().rev().find_map(|piece| piece.direction(1.0)))
    }

    /// Places along it that straight lines may join, with the metres to each: its points, and of a smooth one some between them.
    pub fn vertices(&self) -> Vec<(f64, DVec3)> {
        let mut all = vec![(0.0, self.first)];
        for piece in self.pieces.iter().filter(|piece| piece.whole() > 0.0) {
            let [_, _, square, cubic] = piece.cubic;
            let nodes = if square == DVec3::ZERO && cubic == DVec3::ZERO { PIECES..=PIECES } else { 1..=PIECES };
            let place = |i: usize| (piece.start + piece.lengths[i], piece.at(i as f64 / PIECES as f64));
            all.extend(nodes.map(place));
        }
        all
    }

    /// The last piece that begins there or before.
    fn piece_at(&self, metres: f64) -> Option<usize> {
        self.pieces.partition_point(|piece| piece.start <= metres).checked_sub(1)
    }
}

impl Path {
    /// Through `points`, metres, at `times`, seconds, ascending; both of one length, at least one.
    pub fn new(times: &[f64], points: &[DVec3]) -> Self {
        let line = Line::new(points, CURVE);
        let way = Way::Keys(Curve::new(times, &line.marks));
        Self { line, way, times: times.to_vec() }
    }

    /// Through `points` from the first of `times` to the last at one speed.
    pub fn constant(times: &[f64], points: &[DVec3]) -> Self {
        let line = Line::new(points, CURVE);
        let (from, to) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let length = line.length();
        let time = |(mark, own): (&f64, &f64)| if length > 0.0 { from + (to - from) * mark / length } else { *own };
        let times = line.marks.iter().zip(times).map(time).collect();
        Self { line, way: Way::Constant { from, to, length }, times }
    }

    /// One of both.
    pub fn with_speed(speed: Speed, times: &[f64], points: &[DVec3]) -> Self {
        match speed {
            Speed::Keys => Self::new(times, points),
            Speed::Constant => Self::constant(times, points),
        }
    }

    /// When it is at each key, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Its length, metres.
    pub fn length(&self) -> f64 {
        self.line.length()
    }

    /// Where it is at a time, seconds.
    pub fn at(&self, time: f64) -> DVec3 {
        self.line.at(match &self.way {
            Way::Keys(curve) => curve.at(time),
            Way::Constant { from, to, length } if to > from => length * ((time - from) / (to - from)).clamp(0.0, 1.0),
            Way::Constant { length, .. } => *length,
        })
    }
}

/// An open curve.
const CURVE: Form = Form { is_closed: false, is_smooth: true };

/// The line through points, and the metres along it at each.
fn pieces(points: &[DVec3], form: Form) -> (Vec<Piece>, Vec<f64>) {
    let count = points.len();
    let last = if form.is_closed && count > 1 { count } else { count.saturating_sub(1) };
    let point = |i: usize| points[i % count];
    // Centripetal: knots are apart by the root of the distance.
    let knot = |i: usize| point(i).distance(point(i + 1)).sqrt();
    let secant = |i: usize| (point(i + 1) - point(i)) / knot(i);
    let is_there = |i: usize| knot(i) > 0.0;
    // Which piece is before one and after one.
    let before = |i: usize| if i == 0 && form.is_closed { last.checked_sub(1) } else { i.checked_sub(1) };
    let after = |i: usize| if form.is_closed { Some((i + 1) % last) } else { Some(i + 1).filter(|next| *next < last) };
    let (mut pieces, mut marks) = (Vec::with_capacity(last), vec![0.0]);
    for i in 0..last {
        // Directions per knot; where nothing is beyond, straight on.
        let bent = |before: usize, after: usize| {
            let across = (point(after + 1) - point(before)) / (knot(before) + knot(after));
            (secant(before) - across + secant(after)) * knot(i)
        };
        let straight = point(i + 1) - point(i);
        let ends = match is_there(i) {
            false => [DVec3::ZERO; 2],
            true if !form.is_smooth => [straight; 2],
            true => [
                before(i).filter(|before| is_there(*before)).map_or(straight, |before| bent(before, i)),
                after(i).filter(|after| is_there(*after)).map_or(straight, |after| bent(i, after)),
            ],
        };
        let start = marks[i];
        let mut piece = Piece::new(point(i), point(i + 1), ends, start);
        if !form.is_smooth {
            // To the bit, whatever rounds.
            piece.cubic[2..].fill(DVec3::ZERO);
        }
        marks.push(start + piece.whole());
        pieces.push(piece);
    }
    (pieces, marks)
}

/// A camera at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// Seconds.
    pub at: f64,
    /// Metres.
    pub eye: DVec3,
    /// Metres; differs from `eye`.
    pub target: DVec3,
    /// Reference up.
    pub up: DVec3,
    /// Its projection.
    pub projection: Projection,
}

/// Why keys make no path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// Nothing to go through.
    #[error("has no key; a path goes through one or more")]
    Empty,
    /// Not a time, or not after the one before.
    #[error("key {0}: `at` must be a later time than that of the key before")]
    Time(usize),
    /// A camera that shows nothing.
    #[error("key {0}: {1}")]
    Camera(usize, CameraError),
    /// Half a turn about the view axis has two ways to go.
    #[error("key {0}: `up` is the opposite of that of the key before; a key between them would say which way it turns")]
    OppositeUp(usize),
    /// Perspective and orthographic.
    #[error("key {0}: the projection is another one than before; one path has one projection")]
    Projection(usize),
    /// At constant speed, something that changes while the eye rests.
    #[error(
        "key {0}: the eye is where it was, and at constant speed no time is left for what else changes; move the eye, or take \
         speed = \"keys\""
    )]
    Rests(usize),
}

/// A camera over time.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    eye: Path,
    target: Path,
    up: [Curve; 3],
    last_up: DVec3,
    /// Field of view in radians, or height in metres.
    extent: Curve,
    is_orthographic: bool,
    near_m: Option<f64>,
}

impl CameraPath {
    /// Through `keys`; `near_m`: the near plane, `None` for the default of each moment.
    ///
    /// # Errors
    /// The first key that has no picture, or no way that leads to it.
    pub fn new(keys: &[CameraKey], speed: Speed, near_m: Option<f64>) -> Result<Self, PathError> {
        let first = keys.first().ok_or(PathError::Empty)?;
        let is_flat = |key: &CameraKey| matches!(key.projection, Projection::Orthographic { .. });
        for (i, key) in keys.iter().enumerate() {
            let camera = Camera {
                eye: key.eye,
                target: key.target,
                up: key.up,
                projection: key.projection,
                near_m: near_m.unwrap_or(1.0),
            };
            camera.check().map_err(|error| PathError::Camera(i, error))?;
            let before = i.checked_sub(1).map(|i| keys[i]);
            if !key.at.is_finite() || before.is_some_and(|before| key.at <= before.at) {
                return Err(PathError::Time(i));
            }
            if is_flat(key) != is_flat(first) {
                return Err(PathError::Projection(i));
            }
            let Some(before) = before else { continue };
            let [from, to] = [before.up, key.up].map(|up| up.normalize_or(DVec3::Z));
            if from.dot(to) < -0.999 {
                return Err(PathError::OppositeUp(i));
            }
            let alike = CameraKey { at: key.at, ..before } == *key;
            if speed == Speed::Constant && before.eye == key.eye && !alike {
                return Err(PathError::Rests(i));
            }
        }
        let times: Vec<f64> = keys.iter().map(|key| key.at).collect();
        let eyes: Vec<DVec3> = keys.iter().map(|key| key.eye).collect();
        let eye = Path::with_speed(speed, &times, &eyes);
        let times = eye.times().to_vec();
        let targets: Vec<DVec3> = keys.iter().map(|key| key.target).collect();
        let curve = |value: &dyn Fn(&CameraKey) -> f64| Curve::new(&times, &keys.iter().map(value).collect::<Vec<_>>());
        let up = std::array::from_fn(|axis| curve(&|key| key.up.normalize_or(DVec3::Z)[axis]));
        let extent = curve(&|key| match key.projection {
            Projection::Perspective { fov_y } => fov_y,
            Projection::Orthographic { height_m } => height_m,
        });
        let target = Path::new(&times, &targets);
        let is_orthographic = is_flat(first);
        let last_up = keys.last().map_or(DVec3::Z, |key| key.up);
        Ok(Self { eye, target, up, last_up, extent, is_orthographic, near_m })
    }

    /// The camera at a time, seconds.
    ///
    /// # Errors
    /// Where the eye meets its target on the way.
    pub fn at(&self, time: f64) -> Result<Camera, CameraError> {
        let (eye, target) = (self.eye.at(time), self.target.at(time));
        let up = DVec3::from_array(std::array::from_fn(|axis| self.up[axis].at(time)));
        let extent = self.extent.at(time);
        let camera = Camera {
            eye,
            target,
            up: up.normalize_or(self.last_up),
            projection: match self.is_orthographic {
                true => Projection::Orthographic { height_m: extent },
                false => Projection::Perspective { fov_y: extent },
            },
            near_m: self.near_m.unwrap_or_else(|| default_near_m(eye.distance(target))),
        };
        camera.check().map(|()| camera)
    }

    /// The eye's way, metres.
    pub fn length(&self) -> f64 {
        self.eye.length()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The largest deviation from constant speed, as a share; a millimetre in a national frame is known to 1e-7 of it.
    const SPEED_TOLERANCE: f64 = 1e-3;

    /// Keys in a national frame, some of them at one place.
    fn keys() -> impl Strategy<Value = (Vec<f64>, Vec<DVec3>)> {
        let place = prop_oneof![
            prop::array::uniform3(-500.0..500.0f64),
            prop::sample::select(vec![[0.0; 3], [1.0, 2.0, 3.0], [1e-9, 0.0, 0.0]]),
        ];
        prop::collection::vec((0.01..5.0f64, place), 1..7).prop_map(|keys| {
            let mut time = -1.0;
            let national = DVec3::new(85_000.0, 446_000.0, 0.0);
            let key = |(step, place): (f64, [f64; 3])| {
                time += step;
                (time, national + DVec3::from(place))
            };
            keys.into_iter().map(key).unzip()
        })
    }

    fn looking(at: f64, eye: [f64; 3], target: [f64; 3]) -> CameraKey {
        let projection = Projection::Perspective { fov_y: 0.8 };
        CameraKey { at, eye: eye.into(), target: target.into(), up: DVec3::Z, projection }
    }

    #[test]
    fn between_keys_unequally_apart_a_parabola_is_met() {
        let times = [0.0_f64, 1.0, 3.0, 4.0];
        let curve = Curve::new(&times, &times.map(|t| t * t));
        for i in 0..=200 {
            let t = 1.0 + f64::from(i) / 100.0;
            assert!((curve.at(t) - t * t).abs() < 1e-12, "{t}: {}", curve.at(t));
        }
    }

    #[test]
    fn what_rises_from_key_to_key_rises_everywhere() {
        // A flat piece between two steep ones: a cubic as steep at both its ends as its neighbours allow would fall in its middle.
        for flat in [1.0, 0.1, 1e-3] {
            let curve = Curve::new(&[0.0, 1.0, 2.0, 3.0], &[0.0, 10.0, 10.0 + flat, 20.0 + flat]);
            let values: Vec<f64> = (0..=3000).map(|i| curve.at(f64::from(i) / 1000.0)).collect();
            let least = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
            assert!(least > 0.0, "{flat}: {least}");
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn a_path_passes_through_its_keys((times, points) in keys()) {
            let path = Path::new(&times, &points);
            for (time, point) in times.iter().zip(&points) {
                prop_assert!(path.at(*time).distance(*point) < 1e-6, "{} is not {point}", path.at(*time));
            }
            let constant = Path::constant(&times, &points);
            for (time, point) in constant.times().iter().zip(&points) {
                // Of keys at one place all but the last share their time.
                prop_assert!(constant.at(*time).distance(*point) < 1e-5, "{} is not {point}", constant.at(*time));
            }
        }

        #[test]
        fn a_path_has_no_jump_and_no_nan((times, points) in keys(), share in -0.2..1.2f64) {
            let (from, to) = (times[0], times[times.len() - 1]);
            for path in [Path::new(&times, &points), Path::constant(&times, &points)] {
                let time = from + share * (to - from);
                let step = 1e-7 * (to - from);
                let [a, b] = [path.at(time), path.at(time + step)];
                prop_assert!(a.is_finite() && b.is_finite());
                // Three times the speed of the fastest piece is what a monotone cubic may reach.
                let fastest = times.windows(2).map(|t| path.length() / (t[1] - t[0])).fold(path.length() / (to - from).max(1e-9), f64::max);
                prop_assert!(a.distance(b) <= 3.1 * fastest * step + 1e-8, "{a} to {b}");
            }
        }

        #[test]
        fn constant_speed_is_constant((times, points) in keys(), share in 0.0..1.0f64) {
            let path = Path::constant(&times, &points);
            let (from, to) = (times[0], times[times.len() - 1]);
            prop_assume!(path.length() > 1.0);
            // A millimetre of the way, from 64 places: none is longer, and where it does not turn back none is shorter.
            let step = 1e-3 * (to - from) / path.length();
            let at = |i: u32| from + (f64::from(i) + share) / 65.0 * (to - from);
            let millimetres: Vec<f64> = (0..64).map(|i| 1e3 * path.at(at(i)).distance(path.at(at(i) + step))).collect();
            prop_assert!(millimetres.iter().all(|l| *l < 1.0 + SPEED_TOLERANCE), "{millimetres:?}");
            let right = millimetres.iter().filter(|l| **l > 1.0 - SPEED_TOLERANCE).count();
            prop_assert!(right >= 60, "{millimetres:?}");
        }

        #[test]
        fn a_number_stays_between_its_keys((times, points) in keys(), share in 0.0..1.0f64) {
            let values: Vec<f64> = points.iter().map(|p| p.x).collect();
            let curve = Curve::new(&times, &values);
            for (i, t) in times.windows(2).enumerate() {
                let value = curve.at(t[0] + share * (t[1] - t[0]));
                let (low, high) = (values[i].min(values[i + 1]), values[i].max(values[i + 1]));
                prop_assert!((low..=high).contains(&value), "{value} is not in {low}..{high}");
            }
        }

        #[test]
        fn cameras_are_those_of_their_keys_and_always_have_a_picture((times, eyes) in keys(), (_, targets) in keys(), share in 0.0..1.0f64) {
            let keys: Vec<CameraKey> = times.iter().zip(eyes.iter().zip(&targets)).map(|(&at, (&eye, &target))| {
                CameraKey { at, eye, target, up: DVec3::new(0.1 * at, 0.0, 1.0), projection: Projection::Perspective { fov_y: 0.5 + 0.01 * at } }
            }).collect();
            for speed in [Speed::Keys, Speed::Constant] {
                let Ok(path) = CameraPath::new(&keys, speed, None) else { continue };
                let time = times[0] + share * (times[keys.len() - 1] - times[0]);
                match path.at(time) {
                    Ok(camera) => prop_assert!(camera.basis().is_ok() && camera.eye.is_finite() && camera.up.is_finite()),
                    Err(error) => prop_assert!(matches!(error, CameraError::EyeIsTarget(..)), "{error}"),
                }
            }
            if let Ok(path) = CameraPath::new(&keys, Speed::Keys, None) {
                for key in &keys {
                    let camera = path.at(key.at).unwrap();
                    prop_assert!(camera.eye.distance(key.eye) < 1e-6 && camera.target.distance(key.target) < 1e-6);
                    prop_assert!(camera.projection == key.projection);
                }
            }
        }
    }

    #[test]
    fn two_keys_are_a_straight_line_of_even_speed() {
        let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(5.0, 2.0, -3.0));
        let path = Path::new(&[2.0, 6.0], &[a, b]);
        for (time, share) in [(1.0, 0.0), (2.0, 0.0), (3.0, 0.25), (4.0, 0.5), (6.0, 1.0), (9.0, 1.0)] {
            assert!(path.at(time).distance(a.lerp(b, share)) < 1e-9, "{time}: {}", path.at(time));
        }
    }

    #[test]
    fn keys_on_a_line_stay_on_it_and_speed_has_no_step() {
        let points = [0.0, 1.0, 50.0, 51.0].map(|x| DVec3::new(x, 0.0, 0.0));
        let times = [0.0, 1.0, 2.0, 3.0];
        let path = Path::new(&times, &points);
        let speed = |t: f64| (path.at(t + 1e-5).x - path.at(t).x) / 1e-5;
        for t in [1.0, 2.0] {
            assert!((speed(t - 2e-5) - speed(t + 1e-5)).abs() < 0.05, "{} and {}", speed(t - 2e-5), speed(t + 1e-5));
        }
        for i in 0..300 {
            let at = path.at(f64::from(i) / 100.0);
            assert!(at.y == 0.0 && at.z == 0.0 && path.at(f64::from(i + 1) / 100.0).x >= at.x, "it turned back");
        }
    }

    #[test]
    fn what_has_no_way_is_refused() {
        let new = |keys: &[CameraKey], speed| CameraPath::new(keys, speed, None).map(|_| ());
        let (a, b) = (looking(0.0, [0.0; 3], [9.0, 0.0, 0.0]), looking(1.0, [1.0, 0.0, 0.0], [9.0, 0.0, 0.0]));
        assert_eq!(new(&[], Speed::Keys), Err(PathError::Empty));
        assert_eq!(new(&[a, CameraKey { at: 0.0, ..b }], Speed::Keys), Err(PathError::Time(1)));
        assert_eq!(new(&[a, CameraKey { at: f64::NAN, ..b }], Speed::Keys), Err(PathError::Time(1)));
        let blind = CameraKey { target: b.eye, ..b };
        assert_eq!(new(&[a, blind], Speed::Keys), Err(PathError::Camera(1, CameraError::EyeIsTarget(1.0, 0.0, 0.0))));
        assert_eq!(new(&[a, CameraKey { up: -DVec3::Z, ..b }], Speed::Keys), Err(PathError::OppositeUp(1)));
        let flat = CameraKey { projection: Projection::Orthographic { height_m: 10.0 }, ..b };
        assert_eq!(new(&[a, flat], Speed::Keys), Err(PathError::Projection(1)));
        let turned = CameraKey { eye: a.eye, target: DVec3::Y, ..b };
        assert_eq!(new(&[a, turned], Speed::Keys), Ok(()));
        assert_eq!(new(&[a, turned], Speed::Constant), Err(PathError::Rests(1)));
        // On the way the eye runs over its target.
        let over = CameraKey { eye: DVec3::new(20.0, 0.0, 0.0), ..b };
        let path = CameraPath::new(&[a, over], Speed::Keys, None).unwrap();
        assert_eq!(path.at(9.0 / 20.0), Err(CameraError::EyeIsTarget(9.0, 0.0, 0.0)));
    }
}
