//! Moving a camera about: what a hand at a window does to it, as pure functions from camera to camera.
//!
//! ```text
//!   north (+y)                 heading  radians clockwise from north, of the view direction
//!      │  ╱ view direction     pitch    radians above the horizon, −90°..=90°
//!      │ ╱ heading             turn     x added to the heading, y to the pitch
//!      │╱
//!      └────── east (+x)
//! ```
//!
//! Whatever is asked for, the answer is a camera that passes [`Camera::check`] or the one that was given: numbers that
//! are not finite, a factor that is not positive or an empty box change nothing. A near plane that is the default one
//! of its camera's distance ([`default_near_m`](crate::view::default_near_m)) becomes that of the new distance; any other is kept.

use glam::{DVec2, DVec3};

use crate::view::{
    camera::{Camera, Projection},
    navigate::{
        look::Look,
        settled::{HEIGHTS_M, moved, picture_height_m, settled},
    },
    project::View,
};

pub mod fit;
pub mod flight;
mod look;
mod settled;

pub use fit::{Axis, axis_view, framed};
pub use flight::Flight;
pub use look::MAX_PITCH;

/// Nearest that [`zoom`] brings an eye to what it looks at, metres.
pub const MIN_DISTANCE_M: f64 = 0.2;
/// Farthest that [`zoom`] takes an eye from what it looks at, metres.
pub const MAX_DISTANCE_M: f64 = 1e7;
/// The distance of the target after a descent to the ground, metres.
const LANDED_M: f64 = 30.0;

/// Turns the camera about `pivot`: `turn.x` radians about the vertical, clockwise seen from above, and `turn.y` radians
/// about the camera's right axis, upwards for the view (so that the eye sinks).
///
/// `pivot` keeps its pixel. The picture has no roll afterwards, and no pitch beyond [`MAX_PITCH`]: the part of the turn
/// that would pass it is dropped. A camera that looks straight down has the heading of the top of its picture.
pub fn orbit(camera: &Camera, pivot: DVec3, turn: DVec2) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    if turn == DVec2::ZERO {
        return *camera;
    }
    let look = Look::of(&basis).turned(turn);
    let turned = look.basis();
    // On the turned axes the eye is where it was on the old ones, seen from the pivot: so the pivot keeps its pixel.
    let from_pivot = camera.eye - pivot;
    let eye = pivot
        + from_pivot.dot(basis.right) * turned.right
        + from_pivot.dot(basis.up) * turned.up
        + from_pivot.dot(basis.forward) * turned.forward;
    let target = eye + camera.eye.distance(camera.target) * turned.forward;
    settled(camera, Camera { eye, target, up: look.up(), ..*camera })
}

/// Turns the camera about its eye, as a head is turned; `turn` and its limits are those of [`orbit`].
pub fn look_around(camera: &Camera, turn: DVec2) -> Camera {
    orbit(camera, camera.eye, turn)
}

/// Moves the camera parallel to its picture so that the world point `at`, seen at `from_px`, is seen at `to_px`; pixels
/// as of [`View::pixel`]. A point that is not before a perspective eye moves nothing.
pub fn pan(view: &View, at: DVec3, from_px: DVec2, to_px: DVec2) -> Camera {
    let camera = &view.camera;
    let depth = view.depth(at);
    if !view.is_orthographic() && depth <= 0.0 {
        return *camera;
    }
    let dragged = view.pixel_m(depth) * (to_px - from_px);
    // The world follows the hand, so the camera goes the other way; rows of pixels go down.
    moved(camera, dragged.y * view.basis.up - dragged.x * view.basis.right)
}

