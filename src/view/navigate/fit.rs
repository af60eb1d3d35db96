//! Cameras that show all of a box, from where they look or from a side of the compass.

use glam::DVec3;

use crate::{
    geom::Aabb,
    view::{
        basis::Basis,
        camera::{Camera, Projection, default_near_m},
        navigate::{
            MIN_DISTANCE_M,
            settled::{HEIGHTS_M, has_default_near, settled},
        },
    },
};

/// Part of the picture's half width and height that a framed box may fill: a margin of 3 % of the picture on each side.
pub(super) const FILL: f64 = 0.94;

/// A side to look from, by the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// From above, straight down; north is at the top of the picture, east on its right.
    Top,
    /// From the north, looking south: north facades, west on the right.
    North,
    /// From the south, looking north: south facades, east on the right.
    South,
    /// From the east, looking west: east facades, north on the right.
    East,
    /// From the west, looking east: west facades, south on the right.
    West,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Top, Self::North, Self::South, Self::East, Self::West];

    /// Direction of view, unit: into the picture.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Top => DVec3::NEG_Z,
            Self::North => DVec3::NEG_Y,
            Self::South => DVec3::Y,
            Self::East => DVec3::NEG_X,
            Self::West => DVec3::X,
        }
    }

    /// The upward direction of the picture, unit.
    pub fn up(self) -> DVec3 {
        if self == Self::Top { DVec3::Y } else { DVec3::Z }
    }
}

/// Looks at all of `bounds` from a side, in a picture `aspect` times as wide as high; as `camera` projects. See
/// [`framed`].
pub fn axis_view(axis: Axis, bounds: &Aabb, camera: &Camera, aspect: f64) -> Camera {
    fitted(camera, axis.direction(), axis.up(), bounds, aspect)
}

/// Moves the camera, without turning it, so that all of `bounds` is in a picture `aspect` times as wide as high
/// (1e-4..=1e4), with a margin of 3 % of the picture on each side that it touches.
///
/// The target becomes a point at the depth of the middle of `bounds`. A perspective eye goes as near as the corners
/// allow; an orthographic one gets the height that fits and does not come nearer to its target than it was, so that it
/// stays out of what surrounds `bounds`. An empty box, and one without any size, changes nothing.
pub fn framed(camera: &Camera, bounds: &Aabb, aspect: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    fitted(camera, basis.forward, camera.up, bounds, aspect)
}

/// `camera` looking along `forward` (unit) at all of `bounds`.
///
/// On the axes of the eye a point (s, d) fits the width iff |s − eye.s| ≤ tan·(d − eye.d): with A = min(tan·d − s) and
/// B = min(tan·d + s) the deepest eye is at eye.d = (A+B)/(2·tan), eye.s = (B−A)/2. The height likewise.
fn fitted(camera: &Camera, forward: DVec3, up: DVec3, bounds: &Aabb, aspect: f64) -> Camera {
    let size = bounds.size();
    if !(size.is_finite() && size.max_element() > 0.0 && (1e-4..=1e4).contains(&aspect)) {
        return *camera;
    }
    let basis = Basis::looking_along(forward, up);
    let center = bounds.center();
    let corners = bounds.corners().map(|corner| corner - center);
    let reach = |axis: DVec3| corners.iter().fold(0.0, |far: f64, corner| far.max(corner.dot(axis)));
    let half_depth = reach(forward);
    // Nothing of the box may lie before the near plane. Its default is less than this at any distance that this decides.
    let default_m = (half_depth / 500.0).clamp(default_near_m(0.0), 1.0);
    let near_m = if has_default_near(camera) { default_m } else { camera.near_m };
    let nearest = (half_depth + 1.001 * near_m).max(MIN_DISTANCE_M);
    let there = match camera.projection {
        Projection::Perspective { fov_y } => {
            let side = |axis: DVec3, tan: f64| {
                let (mut a, mut b) = (f64::INFINITY, f64::INFINITY);
                for corner in corners {
                    let (s, d) = (corner.dot(axis), corner.dot(forward));
                    a = a.min(d * tan - s);
                    b = b.min(d * tan + s);
                }
                (0.5 * (b - a), 0.5 * (a + b) / tan)
            };
            let tan = FILL * (0.5 * fov_y).tan();
            let (right, deepest_x) = side(basis.right, tan * aspect);
            let (up_m, deepest_y) = side(basis.up, tan);
            let distance = (-deepest_x.min(deepest_y)).max(nearest);
            let target = center + right * basis.right + up_m * basis.up;
            Camera { eye: target - distance * forward, target, up, ..*camera }
        }
        Projection::Orthographic { .. } => {
            let half = reach(basis.up).max(reach(basis.right) / aspect);
            let height_m = (2.0 * half / FILL).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            let distance = camera.eye.distance(camera.target).max(nearest);
            let projection = Projection::Orthographic { height_m };
            Camera { eye: center - distance * forward, target: center, up, projection, ..*camera }
        }
    };
    settled(camera, there)
}
