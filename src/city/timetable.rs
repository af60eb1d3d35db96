//! Timetables: where objects that move are when, by keyframes.

use std::path::PathBuf;

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::{city::model::CityModel, geom::Aabb, time::Moment};

/// Where an object is at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// The moment.
    pub at: Moment,
    /// The place of the object's own point, metres: the same point of it in all keyframes.
    pub place: DVec3,
    /// How it is turned, radians counter-clockwise from east; it goes on beyond a full turn.
    pub yaw: f64,
    /// How large it is, > 0.
    pub scale: f64,
}

/// The keyframes of an object, with all its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    /// Index of the object.
    pub object: u32,
    /// Ascending by moment; at least one. In the first the object is as its file has it.
    pub keys: Vec<Keyframe>,
}

/// How an object stands at a moment: `p` of its file becomes `to + turn · scale · (p − from)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// What is turned about, metres.
    pub from: DVec3,
    /// Where that comes to stand, metres.
    pub to: DVec3,
    /// Radians counter-clockwise, seen from above.
    pub turn: f64,
    /// > 0.
    pub scale: f64,
}

impl Pose {
    /// Where a point of the file comes to stand, metres.
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.to + self.scale * (DQuat::from_rotation_z(self.turn) * (point - self.from))
    }

    /// A box around what stands of a box of the file, metres.
    pub fn boxed(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() { *bounds } else { Aabb::from_points(bounds.corners().map(|corner| self.place(corner))) }
    }

    /// The point of the file that stands at a place, metres.
    pub fn in_file(&self, place: DVec3) -> DVec3 {
        self.from + DQuat::from_rotation_z(-self.turn) * (place - self.to) / self.scale
    }
}

impl Keyframes {
    /// How the object stands at a moment: between two keyframes on the straight line from one to the other, at one speed; before the first as
    /// there, after the last as there. At none as its file has it.
    pub fn pose(&self, at: Option<Moment>) -> Pose {
        self.pose_of(&at.map_or(self.keys[0], |at| self.key_at(at)))
    }

    /// How the object stands at a keyframe.
    pub fn pose_of(&self, now: &Keyframe) -> Pose {
        let first = &self.keys[0];
        Pose { from: first.place, to: now.place, turn: now.yaw - first.yaw, scale: now.scale / first.scale }
    }

    /// The keyframe that would be one at a moment.
    fn key_at(&self, at: Moment) -> Keyframe {
        // Of several at one moment the last counts from then on.
        let after = self.keys.partition_point(|key| key.at <= at);
        let Some(before) = after.checked_sub(1).map(|i| self.keys[i]) else { return self.keys[0] };
        let Some(next) = self.keys.get(after) else { return before };
        let share = (at - before.at) as f64 / (next.at - before.at) as f64;
        let between = |a: f64, b: f64| a + (b - a) * share;
        Keyframe {
            at,
            place: before.place + (next.place - before.place) * share,
            yaw: between(before.yaw, next.yaw),
            scale: between(before.scale, next.scale),
        }
    }
}

impl CityModel {
    /// How an object stands at a moment, of a model as its file has it; `None`: where the file has it.
    pub fn pose_of(&self, object: u32, at: Option<Moment>) -> Option<Pose> {
        Some(self.moves[self.mover(object)?].pose(at))
    }

    /// The box around an object with all its parts at a moment, of a model as its file has it, metres.
    pub fn bounds_at(&self, object: u32, at: Option<Moment>) -> Aabb {
        let bounds = self.family_bounds(object);
        self.pose_of(object, at).map_or(bounds, |pose| pose.boxed(&bounds))
    }
}

/// What was read of a timetable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimetableFacts {
    /// The file as it was named.
    pub file: PathBuf,
    /// Rows of it.
    pub rows: u64,
    /// Objects that move by it.
    pub objects: u64,
    /// Rows of no object.
    pub without_object: u64,
    /// The keys of the first of them, at most eight, each once.
    pub first_without_object: Vec<String>,
    /// The first moment of a keyframe, as scenes write it.
    pub first: Option<String>,
    /// The last.
    pub last: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{HOUR, Span};

    #[test]
    fn between_keyframes_it_goes_straight_on_at_one_speed() {
        let start = Moment::of_year(2025).expect("a year");
        let key = |hours: i64, x: f64, yaw: f64, scale: f64| Keyframe {
            at: start.shifted(Span::of_micros(hours * HOUR)),
            place: DVec3::new(x, 2.0, 3.0),
            yaw,
            scale,
        };
        let of = Keyframes {
            object: 0,
            keys: vec![key(0, 10.0, 1.0, 2.0), key(4, 30.0, 3.0, 2.0), key(4, 50.0, 3.0, 4.0), key(6, 60.0, -1.0, 4.0)],
        };
        let at = |hours: f64| of.pose(Some(start.shifted(Span::of_micros((hours * HOUR as f64) as i64))));
        let from = DVec3::new(10.0, 2.0, 3.0);
        let pose = |x: f64, turn: f64, scale: f64| Pose { from, to: DVec3::new(x, 2.0, 3.0), turn, scale };
        assert_eq!(of.pose(None), pose(10.0, 0.0, 1.0));
        assert_eq!([at(-9.0), at(0.0)], [pose(10.0, 0.0, 1.0); 2]);
        assert_eq!(at(1.0), pose(15.0, 0.5, 1.0));
        assert_eq!(at(4.0), pose(50.0, 2.0, 2.0), "from then on the later of both counts");
        assert_eq!(at(5.0), pose(55.0, 0.0, 2.0));
        assert_eq!(at(99.0), pose(60.0, -2.0, 2.0));
    }
}
