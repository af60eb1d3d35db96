//! The three axes of an eye.

use glam::{DMat3, DVec3};

use crate::view::camera::{Camera, CameraError};

/// Below this sine of the angle between view and reference up they count as parallel.
/// f64 still gives `right` to ten digits here; a user's 0.1° off the vertical is far above it.
const PARALLEL: f64 = 1e-6;

/// Orthonormal axes in model coordinates; `right × up = -forward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// To the right of the picture.
    pub right: DVec3,
    /// To its top.
    pub up: DVec3,
    /// Into it, along the view axis.
    pub forward: DVec3,
}

impl Basis {
    /// Axes for looking along `forward` (unit).
    ///
    /// Where `reference_up` is zero or parallel to the view, the world's north (+y) takes its place, and where that
    /// is parallel too, the world's east (+x): a camera looking straight down has north at the top.
    pub fn looking_along(forward: DVec3, reference_up: DVec3) -> Self {
        let right = [reference_up, DVec3::Y, DVec3::X]
            .into_iter()
            .filter_map(DVec3::try_normalize)
            .map(|up| forward.cross(up))
            .find(|side| side.length() > PARALLEL)
            .and_then(DVec3::try_normalize)
            .unwrap_or(DVec3::X);
        Self { right, up: right.cross(forward), forward }
    }

    /// Rotates a model direction into view space: x right, y up, z backward.
    pub fn view_from_world(&self) -> DMat3 {
        DMat3::from_cols(self.right, self.up, -self.forward).transpose()
    }
}

impl Camera {
    /// The camera's axes; an error where [`Camera::check`] has one.
    pub fn basis(&self) -> Result<Basis, CameraError> {
        self.check()?;
        let forward = (self.target - self.eye)
            .try_normalize()
            .ok_or(CameraError::EyeIsTarget(self.eye.x, self.eye.y, self.eye.z))?;
        Ok(Basis::looking_along(forward, self.up))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn straight_down_has_north_on_top_and_east_right() {
        let down = Basis::looking_along(-DVec3::Z, DVec3::Z);
        assert_eq!((down.right, down.up), (DVec3::X, DVec3::Y));
        let up = Basis::looking_along(DVec3::Z, DVec3::Z);
        assert_eq!((up.right, up.up), (-DVec3::X, DVec3::Y));
    }

    #[test]
    fn looking_north_with_up_north_takes_east() {
        let basis = Basis::looking_along(DVec3::Y, DVec3::Y);
        assert_eq!(basis.up, DVec3::X);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn axes_are_orthonormal_and_right_handed(f in prop::array::uniform3(-1.0..1.0f64), u in prop::array::uniform3(-1.0..1.0f64)) {
            let Some(forward) = DVec3::from(f).try_normalize() else { return Ok(()) };
            let b = Basis::looking_along(forward, DVec3::from(u));
            for (a, c) in [(b.right, b.up), (b.up, b.forward), (b.forward, b.right)] {
                prop_assert!(a.dot(c).abs() < 1e-9);
            }
            prop_assert!((b.right.length() - 1.0).abs() < 1e-12 && (b.up.length() - 1.0).abs() < 1e-9);
            prop_assert!((b.right.cross(b.up) + b.forward).length() < 1e-9);
            prop_assert!(b.up.dot(DVec3::from(u)) >= -1e-9);
        }
    }
}
