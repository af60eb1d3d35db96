//! Directions of view on the compass.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::view::basis::Basis;

/// Steepest pitch that turning leads to, radians (89.5°): beyond it a heading is hard to tell.
pub const MAX_PITCH: f64 = 89.5 * PI / 180.0;

/// A direction of view on the compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// Clockwise from north, radians.
    pub heading: f64,
    /// Above the horizon, radians, −π/2..=π/2.
    pub pitch: f64,
}

impl Look {
    /// That of a camera with these axes. Where they are steeper than turning leads to, the heading is that of the top
    /// of the picture: the direction of view has hardly any.
    pub fn of(basis: &Basis) -> Self {
        let forward = basis.forward;
        let pitch = forward.z.atan2(forward.truncate().length());
        let ahead = if pitch.abs() <= MAX_PITCH { forward } else { -pitch.signum() * basis.up };
        Self { heading: ahead.x.atan2(ahead.y), pitch }
    }

    /// Turned by `turn`, radians; a pitch beyond [`MAX_PITCH`] may stay or come back, not go on.
    pub fn turned(self, turn: DVec2) -> Self {
        let (lowest, highest) = (self.pitch.min(-MAX_PITCH), self.pitch.max(MAX_PITCH));
        Self { heading: self.heading + turn.x, pitch: (self.pitch + turn.y).clamp(lowest, highest) }
    }

    /// The axes of an eye that looks there without roll.
    pub fn basis(self) -> Basis {
        let (sin, cos) = self.heading.sin_cos();
        let (rise, level) = self.pitch.sin_cos();
        let (right, forward) = (DVec3::new(cos, -sin, 0.0), DVec3::new(level * sin, level * cos, rise));
        Basis { right, up: right.cross(forward), forward }
    }

    /// The reference up of a camera that looks there without roll: the vertical, and along it the top of the picture.
    pub fn up(self) -> DVec3 {
        if self.pitch.abs() <= MAX_PITCH + 1e-9 {
            return DVec3::Z;
        }
        let (sin, cos) = self.heading.sin_cos();
        -self.pitch.signum() * DVec3::new(sin, cos, 0.0)
    }

    /// The turn of axes with this direction of view about it, radians, −π..=π: 0 where up is up.
    pub fn roll_of(self, basis: &Basis) -> f64 {
        let level = self.basis();
        basis.up.dot(level.right).atan2(basis.up.dot(level.up))
    }
}

/// The same turn the short way round, radians, −π..=π.
pub(super) fn shorter(turn: f64) -> f64 {
    turn - TAU * (turn / TAU).round()
}
