//! Where the shapes of lenses stand in a frame: in the world, at what they are attached to, or before the camera.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::{
    city::CityModel,
    geom::{
        Aabb,
        shape::{Motion, Sightlines},
    },
    lens::Lens,
    scene::{Scene, anchor::anchor},
    view::{Basis, Camera, CameraError, Projection},
    visibility::Viewer,
};

/// The eye of the view that lenses are placed for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    at: DVec3,
    basis: Basis,
    is_orthographic: bool,
}

impl Eye {
    pub(super) fn new(camera: &Camera) -> Result<Self, CameraError> {
        let is_orthographic = matches!(camera.projection, Projection::Orthographic { .. });
        Ok(Self { at: camera.eye, basis: camera.basis()?, is_orthographic })
    }

    /// What flat lenses are looked through along.
    pub(super) fn sight(&self) -> Sightlines {
        if self.is_orthographic { Sightlines::Along(self.basis.forward) } else { Sightlines::From(self.at) }
    }

    /// From where occluders are looked for.
    pub(super) fn viewer(&self) -> Viewer {
        Viewer { eye: self.at, along: self.is_orthographic.then_some(self.basis.forward) }
    }

    /// Where a box is in the picture: the rectangle around it (low x, low y, high x, high y), in tangents of the view, or in metres
    /// where rays are parallel; the distance of its farthest corner along the view axis, metres; and how many metres one unit of the
    /// rectangle is at its middle. Corners behind the eye are taken as a millimetre before it.
    pub(super) fn rectangle(&self, bounds: &Aabb) -> [f32; 6] {
        let to_view = self.basis.view_from_world();
        let seen = |p: DVec3| {
            let view = to_view * (p - self.at);
            let distance = (-view.z).max(1e-3);
            (view.truncate() / if self.is_orthographic { 1.0 } else { distance }, distance)
        };
        let corners = bounds.corners().map(seen);
        let low = corners.iter().fold(DVec2::INFINITY, |low, (p, _)| low.min(*p));
        let high = corners.iter().fold(DVec2::NEG_INFINITY, |high, (p, _)| high.max(*p));
        let far = corners.iter().fold(0.0, |far: f64, (_, distance)| far.max(*distance));
        let metres = if self.is_orthographic { 1.0 } else { seen(bounds.center()).1 };
        [low.x, low.y, high.x, high.y, far, metres].map(|x| x as f32)
    }

    /// From the camera's coordinates (x right, y up, −z forward) to the model's.
    pub(super) fn own_motion(&self) -> Motion {
        let Basis { right, up, forward } = self.basis;
        let world_from_camera = DMat3::from_cols(right, up, -forward);
        let rotation = DQuat::from_mat3(&world_from_camera).normalize();
        Motion { rotation, translation: self.at }
    }

    /// From a lens' own coordinates to the model's; `None` where what it is attached to is not there:
    /// [`crate::scene::check_against`] says so.
    pub(super) fn motion(&self, lens: &Lens, scene: &Scene, model: &CityModel) -> Option<Motion> {
        if lens.is_of_camera() {
            return Some(self.own_motion());
        }
        Some(match anchor(&lens.placement, scene, model).ok()?? {
            DVec3::ZERO => Motion::NONE,
            translation => Motion { rotation: DQuat::IDENTITY, translation },
        })
    }
}
