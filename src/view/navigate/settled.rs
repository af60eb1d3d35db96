//! Cameras after a move: what moving keeps of them, and that they still are cameras.

use glam::DVec3;

use crate::view::camera::{Camera, Projection, default_near_m};

/// Least and greatest height of an orthographic picture, metres: those of [`Camera::check`].
pub(super) const HEIGHTS_M: (f64, f64) = (1e-3, 1e7);

/// Height of the picture at the depth of the target, metres.
pub(super) fn picture_height_m(camera: &Camera) -> f64 {
    match camera.projection {
        Projection::Perspective { fov_y } => 2.0 * camera.eye.distance(camera.target) * (0.5 * fov_y).tan(),
        Projection::Orthographic { height_m } => height_m,
    }
}

/// Whether the near plane is where a camera that states none has it, up to what rounding of eye and target makes of it.
pub(super) fn has_default_near(camera: &Camera) -> bool {
    let default = default_near_m(camera.eye.distance(camera.target));
    (camera.near_m - default).abs() <= 1e-6 * default
}

/// `camera` elsewhere, without a turn.
pub(super) fn moved(camera: &Camera, by: DVec3) -> Camera {
    settled(camera, Camera { eye: camera.eye + by, target: camera.target + by, ..*camera })
}

/// The camera at the end: `there`, with the near plane that belongs there; `camera` itself where either is no camera.
pub(super) fn settled(camera: &Camera, there: Camera) -> Camera {
    let near_m =
        if has_default_near(camera) { default_near_m(there.eye.distance(there.target)) } else { camera.near_m };
    let there = Camera { near_m, ..there };
    if camera.check().is_ok() && there.check().is_ok() { there } else { *camera }
}
