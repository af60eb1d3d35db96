//! Lens volumes as the shader reads them: relative to the eye, in view space, rounded once from f64.

use glam::{DMat3, DVec2, DVec3};

use crate::{
    geom::{Aabb, Volume},
    render::{eye::PictureTile, layout},
    view::View,
};

/// Pixels around a volume's projection that may still show its outline.
const MARGIN_PX: f64 = 4.0;

/// A volume of one lens.
#[derive(Clone, Debug)]
pub struct LensVolume {
    /// Which lens, from 0.
    pub lens: u32,
    /// The volume, model coordinates; not empty.
    pub volume: Volume,
    /// Box around it, metres.
    pub bounds: Aabb,
    /// Whether its lens acts where rays miss it (class *rest*): then all of the picture is its business.
    pub everywhere: bool,
}

impl LensVolume {
    /// Appends the volume's figures, and its planes, for an eye.
    pub fn push(&self, view: &View, shapes: &mut Vec<layout::Shape>, planes: &mut Vec<[f32; 4]>) {
        let view_from_world = view.basis.view_from_world();
        let eye = view.camera.eye;
        let place = |p: DVec3| (view_from_world * (p - eye)).as_vec3().to_array();
        let turn = |v: DVec3| (view_from_world * v).as_vec3().to_array();
        let mut out = layout::Shape { lens: self.lens, kind: self.kind(), ..Default::default() };
        match &self.volume {
            Volume::Sphere { center, radius } => {
                out.center = place(*center);
                out.size_x = *radius as f32;
            }
            Volume::Box { center, half, rotation } => {
                let axes = DMat3::from_quat(*rotation);
                out.center = place(*center);
                out.axis_x = turn(axes.x_axis);
                out.axis_y = turn(axes.y_axis);
                out.axis_z = turn(axes.z_axis);
                [out.size_x, out.size_y, out.size_z] = half.as_vec3().to_array();
            }
            Volume::Cylinder { center, radius, half, axis } => {
                out.center = place(*center);
                out.axis_z = turn(*axis);
                out.size_x = *radius as f32;
                out.size_z = *half as f32;
            }
            Volume::Convex(hull) => {
                let (center, faces) = hull.planes();
                out.first_plane = planes.len() as u32;
                out.plane_count = faces.len() as u32;
                planes.extend(faces.iter().map(|&(normal, offset)| {
                    let [x, y, z] = turn(normal);
                    [x, y, z, (offset + normal.dot(center - eye)) as f32]
                }));
            }
        }
        shapes.push(out);
    }

    /// The kind of shape, as the shader numbers it.
    pub fn kind(&self) -> u32 {
        match &self.volume {
            Volume::Sphere { .. } => layout::SPHERE,
            Volume::Box { .. } => layout::BOX,
            Volume::Cylinder { .. } => layout::CYLINDER,
            Volume::Convex(_) => layout::CONVEX,
        }
    }

    /// The part of the tile it may touch, outline included; `None` where it cannot be seen.
    pub fn screen_bounds(&self, view: &View, tile: PictureTile) -> Option<PictureTile> {
        if self.everywhere {
            return Some(PictureTile::whole(tile.size));
        }
        if self.bounds.is_empty() || !view.frustum(MARGIN_PX).meets(&self.bounds) {
            return None;
        }
        let corners = self.bounds.corners();
        let near = view.camera.near_m;
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        for corner in corners {
            match view.pixel(corner).filter(|p| view.is_orthographic() || p.z > near) {
                Some(p) => {
                    low = low.min(p.truncate());
                    high = high.max(p.truncate());
                }
                // A corner beside or behind the eye: its projection bounds nothing.
                None => return Some(tile).map(|t| PictureTile { origin: [0, 0], size: t.size }),
            }
        }
        let origin = DVec2::new(tile.origin[0].into(), tile.origin[1].into());
        let size = DVec2::new(tile.size[0].into(), tile.size[1].into());
        let low = (low - origin - MARGIN_PX).floor().clamp(DVec2::ZERO, size);
        let high = (high - origin + MARGIN_PX).ceil().clamp(DVec2::ZERO, size);
        let extent = high - low;
        (extent.x > 0.0 && extent.y > 0.0)
            .then_some(PictureTile { origin: [low.x as u32, low.y as u32], size: [extent.x as u32, extent.y as u32] })
    }
}