/// Goes nearer to `at` (`factor` below 1) or farther from it (above 1); `at` keeps its pixel, the view its direction.
///
/// In perspective the distances of eye and target to `at` are multiplied by `factor`, between [`MIN_DISTANCE_M`] and
/// [`MAX_DISTANCE_M`] for the eye. In an orthographic view the height of the picture is, between 1 mm and 10,000 km,
/// and the eye moves aside; where the picture becomes higher than the target is away, the eye also draws back to that
/// distance, or the near plane would cut the ground at the bottom of the picture.
pub fn zoom(camera: &Camera, at: DVec3, factor: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    if !(factor > 0.0 && factor.is_finite()) {
        return *camera;
    }
    let distance = camera.eye.distance(camera.target);
    match camera.projection {
        Projection::Perspective { .. } => {
            let away = camera.eye.distance(at);
            if away <= 0.0 {
                return *camera;
            }
            // An eye that is nearer than the nearest or farther than the farthest may stay, but not go on.
            let factor = factor.max((MIN_DISTANCE_M / away).min(1.0)).min((MAX_DISTANCE_M / away).max(1.0));
            let eye = at + factor * (camera.eye - at);
            let target = eye + (factor * distance).max(MIN_DISTANCE_M) * basis.forward;
            settled(camera, Camera { eye, target, ..*camera })
        }
        Projection::Orthographic { height_m } => {
            let higher = (height_m * factor).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            let to_at = at - camera.eye;
            let across = to_at - to_at.dot(basis.forward) * basis.forward;
            let aside = (1.0 - higher / height_m) * across;
            let back = if higher > height_m { (higher - distance).max(0.0) } else { 0.0 };
            let eye = camera.eye + aside - back * basis.forward;
            let projection = Projection::Orthographic { height_m: higher };
            settled(camera, Camera { eye, target: camera.target + aside, projection, ..*camera })
        }
    }
}

/// Moves the camera by `steps` metres to the right, forward and up, without turning it.
///
/// With `level`, right and forward are horizontal and up is vertical, as on foot; a camera that looks straight down
/// goes forward to the top of its picture. Otherwise they are the camera's own axes.
pub fn travel(camera: &Camera, steps: DVec3, level: bool) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    let axes = if level { Look { pitch: 0.0, ..Look::of(&basis) }.basis() } else { basis };
    moved(camera, steps.x * axes.right + steps.y * axes.forward + steps.z * axes.up)
}

/// Walks `steps` metres to the right and forward: [`travel`]s level, then has the eye `eye_height_m` above the ground
/// there.
///
/// `ground` gives the height (z, metres) of the ground below a place (x, y); where it has none, the eye keeps its
/// height.
pub fn walk(camera: &Camera, steps: DVec2, ground: impl FnOnce(DVec2) -> Option<f64>, eye_height_m: f64) -> Camera {
    let there = travel(camera, steps.extend(0.0), true);
    match ground(there.eye.truncate()) {
        Some(height) => moved(&there, (height + eye_height_m - there.eye.z) * DVec3::Z),
        None => there,
    }
}

/// The camera with its eye at `eye`, without roll: it looks at `at`, or, where there is none (or it is at the eye, or
/// right above or below it), level where it was headed, at a place 30 m ahead.
pub fn landed(camera: &Camera, eye: DVec3, at: Option<DVec3>) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    let ahead = eye + LANDED_M * Look { pitch: 0.0, ..Look::of(&basis) }.basis().forward;
    let target = at.filter(|at| (*at - eye).truncate().length() >= MIN_DISTANCE_M).unwrap_or(ahead);
    settled(camera, Camera { eye, target, up: DVec3::Z, ..*camera })
}

/// Switches how the camera projects; what is as deep as the target keeps its size in the picture.
///
/// To an orthographic view only the projection changes. To a perspective with the vertical field of view `fov_y`
/// (radians) the eye moves along the view axis, where its distance to the target fits the height of the picture. There
/// and back with the `fov_y` that a perspective camera has is that camera.
pub fn with_projection(camera: &Camera, orthographic: bool, fov_y: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    match camera.projection {
        Projection::Perspective { .. } if orthographic => {
            let height_m = picture_height_m(camera).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            settled(camera, Camera { projection: Projection::Orthographic { height_m }, ..*camera })
        }
        Projection::Orthographic { height_m } if !orthographic => {
            let distance = 0.5 * height_m / (0.5 * fov_y).tan();
            let eye = camera.target - distance * basis.forward;
            settled(camera, Camera { eye, projection: Projection::Perspective { fov_y }, ..*camera })
        }
        _ => *camera,
    }
}

#[cfg(test)]
mod tests;
