//! Directions around an object: rated where they are asked for, and the best of them found.
//!
//! A direction is a pair (i, j): i steps of azimuth, clockwise from north, and j of elevation, 0 the horizon. Sines and cosines are
//! those of one quadrant, turned, so that a city turned by 90° has the same ratings to the bit but for its own rounding.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    view::{Field, Framing},
    visibility::best_view::{APART, BestView, LEAST, NoView, Seen, Subject, upright},
};

/// Azimuths, 5° apart.
const AZIMUTHS: i32 = 72;
/// The elevation of the zenith, in steps.
const ZENITH: i32 = 18;
/// Radians of a step.
const STEP: f64 = std::f64::consts::FRAC_PI_2 / ZENITH as f64;
/// Steps between neighbours by whose scores a direction is judged, and between those that are rated first.
const TURN: i32 = 3;
/// The difference of scores from which they are told apart, as a part of the better: about what samples are off by.
const TIE: f64 = 0.02;
/// Of so many samples one is looked at where all directions are looked over.
const GLANCE: usize = 16;
/// Directions from which that finds most, and from which the way up is tried.
const GLANCED: usize = 2;
/// What a view loses, as a part of it, of which nothing is turned to the sun.
const SHADE: f64 = 0.3;
/// A step is taken where it gains more than this part.
const GAIN: f64 = 0.002;

/// A direction: azimuth and elevation, in steps; the azimuth of the zenith is 0.
type Place = (i32, i32);

/// The direction of any steps, also beyond the zenith; `None` below the horizon.
fn place(i: i32, j: i32) -> Option<Place> {
    match j {
        _ if j < 0 => None,
        ZENITH => Some((0, ZENITH)),
        _ if j > ZENITH => Some(((i + AZIMUTHS / 2).rem_euclid(AZIMUTHS), 2 * ZENITH - j)),
        _ => Some((i.rem_euclid(AZIMUTHS), j)),
    }
}

/// Directions so many steps apart; of each elevation the same azimuths.
fn lattice(by: i32) -> Vec<Place> {
    let rows = (0..ZENITH / by).flat_map(|j| (0..AZIMUTHS / by).map(move |i| (i * by, j * by)));
    rows.chain([(0, ZENITH)]).collect()
}

/// East, north, up; unit.
fn direction(at: Place) -> DVec3 {
    let (i, j) = at;
    if j == ZENITH {
        return DVec3::Z;
    }
    let (sin, cos) = (f64::from(i % ZENITH) * STEP).sin_cos();
    let (east, north) = [(sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin)][(i / ZENITH) as usize];
    let (up, out) = (f64::from(j) * STEP).sin_cos();
    DVec3::new(out * east, out * north, up)
}

/// The directions a turn away.
fn neighbours(at: Place, turn: i32) -> Vec<Place> {
    if at.1 == ZENITH {
        return (0..4).filter_map(|quarter| place(quarter * AZIMUTHS / 4, ZENITH - turn)).collect();
    }
    let all = [(at.0 - turn, at.1), (at.0 + turn, at.1), (at.0, at.1 - turn), (at.0, at.1 + turn)];
    all.into_iter().filter_map(|(i, j)| place(i, j)).collect()
}

/// The eight around a direction, `by` steps away along each axis.
fn around(at: Place, by: i32) -> Vec<Place> {
    if at.1 == ZENITH {
        return (0..AZIMUTHS / by).filter_map(|i| place(i * by, ZENITH - by)).collect();
    }
    let steps = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))).filter(|step| *step != (0, 0));
    steps.filter_map(|(di, dj)| place(at.0 + di * by, at.1 + dj * by)).collect()
}

/// The score of what is seen from an elevation.
fn quality(seen: &Seen, elevation: f64, is_alone: bool) -> f64 {
    let facade = if is_alone { seen.facade_alone } else { seen.facade * seen.unoccluded };
    facade * upright(elevation) * sunlit(seen.lit)
}

/// The weight of a view by how well what is seen of the object is lit, 0..=1.
fn sunlit(lit: f64) -> f64 {
    1.0 - SHADE * (1.0 - lit)
}

/// Half of a score is the direction's own, half its neighbours'.
fn score_of(own: f64, neighbours: &[f64]) -> f64 {
    match neighbours.len() {
        0 => own,
        n => 0.5 * own + 0.5 * neighbours.iter().sum::<f64>() / n as f64,
    }
}

