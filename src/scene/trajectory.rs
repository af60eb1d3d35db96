//! Things that move: where on its way one is at a moment, and where it is headed.

use glam::DVec3;

use crate::{
    lens::nearest::did_you_mean,
    scene::{
        check::SceneProblem,
        model::{Poi, PoiPlace, Scene},
    },
    view::path::{Curve, Form, Line},
};

/// The way of something that moves, with the times on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Its name, unique.
    pub name: String,
    /// What it goes through, metres; two or more.
    pub points: Vec<DVec3>,
    /// When it is where.
    pub pace: Pace,
    /// Whether it goes on from the last point to the first, round and round; and whether it has no corners.
    pub form: Form,
    /// Whether its heights are metres above the ground, which it follows ([`Scene::on_ground`]).
    pub above_ground: bool,
    /// When it sets out, seconds; before that it stands at its first point.
    pub start_s: f64,
    /// sRGB 0..1, of its marker and its trace.
    pub color: [f32; 3],
    /// Whether a marker shows in pictures where it is.
    pub marker: bool,
    /// Whether a line shows in pictures where it goes.
    pub trace: bool,
}

/// How fast something goes its way.
#[derive(Clone, Debug, PartialEq)]
pub enum Pace {
    /// So many metres per second, > 0.
    Speed(f64),
    /// When it is at each point, seconds after it set out, ascending; of a closed way one more: when it is back at the first. From point
    /// to point it goes at one speed; on a way without corners speed is continuous ([`Curve`]).
    Times(Vec<f64>),
}

/// Something that moves, at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Where it is, metres.
    pub at: DVec3,
    /// Where it goes, of length 1. Before it sets out it is where it will go, after it arrived where it came from; at a corner where it goes
    /// on. `None`: its way has no length.
    pub direction: Option<DVec3>,
    /// Metres it has gone, at most the length of its way.
    pub gone_m: f64,
}

impl Trajectory {
    /// Its way.
    pub fn line(&self) -> Line {
        Line::new(&self.points, self.form)
    }

    /// Where it is at a time, seconds.
    pub fn at(&self, time_s: f64) -> Moving {
        let line = self.line();
        let since = (time_s - self.start_s).max(0.0);
        let gone = match &self.pace {
            Pace::Speed(speed) => speed * since,
            Pace::Times(times) => self.by_times(times, line.marks(), since),
        };
        let length = line.length();
        let is_round = self.form.is_closed && length > 0.0;
        let metres = if is_round { gone.rem_euclid(length) } else { gone.min(length) };
        Moving { at: line.at(metres), direction: line.direction(metres), gone_m: gone.min(length) }
    }

    /// When it has arrived, seconds; of a closed way, when it has gone round once.
    pub fn end_s(&self) -> f64 {
        self.start_s
            + match &self.pace {
                Pace::Speed(speed) => self.line().length() / speed,
                Pace::Times(times) => times.last().copied().unwrap_or(0.0),
            }
    }

    /// When it has gone so many metres, seconds after it set out, between two of its times.
    pub(super) fn gone_at(&self, metres: f64, [mut before, mut after]: [f64; 2]) -> f64 {
        let Pace::Times(times) = &self.pace else { return before };
        let line = self.line();
        // Each step halves what is left: a second becomes less than a nanosecond.
        for _ in 0..40 {
            let middle = 0.5 * (before + after);
            match self.by_times(times, line.marks(), middle) < metres {
                true => before = middle,
                false => after = middle,
            }
        }
        0.5 * (before + after)
    }

    /// Metres gone after `since` seconds, more than the way where it goes round; it is at `marks` at `times`.
    fn by_times(&self, times: &[f64], marks: &[f64], since: f64) -> f64 {
        let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return 0.0 };
        let round = last - first;
        let (rounds, since) = match self.form.is_closed && since > first && round > 0.0 {
            true => (((since - first) / round).floor(), first + (since - first).rem_euclid(round)),
            false => (0.0, since),
        };
        let own = match self.form.is_smooth {
            true => Curve::new(times, marks).at(since),
            false => {
                let after = times.partition_point(|time| *time <= since);
                match after.checked_sub(1) {
                    Some(i) if after < times.len() => {
                        let share = (since - times[i]) / (times[after] - times[i]);
                        marks[i] + share * (marks[after] - marks[i])
                    }
                    Some(i) => marks[i.min(marks.len() - 1)],
                    None => 0.0,
                }
            }
        };
        rounds * marks.last().copied().unwrap_or(0.0) + own
    }
}

impl Scene {
    /// What moves with a point of interest, at the scene's moment; `None`: it does not move, or its trajectory is not there.
    pub fn moving(&self, poi: &Poi) -> Option<Moving> {
        let PoiPlace::On(name) = &poi.place else { return None };
        self.trajectories.iter().find(|way| way.name == *name).map(|way| way.at(self.time_s))
    }

