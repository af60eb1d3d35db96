//! The way of a point of something that moves by a timetable, and when it is nearest to a place of a picture: what a hand that drags it means.
//!
//! Of several places of the way at which it is nearer than just before and just after, the one counts that costs least: the distance there and,
//! less, how far along the way it is from where the point is now, both in the picture. So a way that crosses itself is not left for the other
//! branch, and one that goes round is not gone round again, as long as the pointer goes along.

use glam::{DVec2, DVec3};

use crate::{city::timetable::Keyframes, time::Moment};

/// A corner of a way, which is straight between two, and gone at one speed there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// When the point is there.
    pub at: Moment,
    /// Where that is, metres.
    pub place: DVec3,
}

/// The share of what it takes to go along the way, of what it takes to be beside it.
const ALONG: f64 = 0.25;
/// How far something turns on a straight piece of the way of its points, radians: an arc is off by 1/6,500 of its radius.
const TURN: f64 = 0.035;
/// Pieces of a turn at most.
const MOST_PIECES: f64 = 4096.0;
/// The least weight of what is before the eye: a millimetre of depth.
const LEAST_WEIGHT: f64 = 1e-3;
/// What is shorter in a picture is no way, pixels.
const LEAST_LENGTH: f64 = 1e-9;

/// The way of a point of an object, which is there in the object's file.
pub fn way_of(keyframes: &Keyframes, point: DVec3) -> Vec<Stop> {
    let stop = |at: Moment, place: DVec3| Stop { at, place };
    let mut way = Vec::with_capacity(keyframes.keys.len());
    for (i, key) in keyframes.keys.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| &keyframes.keys[i]).filter(|before| before.at < key.at);
        if let Some(before) = before {
            let pieces = ((key.yaw - before.yaw).abs() / TURN).ceil().clamp(1.0, MOST_PIECES) as i64;
            let between = (1..pieces).filter_map(|piece| {
                let gone = i128::from(key.at - before.at) * i128::from(piece) / i128::from(pieces);
                Moment::from_micros(before.at.micros() + gone as i64)
            });
            way.extend(between.map(|at| stop(at, keyframes.pose(Some(at)).place(point))));
        }
        way.push(stop(key.at, keyframes.pose_of(key).place(point)));
    }
    way
}

/// The moment at which a point is nearest to a place of a picture on its way, as it is meant by a hand that holds it at `now`. `shown`: x and y in
/// the picture times a weight, and the weight, linear in a place; more than 0 before the eye. `None`: nothing of the way is before it.
pub fn nearest(way: &[Stop], now: Moment, pointer: DVec2, shown: &dyn Fn(DVec3) -> DVec3) -> Option<Moment> {
    let (first, last) = (way.first()?, way.last()?);
    let now = now.clamp(first.at, last.at);
    let next = way.partition_point(|stop| stop.at <= now);
    let here = match way.get(next) {
        Some(after) if next > 0 => between(&way[next - 1], after, now),
        Some(after) => *after,
        None => *last,
    };
    let search = Search { pointer, shown };
    let mut best = None;
    let on = search.walk(std::iter::once(here).chain(way[next..].iter().copied()), &mut best);
    let back = search.walk(std::iter::once(here).chain(way[..next].iter().rev().copied()), &mut best);
    // Where it is is a place like the others, unless it is nearer on one side.
    if !on
        && !back
        && let Some(off) = search.distance(here.place)
    {
        search.take(&mut best, &Foot { off, gone: 0.0, at: now });
    }
    best.map(|found| found.at)
}

/// The stop that would be one at a moment between two.
fn between(before: &Stop, after: &Stop, at: Moment) -> Stop {
    let share = (at - before.at) as f64 / (after.at - before.at) as f64;
    Stop { at, place: before.place + share * (after.place - before.place) }
}

struct Search<'a> {
    pointer: DVec2,
    shown: &'a dyn Fn(DVec3) -> DVec3,
}