/// The score of any direction (unit), as listed views have theirs.
pub(super) fn score_along(subject: &Subject, normal: DVec3, field: &Field) -> f64 {
    let distance = field.distance_to(subject.ball.radius);
    let elevation = normal.z.clamp(-1.0, 1.0).asin();
    let azimuth = normal.x.atan2(normal.y);
    let turn = f64::from(TURN) * STEP;
    let turned = |da: f64, de: f64| {
        let (up, out) = (elevation + de).sin_cos();
        let (east, north) = (azimuth + da).sin_cos();
        DVec3::new(out * east, out * north, up)
    };
    let is_up = elevation > std::f64::consts::FRAC_PI_2 - 1e-9;
    let quarter = |k: u8| turned(f64::from(k) * std::f64::consts::FRAC_PI_2, -turn);
    let others = match is_up {
        true => [0, 1, 2, 3].map(quarter),
        false => [turned(-turn, 0.0), turned(turn, 0.0), turned(0.0, -turn), turned(0.0, turn)],
    };
    let rate = |n: &DVec3| {
        let seen = subject.seen(subject.ball.center + distance * *n);
        quality(&seen, n.z.clamp(-1.0, 1.0).asin(), false)
    };
    // Below the horizon there are none, as on the lattice, unless the direction itself is there.
    let kept = others.iter().filter(|n| n.z > -1e-9 || normal.z < 0.0);
    score_of(rate(&normal), &kept.map(rate).collect::<Vec<_>>())
}

/// The ratings so far.
struct Ratings<'a> {
    subject: &'a Subject<'a>,
    /// From the ball's middle to the eye, metres.
    distance: f64,
    known: FxHashMap<Place, Seen>,
    /// Whether it counts what would be seen were the object alone.
    is_alone: bool,
}

impl Ratings<'_> {
    /// Rates these directions and their neighbours, as far as they are not yet.
    fn want(&mut self, places: &[Place]) {
        let all = places.iter().flat_map(|&at| neighbours(at, TURN).into_iter().chain([at]));
        let missing: FxHashSet<Place> = all.filter(|at| !self.known.contains_key(at)).collect();
        let missing: Vec<Place> = missing.into_iter().collect();
        let (subject, distance) = (self.subject, self.distance);
        let rate = |&at: &Place| (at, subject.seen(subject.ball.center + distance * direction(at)));
        self.known.extend(missing.par_iter().map(rate).collect::<Vec<_>>());
    }

    fn quality(&self, at: Place) -> f64 {
        self.known.get(&at).map_or(0.0, |seen| quality(seen, f64::from(at.1) * STEP, self.is_alone))
    }

    /// The score of a direction that was wanted.
    fn score(&self, at: Place) -> f64 {
        let others: Vec<f64> = neighbours(at, TURN).into_iter().map(|n| self.quality(n)).collect();
        score_of(self.quality(at), &others)
    }

    /// Best first; what is no better than the first of a group by more than [`TIE`] is a tie, and goes by azimuth, then by elevation.
    fn ordered(&self, places: impl IntoIterator<Item = Place>) -> Vec<(Place, f64)> {
        let mut scored: Vec<(Place, f64)> = places.into_iter().map(|at| (at, self.score(at))).collect();
        scored.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut start = 0;
        while start < scored.len() {
            let least = scored[start].1 * (1.0 - TIE);
            let end = start + scored[start..].partition_point(|(_, score)| *score >= least);
            scored[start..end].sort_unstable_by_key(|(at, _)| *at);
            start = end;
        }
        scored
    }

    /// From here uphill, to where no step gains.
    fn climb(&mut self, from: Place) -> Place {
        let mut at = from;
        // Each step gains: there are no more of them than directions.
        loop {
            let steps = around(at, 1);
            self.want(&steps);
            let best = steps.iter().max_by(|a, b| self.score(**a).total_cmp(&self.score(**b)).then(b.cmp(a)));
            match best.filter(|next| self.score(**next) > self.score(at) * (1.0 + GAIN)) {
                Some(next) => at = *next,
                None => return at,
            }
        }
    }
}

/// Those that are apart from all before them, `most` at most.
fn apart(places: impl IntoIterator<Item = Place>, most: usize) -> Vec<Place> {
    let mut kept: Vec<Place> = Vec::new();
    for at in places {
        let is_apart = |other: &Place| direction(at).dot(direction(*other)) <= APART.cos() + 1e-9;
        if kept.len() < most && kept.iter().all(is_apart) {
            kept.push(at);
        }
    }
    kept
}

