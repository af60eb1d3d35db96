//! The eye: cameras and where to look from at first.

use glam::DVec3;

/// A camera in model coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of projection, metres.
    pub eye: DVec3,
    /// Look-at point, metres; differs from `eye`.
    pub target: DVec3,
    /// Reference up; need not be orthogonal to the view, is replaced where parallel to it.
    pub up: DVec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Distance of the near plane along the view axis, metres, > 0; the far plane is at infinity.
    pub near_m: f64,
}

/// How a camera projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Vertical field of view in radians, 0 < fov < π.
    Perspective { fov_y: f64 },
    /// Height of the picture in metres, > 0.
    Orthographic { height_m: f64 },
}