/// The place of a piece of way that is nearest to the pointer.
struct Foot {
    /// From there to the pointer, pixels.
    off: f64,
    /// From where the point is now to there, along the way, pixels.
    gone: f64,
    at: Moment,
}

struct Found {
    cost: f64,
    at: Moment,
}

impl Search<'_> {
    /// Goes along stops and takes each place that is nearer than those just before and after it, until what is farther away costs more; whether
    /// it comes nearer at first.
    fn walk(&self, stops: impl Iterator<Item = Stop>, best: &mut Option<Found>) -> bool {
        let mut before: Option<Stop> = None;
        let (mut gone, mut off) = (0.0, None);
        let mut lowest: Option<Foot> = None;
        let mut descends = None;
        for stop in stops {
            let Some(from) = before.replace(stop) else {
                off = self.distance(stop.place);
                continue;
            };
            let Some((foot, length)) = self.foot(&from, &stop, gone) else {
                // What goes behind the eye, or is elsewhere at once, ends a way.
                if let Some(foot) = lowest.take() {
                    self.take(best, &foot);
                }
                off = None;
                continue;
            };
            if length < LEAST_LENGTH {
                continue;
            }
            gone += length;
            let comes_nearer = off.is_none_or(|off| foot.off < off);
            descends.get_or_insert(comes_nearer);
            off = Some(foot.off);
            if comes_nearer {
                lowest = Some(foot);
            } else if let Some(foot) = lowest.take() {
                self.take(best, &foot);
            }
            if lowest.is_none() && best.as_ref().is_some_and(|best| (ALONG * gone).powi(2) > best.cost) {
                break;
            }
        }
        if let Some(foot) = lowest {
            self.take(best, &foot);
        }
        descends.unwrap_or(false)
    }

    fn take(&self, best: &mut Option<Found>, foot: &Foot) {
        let cost = foot.off.powi(2) + (ALONG * foot.gone).powi(2);
        if best.as_ref().is_none_or(|best| cost < best.cost) {
            *best = Some(Found { cost, at: foot.at });
        }
    }

    /// From a place to the pointer, pixels; `None`: it is not before the eye.
    fn distance(&self, place: DVec3) -> Option<f64> {
        let shown = (self.shown)(place);
        (shown.z >= LEAST_WEIGHT).then(|| (shown.truncate() / shown.z).distance(self.pointer))
    }

    /// The place of a piece that is nearest to the pointer, and how long what is before the eye of the piece is in the picture, pixels.
    fn foot(&self, from: &Stop, to: &Stop, gone: f64) -> Option<(Foot, f64)> {
        if from.at == to.at {
            return None;
        }
        let [mut a, mut b] = [from.place, to.place].map(self.shown);
        let (mut begin, mut end) = (0.0, 1.0);
        match (a.z >= LEAST_WEIGHT, b.z >= LEAST_WEIGHT) {
            (true, true) => {}
            (false, false) => return None,
            (is_before, _) => {
                let share = (LEAST_WEIGHT - a.z) / (b.z - a.z);
                let cut = a + share * (b - a);
                if is_before { (b, end) = (cut, share) } else { (a, begin) = (cut, share) }
            }
        }
        let [start, stop] = [a, b].map(|own| own.truncate() / own.z);
        let along = stop - start;
        let share = match along.length_squared() {
            0.0 => 0.0,
            square => ((self.pointer - start).dot(along) / square).clamp(0.0, 1.0),
        };
        let foot = start + share * along;
        // What is nearer takes more of the picture: weights bring a share of the picture to a share of the way.
        let of_way = share * a.z / ((1.0 - share) * b.z + share * a.z);
        let of_way = begin + of_way * (end - begin);
        let micros = from.at.micros() + ((to.at - from.at) as f64 * of_way).round() as i64;
        let at = Moment::from_micros(micros).unwrap_or(from.at);
        let foot = Foot { off: foot.distance(self.pointer), gone: gone + share * along.length(), at };
        Some((foot, along.length()))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::{
        city::timetable::Keyframe,
        time::{SECOND, Span},
    };

    fn second(at: f64) -> Moment {
        let start = Moment::of_year(2025).expect("a year");
        start.shifted(Span::of_micros((at * SECOND as f64).round() as i64))
    }

    fn way(stops: &[(f64, [f64; 3])]) -> Vec<Stop> {
        stops.iter().map(|(at, place)| Stop { at: second(*at), place: DVec3::from(*place) }).collect()
    }

    /// From above: a metre is a pixel.
    fn plan(place: DVec3) -> DVec3 {
        DVec3::new(place.x, place.y, 1.0)
    }

    fn seconds(found: Option<Moment>) -> f64 {
        (found.expect("a moment") - second(0.0)) as f64 / SECOND as f64
    }

    fn drag(way: &[Stop], now: f64, pointer: [f64; 2]) -> f64 {
        seconds(nearest(way, second(now), pointer.into(), &plan))
    }

    #[test]
    fn on_a_straight_way_it_is_at_the_foot_of_the_pointer() {
        let way = way(&[(0.0, [0.0; 3]), (10.0, [100.0, 0.0, 0.0]), (30.0, [200.0, 0.0, 0.0])]);
        for now in [-5.0, 0.0, 4.0, 10.0, 29.0, 99.0] {
            for (pointer, at) in [
                ([25.0, 8.0], 2.5),
                ([100.0, -3.0], 10.0),
                ([150.0, 40.0], 20.0),
                ([-9.0, 1.0], 0.0),
                ([400.0, 0.0], 30.0),
            ] {
                assert!((drag(&way, now, pointer) - at).abs() < 2e-6, "{pointer:?} from {now}");
            }
        }
    }

    #[test]
    fn in_perspective_it_is_at_the_foot_too() {
        // Away from the eye: what is shown of (x, y, z) is (x/z, y/z).
        let shown = |place: DVec3| place;
        let way = way(&[(0.0, [0.0, 1.0, 1.0]), (9.0, [9.0, 1.0, 10.0])]);
        // At t it is shown at (t/(1+t), 1/(1+t)), on the line x + y = 1.
        for t in [0.5, 1.0, 2.0, 6.5] {
            let on = DVec2::new(t / (1.0 + t), 1.0 / (1.0 + t));
            for aside in [0.0, 0.2] {
                let found = nearest(&way, second(0.1), on + aside * DVec2::ONE, &shown);
                assert!((seconds(found) - t).abs() < 2e-6, "{t}");
            }
        }
        // What is behind the eye is not there; the way goes on before it.
        let through = super::tests::way(&[(0.0, [0.0, 1.0, -4.0]), (8.0, [0.0, 1.0, 4.0])]);
        assert!((seconds(nearest(&through, second(1.0), DVec2::new(0.0, 0.5), &shown)) - 6.0).abs() < 2e-6);
        let behind = super::tests::way(&[(0.0, [0.0, 1.0, -4.0]), (8.0, [0.0, 1.0, -1.0])]);
        assert_eq!(nearest(&behind, second(1.0), DVec2::ZERO, &shown), None);
    }

    /// Three rounds of a circle, a minute each, clockwise from the east.
    fn rounds() -> Vec<Stop> {
        let stop = |i: i32| {
            let angle = -f64::from(i) * TAU / 360.0;
            Stop { at: second(f64::from(i) / 6.0), place: DVec3::new(100.0 * angle.cos(), 100.0 * angle.sin(), 0.0) }
        };
        (0..=3 * 360).map(stop).collect()
    }

    #[test]
    fn where_it_goes_round_it_is_no_more_than_half_a_round_away() {
        let way = rounds();
        let at = |second: f64| {
            let angle = -second * TAU / 60.0;
            [100.0 * angle.cos(), 100.0 * angle.sin()]
        };
        for now in [70.0, 90.0, 110.0] {
            for by in [-29.0, -15.0, -1.0, 0.0, 1.0, 15.0, 29.0] {
                let found = drag(&way, now, at(now + by));
                assert!((found - now - by).abs() < 0.01, "{found} from {now} by {by}");
            }
        }
        // Dragged on and on it goes through all rounds.
        let mut now = 0.0;
        for step in 0..=90 {
            let target = 2.0 * f64::from(step);
            now = drag(&way, now, at(target).map(|c| 0.8 * c));
            assert!((now - target).abs() < 0.1, "{now} is not {target}");
        }
    }

    #[test]
    fn where_the_way_crosses_itself_it_goes_straight_on() {
        // A figure of eight (Gerono), once in a minute, through the middle at 0, 30 and 60.
        let place = |second: f64| {
            let t = second * TAU / 60.0;
            [200.0 * t.sin(), 200.0 * t.sin() * t.cos(), 0.0]
        };
        let stops: Vec<(f64, [f64; 3])> =
            (0..=600).map(|i| (f64::from(i) / 10.0, place(f64::from(i) / 10.0))).collect();
        let way = way(&stops);
        let mut now = 20.0;
        for step in 200..400 {
            let target = f64::from(step) / 10.0;
            let [x, y, _] = place(target);
            // Not quite on it.
            now = drag(&way, now, [x + 3.0, y - 4.0]);
            assert!((now - target).abs() < 1.0, "{now} is not {target}");
        }
        // Who goes to the other loop at once means it.
        let [x, y, _] = place(45.0);
        assert!((drag(&way, 15.0, [x, y]) - 45.0).abs() < 0.5);
    }

    #[test]
    fn a_stand_is_no_hindrance_and_a_jump_is_no_way() {
        let halts =
            way(&[(0.0, [0.0; 3]), (10.0, [100.0, 0.0, 0.0]), (500.0, [100.0, 0.0, 0.0]), (510.0, [200.0, 0.0, 0.0])]);
        for now in [5.0, 10.0, 300.0, 505.0] {
            assert_eq!([drag(&halts, now, [150.0, 5.0]), drag(&halts, now, [50.0, 5.0])], [505.0, 5.0]);
        }
        assert_eq!(drag(&halts, 5.0, [100.0, 0.0]), 10.0, "where it comes first");
        let jumps =
            way(&[(0.0, [0.0; 3]), (10.0, [100.0, 0.0, 0.0]), (10.0, [0.0, 50.0, 0.0]), (20.0, [100.0, 50.0, 0.0])]);
        assert_eq!(drag(&jumps, 2.0, [50.0, 20.0]), 5.0, "nothing goes along the jump");
        assert_eq!(drag(&jumps, 2.0, [50.0, 48.0]), 15.0);
    }

    #[test]
    fn points_of_what_turns_go_along_arcs() {
        let key = |at: f64, yaw: f64| Keyframe { at: second(at), place: DVec3::new(5.0, 5.0, 0.0), yaw, scale: 1.0 };
        // A crane that turns half round in a minute.
        let crane = Keyframes { object: 0, keys: vec![key(0.0, 0.0), key(60.0, PI)] };
        let way = way_of(&crane, DVec3::new(105.0, 5.0, 20.0));
        for (angle, at) in [(0.25, 15.0), (0.5, 30.0), (0.9, 54.0)] {
            let (sin, cos) = (angle * PI).sin_cos();
            let found = drag(&way, 20.0, [5.0 + 100.0 * cos, 5.0 + 100.0 * sin]);
            assert!((found - at).abs() < 0.01, "{found} is not {at}");
        }
        assert_eq!(way_of(&Keyframes { object: 0, keys: vec![key(0.0, 0.0)] }, DVec3::ZERO).len(), 1);
        let pose = crane.pose(Some(second(20.0)));
        let there = pose.place(DVec3::new(9.0, 2.0, 1.0));
        assert!(pose.in_file(there).distance(DVec3::new(9.0, 2.0, 1.0)) < 1e-9);
    }
}
