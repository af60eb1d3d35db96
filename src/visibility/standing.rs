//! Where a person stands to look at an object: on the ground, beside the buildings, with all of it in the picture and a third of its facades seen.
//!
//! ```text
//!             eyes that are tried, in this order
//!   side of the eye ──> 15° to either side ──> ... ──> the far side
//!         │ on each: from beside the object outwards, each step longer than the one before
//!         └─> free? on ground? in no building? all in the picture? ─> share of its facades that is seen
//! ```
//!
//! The first eye that sees [`ENOUGH`] is taken, so it stands back along its line of sight first and goes around then; where none does, the one
//! that sees most. Facades here are walls (steeper than 45°; all faces of what has none), since from the ground no roof is seen of most houses.
//! Shares are those of samples, see [`best_view`](crate::visibility::best_view): off by 2.2 % at most.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::{city::place::Places, geom::Aabb, view::Field, visibility::best_view::Subject};

/// The height of eyes, metres.
pub const EYE_HEIGHT_M: f64 = 1.7;
/// The share of an object's facades that is to be seen.
pub const ENOUGH: f64 = 1.0 / 3.0;
/// The free distance around a place to stand, metres.
const ROOM_M: f64 = 1.0;
/// Directions around an object that are tried.
const AROUND: u32 = 24;
/// The first distance from an object's box, metres, and how much longer each next one is.
const FIRST_M: f64 = 3.0;
const LONGER: f64 = 1.25;
/// The distance up to which eyes are tried: this part of that from which its ball fits into the picture, and so many metres more.
const BEYOND: f64 = 1.5;
const BEYOND_M: f64 = 30.0;
/// The part of the picture's height and width that an object fills at most.
const FILLED: f64 = 0.95;
/// What is seen from two eyes is alike to this part of it.
const ALIKE: f64 = 0.02;

/// A place to stand, and what is seen from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// The eye, [`EYE_HEIGHT_M`] above the ground, metres.
    pub eye: DVec3,
    /// A place to look at: with it in the middle, all of the object is in the picture. Metres.
    pub target: DVec3,
    /// The share of the object's facades that is seen, 0..=1.
    pub seen: f64,
}

/// An object that somebody wants to stand before.
#[derive(Debug)]
pub struct Before<'a> {
    /// The object.
    pub subject: &'a Subject<'a>,
    /// What is where in its city.
    pub places: Places<'a>,
    /// The field of view of the eye.
    pub field: Field,
}

impl Before<'_> {
    /// Where to stand for an eye that comes from somewhere: see the top of this file. `None`: there is no free place from which all of it
    /// is in the picture.
    pub fn standing(&self, from: DVec3) -> Option<Standing> {
        let mut best: Option<Standing> = None;
        for turn in turns() {
            let all: Vec<Option<Standing>> =
                self.eyes(from, turn).into_par_iter().map(|at| self.standing_at(at)).collect();
            for one in all.into_iter().flatten() {
                if one.seen >= ENOUGH {
                    return Some(one);
                }
                if best.is_none_or(|best| one.seen > best.seen * (1.0 + ALIKE)) {
                    best = Some(one);
                }
            }
        }
        best
    }

    /// What is seen by somebody who stands at a place in plan; `None` where nobody can stand, or not all of it would be in the picture.
    pub fn standing_at(&self, at: DVec2) -> Option<Standing> {
        let ground = self.places.ground(at)?;
        let eye = at.extend(ground + EYE_HEIGHT_M);
        let target = aimed(eye, &self.subject.bounds, &self.field)?;
        let is_free = self.places.is_free(at, ROOM_M) && self.places.building_around(eye).is_none();
        is_free.then(|| Standing { eye, target, seen: self.subject.walls_seen(eye) })
    }

    /// The places that are tried in one direction, turned clockwise (radians) from the side on which `from` is.
    fn eyes(&self, from: DVec3, turn: f64) -> Vec<DVec2> {
        let bounds = &self.subject.bounds;
        let (middle, half) = (bounds.center().truncate(), 0.5 * bounds.size().truncate());
        let side = (from.truncate() - middle).try_normalize().unwrap_or(DVec2::NEG_Y);
        let way = DVec2::from_angle(-turn).rotate(side);
        // From the middle to the side of the box.
        let inside = (half / way.abs()).min_element().min(half.length());
        let farthest = BEYOND * self.field.distance_to(self.subject.ball.radius) + BEYOND_M;
        let away = std::iter::successors(Some(FIRST_M), |away| Some(away * LONGER));
        away.map(|away| inside + away).take_while(|away| *away <= farthest).map(|away| middle + away * way).collect()
    }
}

/// Turns from the side of the eye: none, then to either side, farther and farther.
fn turns() -> impl Iterator<Item = f64> {
    let step = TAU / f64::from(AROUND);
    (0..AROUND).map(move |i| step * f64::from(i.div_ceil(2)) * if i % 2 == 0 { -1.0 } else { 1.0 })
}

/// The place that an eye without roll looks at to have all of a box in its picture, as far away as the middle of the box; `None`: it has
/// no room there, or the eye is in or over the box.
fn aimed(eye: DVec3, bounds: &Aabb, field: &Field) -> Option<DVec3> {
    let [across, upwards] = {
        let tan = (0.5 * field.fov_y).tan();
        [FILLED * tan * field.aspect, FILLED * tan]
    };
    let to_middle = bounds.center() - eye;
    let heading = to_middle.truncate().try_normalize()?;
    let corners = bounds.corners().map(|corner| corner - eye);
    // Turned to the middle of where the corners are to the sides, then to the middle of where they are up and down.
    let (least, most) = extremes(corners.map(|corner| heading.angle_to(corner.truncate())));
    let heading = DVec2::from_angle(0.5 * (least + most)).rotate(heading);
    let ahead = corners.map(|corner| corner.truncate().dot(heading));
    if ahead.iter().any(|ahead| *ahead <= 0.0) {
        return None;
    }
    let (low, high) = extremes(std::array::from_fn(|i| corners[i].z.atan2(ahead[i])));
    let pitch = 0.5 * (low + high);
    let (up, level) = pitch.sin_cos();
    let is_in = (0..8).all(|i| {
        let aside = corners[i].truncate().perp_dot(heading).abs();
        aside <= across * (level * ahead[i] + up * corners[i].z)
    });
    let is_high_enough = 0.5 * (high - low) <= upwards.atan();
    let forward = (level * heading).extend(up);
    (most - least < PI && is_in && is_high_enough).then(|| eye + to_middle.length() * forward)
}

fn extremes(of: [f64; 8]) -> (f64, f64) {
    of.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), one| (low.min(*one), high.max(*one)))
}

#[cfg(test)]
mod tests;