/// The directions of a lattice from which a few samples promise most, of those that promise more than all around them: places of gaps that rows
/// wide apart miss.
fn glance(subject: &Subject, distance: f64) -> Vec<Place> {
    let all = lattice(1);
    let rate = |&at: &Place| (at, subject.seen_by(GLANCE, subject.ball.center + distance * direction(at)));
    let known: FxHashMap<Place, Seen> = all.par_iter().map(rate).collect();
    let mut glances = Ratings { subject, distance, known, is_alone: false };
    glances.is_alone = all.iter().all(|&at| glances.quality(at) <= 0.0);
    let is_top = |at: &Place| {
        let here = glances.score(*at);
        here > 0.0 && around(*at, 1).into_iter().all(|other| glances.score(other) <= here)
    };
    let tops = glances.ordered(all.into_iter().filter(is_top));
    tops.into_iter().map(|(at, _)| at).take(GLANCED).collect()
}

/// The views of a subject, best first.
pub(super) fn best_views(subject: &Subject, field: &Field, most: usize) -> Result<Vec<BestView>, NoView> {
    // What no camera sees is told before anything is looked at.
    Framing::new(&subject.ball, DVec3::Z, field, None)?;
    let distance = field.distance_to(subject.ball.radius);
    let mut ratings = Ratings { subject, distance, known: FxHashMap::default(), is_alone: false };
    let first = lattice(TURN);
    let glanced = glance(subject, distance);
    ratings.want(&first);
    ratings.want(&glanced);
    ratings.is_alone = ratings.known.keys().all(|&at| ratings.quality(at) <= 0.0);
    let is_top = |at: &Place| {
        let here = ratings.score(*at);
        here > 0.0 && around(*at, TURN).into_iter().all(|other| ratings.score(other) <= here)
    };
    let tops: Vec<Place> = first.iter().copied().filter(is_top).collect();
    let tops = ratings.ordered(tops);
    let least = tops.first().map_or(0.0, |(_, best)| LEAST * best);
    let mut starts = apart(tops.into_iter().filter(|(_, score)| *score >= least).map(|(at, _)| at), most);
    // What is seen through a gap lies between those.
    starts.extend(glanced.into_iter().filter(|at| ratings.score(*at) > 0.0));
    if starts.is_empty() {
        // Nothing is seen even of an object alone: faces that are seen from their edges only.
        starts = vec![(0, TURN)];
    }
    let reached: FxHashSet<Place> = starts.into_iter().map(|at| ratings.climb(at)).collect();
    let best = apart(ratings.ordered(reached).into_iter().map(|(at, _)| at), most);
    let view = |at: Place| -> Result<BestView, NoView> {
        let framing = Framing::new(&subject.ball, direction(at), field, None)?;
        Ok(BestView { framing, seen: ratings.known[&at], score: ratings.score(at) })
    };
    best.into_iter().map(view).collect()
}

/// The best score of all directions.
#[cfg(test)]
pub(super) fn best_of_all(subject: &Subject, field: &Field) -> f64 {
    let distance = field.distance_to(subject.ball.radius);
    let mut ratings = Ratings { subject, distance, known: FxHashMap::default(), is_alone: false };
    let all = lattice(1);
    ratings.want(&all);
    all.into_iter().map(|at| ratings.score(at)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_those_of_the_formula() {
        let half_hidden = Seen { visible: 0.3, unoccluded: 0.5, facade: 0.4, facade_alone: 0.8, lit: 1.0 };
        let elevation = 30_f64.to_radians();
        assert_eq!(quality(&half_hidden, elevation, false), 0.4 * 0.5 * upright(elevation));
        assert_eq!(quality(&half_hidden, elevation, true), 0.8 * upright(elevation));
        assert!(upright(elevation) > 0.0);
        let in_shade = Seen { lit: 0.0, ..half_hidden };
        assert_eq!(quality(&in_shade, elevation, false), (1.0 - SHADE) * quality(&half_hidden, elevation, false));
        assert_eq!(score_of(0.75, &[0.25, 0.5, 0.0, 0.25]), 0.5);
        assert_eq!(score_of(0.75, &[]), 0.75);
    }
}
