//! Rigid motions.

use glam::{DQuat, DVec3};

/// A turn, and then a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Unit.
    pub rotation: DQuat,
    /// Metres.
    pub translation: DVec3,
}

impl Motion {
    /// The one that leaves everything where it is.
    pub const NONE: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// Where a point gets.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// Where a point came from.
    pub fn point_before(&self, p: DVec3) -> DVec3 {
        self.rotation.conjugate() * (p - self.translation)
    }
}
