//! The space that an eye can see, as half spaces.

use glam::DVec3;

use crate::geom::Aabb;

/// The points `p` with `normal · p ≥ offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Unit, towards the inside.
    pub normal: DVec3,
    /// Metres.
    pub offset: f64,
}

impl HalfSpace {
    /// The half space through `point`, on the side `normal` (unit) points to.
    pub fn through(point: DVec3, normal: DVec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// Signed distance of `p`, metres, inside positive.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    /// Distance of the box's corner that lies deepest inside.
    pub fn deepest(&self, bounds: &Aabb) -> f64 {
        let corner = DVec3::select(self.normal.cmpge(DVec3::ZERO), bounds.max, bounds.min);
        self.distance(corner)
    }
}

/// The visible part of the world: left, right, bottom, top, near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Its sides; there is no far one.
    pub sides: [HalfSpace; 5],
}

/// Metres a box may lie outside and still count as visible: what f64 sums lose at national coordinates, with room.
const SLACK_M: f64 = 1e-6;

impl Frustum {
    /// All of the world.
    pub const EVERYTHING: Self = Self { sides: [HalfSpace { normal: DVec3::Z, offset: f64::NEG_INFINITY }; 5] };

    /// Whether the closed box may be visible: never `false` for one that is, seldom `true` for one that is not
    /// (boxes beyond an edge of the frustum).
    pub fn meets(&self, bounds: &Aabb) -> bool {
        !bounds.is_empty() && self.sides.iter().all(|side| side.deepest(bounds) >= -SLACK_M)
    }

    /// Whether a point is inside.
    pub fn contains(&self, p: DVec3) -> bool {
        self.sides.iter().all(|side| side.distance(p) >= 0.0)
    }
}
