//! Cameras in model coordinates, and what makes one impossible.

use glam::{DVec2, DVec3};

/// Narrowest vertical field of view, radians (0.01°): below it neighbouring pixels differ by less than f32 resolves.
pub const MIN_FOV: f64 = 0.01 * std::f64::consts::PI / 180.0;
/// Widest vertical field of view, radians (179°): above it a pixel at the border covers whole degrees.
pub const MAX_FOV: f64 = 179.0 * std::f64::consts::PI / 180.0;
/// Longest side of a picture, pixels.
pub const MAX_SIZE: u32 = 16_384;

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

/// The projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Lines of sight meet in the eye.
    Perspective {
        /// Vertical field of view in radians, [`MIN_FOV`]..=[`MAX_FOV`].
        fov_y: f64,
    },
    /// Lines of sight are parallel.
    Orthographic {
        /// Height of the picture in metres, > 0.
        height_m: f64,
    },
}

/// Why a camera shows nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("{0} must be finite numbers")]
    NotFinite(&'static str),
    /// No direction to look along.
    #[error("eye and target are the same point ({0}, {1}, {2}): there is no direction to look along")]
    EyeIsTarget(f64, f64, f64),
    /// The field of view is too narrow or too wide.
    #[error("the field of view must be 0.01 to 179 degrees, is {0}")]
    FieldOfView(f64),
    /// The height of an orthographic picture.
    #[error("the height of an orthographic picture must be 0.001 to 1e7 metres, is {0}")]
    Height(f64),
    /// The near plane.
    #[error("the near plane must lie 1e-4 to 1e6 metres before the eye, is {0}")]
    Near(f64),
    /// The picture's size.
    #[error("the picture must be 1 to 16384 pixels on a side, is {0}x{1}")]
    Size(u32, u32),
}

impl Camera {
    /// A perspective camera with the default near plane ([`default_near_m`]) and up = +z.
    pub fn looking(eye: DVec3, target: DVec3, fov_y: f64) -> Self {
        let near_m = default_near_m(eye.distance(target));
        Self { eye, target, up: DVec3::Z, projection: Projection::Perspective { fov_y }, near_m }
    }

    /// Half the width and height of a picture of so many pixels: at one metre in front of the eye in perspective, anywhere else.
    pub fn half_extent(&self, size: [u32; 2]) -> DVec2 {
        let half = match self.projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan(),
            Projection::Orthographic { height_m } => 0.5 * height_m,
        };
        DVec2::new(half * (f64::from(size[0]) / f64::from(size[1])), half)
    }

    /// Refuses what has no picture: hard case 21.
    pub fn check(&self) -> Result<(), CameraError> {
        for (name, value) in [("eye", self.eye), ("target", self.target), ("up", self.up)] {
            if !value.is_finite() {
                return Err(CameraError::NotFinite(name));
            }
        }
        if (self.target - self.eye).try_normalize().is_none() {
            return Err(CameraError::EyeIsTarget(self.eye.x, self.eye.y, self.eye.z));
        }
        match self.projection {
            // A written 179 becomes radians with a rounding of its own: the borders allow for it.
            Projection::Perspective { fov_y }
                if !(MIN_FOV * (1.0 - 1e-12)..=MAX_FOV * (1.0 + 1e-12)).contains(&fov_y) =>
            {
                return Err(CameraError::FieldOfView(fov_y.to_degrees()));
            }
            Projection::Orthographic { height_m } if !(1e-3..=1e7).contains(&height_m) => {
                return Err(CameraError::Height(height_m));
            }
            _ => {}
        }
        if !(1e-4..=1e6).contains(&self.near_m) {
            return Err(CameraError::Near(self.near_m));
        }
        Ok(())
    }
}

/// Near plane of a camera that states none: a 512th of the way to its target, within 0.125..=1 m.
///
/// With reversed infinite z in f32 the relative depth step does not depend on the near plane, so it only has to be
/// nearer than anything worth seeing: 1 m over a city, 0.125 m in a room.
pub fn default_near_m(eye_to_target_m: f64) -> f64 {
    (eye_to_target_m / 512.0).clamp(0.125, 1.0)
}