    /// Where a point of interest is at the scene's moment: an object or a point, for one that moves the point where it is. One whose trajectory
    /// is not there stays as it is.
    pub fn place(&self, poi: &Poi) -> PoiPlace {
        self.moving(poi).map_or_else(|| poi.place.clone(), |moving| PoiPlace::At(moving.at))
    }

    /// Its points of interest, none of which moves.
    pub fn standing_pois(&self) -> Vec<Poi> {
        self.pois.iter().map(|poi| Poi { name: poi.name.clone(), place: self.place(poi) }).collect()
    }

    /// Whether a point of interest of it moves.
    pub fn moves(&self) -> bool {
        self.pois.iter().any(|poi| matches!(poi.place, PoiPlace::On(_)))
    }
}

/// Points of interest on trajectories that the scene does not have.
pub fn problems(scene: &Scene) -> Vec<SceneProblem> {
    let absent = scene.pois.iter().enumerate().filter_map(|(i, poi)| match &poi.place {
        PoiPlace::On(name) if !scene.trajectories.iter().any(|way| way.name == *name) => Some((i, name)),
        _ => None,
    });
    let problems = absent.map(|(i, name)| {
        let hint = did_you_mean(name, scene.trajectories.iter().map(|way| way.name.as_str()));
        SceneProblem {
            table: format!("poi.{i}"),
            key: "trajectory".into(),
            message: format!("there is no trajectory \"{name}\"{hint}"),
            is_error: true,
        }
    });
    problems.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(points: &[[f64; 3]], pace: Pace, is_closed: bool, is_smooth: bool) -> Trajectory {
        Trajectory {
            name: "way".into(),
            points: points.iter().map(|p| DVec3::from_array(*p)).collect(),
            pace,
            form: Form { is_closed, is_smooth },
            above_ground: false,
            start_s: 5.0,
            color: [0.0; 3],
            marker: true,
            trace: false,
        }
    }

    fn is_at(way: &Trajectory, time_s: f64, at: [f64; 3], direction: [f64; 3]) {
        let found = way.at(time_s);
        assert!((found.at - DVec3::from_array(at)).length() < 1e-9, "{time_s}: {found:?}");
        let to = found.direction.expect("a direction");
        assert!((to - DVec3::from_array(direction)).length() < 1e-9, "{time_s}: {found:?}");
    }

    #[test]
    fn what_has_a_speed_goes_evenly_along_straight_lines() {
        let way = way(&[[0.0, 0.0, 2.0], [80.0, 0.0, 2.0], [80.0, 60.0, 2.0]], Pace::Speed(10.0), false, false);
        is_at(&way, -3.0, [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]);
        is_at(&way, 9.0, [40.0, 0.0, 2.0], [1.0, 0.0, 0.0]);
        is_at(&way, 13.0, [80.0, 0.0, 2.0], [0.0, 1.0, 0.0]);
        is_at(&way, 16.0, [80.0, 30.0, 2.0], [0.0, 1.0, 0.0]);
        is_at(&way, 1e5, [80.0, 60.0, 2.0], [0.0, 1.0, 0.0]);
        assert_eq!(way.end_s(), 19.0);
        assert_eq!([9.0, 1e5].map(|t| way.at(t).gone_m), [40.0, 140.0]);
    }

    #[test]
    fn what_is_closed_goes_round_and_round() {
        let triangle = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]];
        for (pace, is_smooth) in [(Pace::Speed(1.0), false), (Pace::Times(vec![0.0, 3.0, 7.0, 12.0]), false)] {
            let way = way(&triangle, pace, true, is_smooth);
            for round in [0.0, 12.0, 1200.0] {
                is_at(&way, 5.0 + round + 1.5, [1.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
                is_at(&way, 5.0 + round + 9.5, [1.5, 2.0, 0.0], [-0.6, -0.8, 0.0]);
            }
        }
    }

    #[test]
    fn times_say_when_it_is_at_its_points() {
        let points = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 30.0, 0.0], [50.0, 30.0, 10.0]];
        let times = [2.0, 4.0, 10.0, 11.0];
        for is_smooth in [false, true] {
            let way = way(&points, Pace::Times(times.to_vec()), false, is_smooth);
            for (point, time) in points.iter().zip(times) {
                let found = way.at(5.0 + time).at;
                assert!((found - DVec3::from_array(*point)).length() < 1e-6, "{is_smooth} {time}: {found}");
            }
            assert!(way.at(0.0).at.length() < 1e-9, "it stands until it sets out, and until its first time");
        }
        let way = way(&points, Pace::Times(times.to_vec()), false, false);
        is_at(&way, 5.0 + 7.0, [10.0, 15.0, 0.0], [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_has_no_way_stands_and_looks_nowhere() {
        for pace in [Pace::Speed(3.0), Pace::Times(vec![0.0, 9.0])] {
            for is_smooth in [false, true] {
                let found = way(&[[7.0, 8.0, 9.0]; 2], pace.clone(), false, is_smooth).at(8.0);
                assert_eq!((found.at, found.direction), (DVec3::new(7.0, 8.0, 9.0), None));
            }
        }
    }
}
