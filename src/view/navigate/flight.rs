//! Flights: animated moves from one camera to another.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::view::{
    camera::{Camera, MAX_FOV, MIN_FOV, Projection, default_near_m},
    navigate::{
        look::{Look, shorter},
        settled::{HEIGHTS_M, has_default_near, picture_height_m},
    },
};

/// The pitch half way along a flight that rises, radians above the horizon (−40°), unless its ends look down
/// farther.
const FLIGHT_PITCH: f64 = -40.0 * PI / 180.0;
/// Shortest and longest time of a flight, seconds.
pub(super) const FLIGHT_S: (f64, f64) = (0.25, 1.2);

/// An animated move from one camera to another.
///
/// The target goes in a straight line, the heading the short way round, the distance of the eye by equal factors in
/// equal times: so the eye never swings through the target. Far moves rise in between, as high as *Smooth and efficient
/// zooming and panning* (van Wijk and Nuij 2003) does between two pictures of one size: to a picture about as high as
/// the way is long, and look down on it. The eye is never lower than the lower of both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Where it starts.
    pub from: Camera,
    /// Where it ends.
    pub to: Camera,
}

impl Flight {
    /// The camera at `t`, 0..=1: exactly [`Flight::from`] at 0 and before, exactly [`Flight::to`] at 1 and after. It
    /// starts and ends at rest. Between projections of two kinds it keeps the first until it ends, in a picture that
    /// grows to the size of the other. Where one end has no picture ([`Camera::check`]), it stays at `from` until it
    /// ends.
    pub fn at(&self, t: f64) -> Camera {
        let (from, to) = (&self.from, &self.to);
        if t >= 1.0 {
            return *to;
        }
        let (Ok(start), Ok(end)) = (from.basis(), to.basis()) else { return *from };
        if t.is_nan() || t <= 0.0 || from == to {
            return *from;
        }
        let s = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
        let mix = |a: f64, b: f64| (1.0 - s) * a + s * b;
        let mix_factors = |a: f64, b: f64| mix(a.ln(), b.ln()).exp();

        let (first, last) = (Look::of(&start), Look::of(&end));
        let heading = first.heading + s * shorter(last.heading - first.heading);
        let whole_rise = self.rise();
        let (between, pitch) = (4.0 * s * (1.0 - s), mix(first.pitch, last.pitch));
        // A level view would only draw back, not rise.
        let down = (pitch - FLIGHT_PITCH).max(0.0) * between * (1.0 - 1.0 / whole_rise);
        let look = Look { heading, pitch: pitch - down };
        let first_roll = first.roll_of(&start);
        let roll = first_roll + s * shorter(last.roll_of(&end) - first_roll);

        let distances = [from, to].map(|camera| camera.eye.distance(camera.target));
        let rise = whole_rise.powf(between);
        let distance = mix_factors(distances[0], distances[1]) * rise;
        let projection = match (from.projection, to.projection) {
            (Projection::Perspective { fov_y }, Projection::Perspective { fov_y: last }) => {
                Projection::Perspective { fov_y: mix(fov_y, last) }
            }
            (Projection::Perspective { fov_y }, Projection::Orthographic { height_m }) => {
                let last = 2.0 * (0.5 * height_m / distances[1]).atan();
                Projection::Perspective { fov_y: mix(fov_y, last.clamp(MIN_FOV, MAX_FOV)) }
            }
            (Projection::Orthographic { height_m }, _) => {
                let height_m = mix_factors(height_m, picture_height_m(to)) * rise;
                Projection::Orthographic { height_m: height_m.clamp(HEIGHTS_M.0, HEIGHTS_M.1) }
            }
        };

        let basis = look.basis();
        let target = (1.0 - s) * from.target + s * to.target;
        let eye = target - distance * basis.forward;
        let lifted = (from.eye.z.min(to.eye.z) - eye.z).max(0.0) * DVec3::Z;
        // Without roll the up of a level picture, which is the vertical itself.
        let up = if roll.abs() < 1e-9 { look.up() } else { roll.cos() * basis.up + roll.sin() * basis.right };
        let near_m = if has_default_near(from) && has_default_near(to) {
            default_near_m(distance)
        } else {
            mix_factors(from.near_m, to.near_m)
        };
        let there = Camera { eye: eye + lifted, target: target + lifted, up, projection, near_m };
        if there.check().is_ok() { there } else { *from }
    }

    /// The time that it should take, 0.25..=1.2 seconds: the longer, the more the picture changes.
    pub fn duration_s(&self) -> f64 {
        let (Ok(start), Ok(end)) = (self.from.basis(), self.to.basis()) else { return FLIGHT_S.0 };
        let turn = start.forward.angle_between(end.forward).max(start.right.angle_between(end.right)) / FRAC_PI_2;
        let growth = (picture_height_m(&self.to) / picture_height_m(&self.from)).ln().abs();
        let way = self.way().asinh();
        let effort = turn + 0.5 * growth + 0.5 * way;
        let part = 1.0 - (-0.5 * effort).exp();
        if part.is_finite() { FLIGHT_S.0 + (FLIGHT_S.1 - FLIGHT_S.0) * part.clamp(0.0, 1.0) } else { FLIGHT_S.0 }
    }

    /// The way of the target, in heights of the picture (the geometric mean of both).
    fn way(&self) -> f64 {
        let height_m = (picture_height_m(&self.from).ln() * 0.5 + picture_height_m(&self.to).ln() * 0.5).exp();
        self.from.target.distance(self.to.target) / height_m
    }

    /// By which factor the picture grows half way: 1 for moves of up to the height of the picture. Van Wijk and Nuij's
    /// is √(1 + way²) for pictures of one size and their ρ = √2.
    fn rise(&self) -> f64 {
        (self.way() - 1.0).max(0.0).hypot(1.0)
    }
}
