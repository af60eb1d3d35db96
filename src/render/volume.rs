//! Lens volumes as the shader reads them: relative to the eye, in view space, rounded once from f64.

use glam::{DMat3, DVec2, DVec3};

use crate::{
    geom::{Aabb, Shape},
    render::{eye::PictureTile, layout},
    view::View,
};

/// `lib/shape.wgsl`.
const SPHERE: u32 = 0;
const BOX: u32 = 1;
const CYLINDER: u32 = 2;
const CONVEX: u32 = 3;

/// Pixels around a volume's projection that may still show its outline.
const MARGIN_PX: f64 = 4.0;

/// A volume of one lens.
#[derive(Clone, Debug)]
pub struct Volume {
    /// Which lens, from 0.
    pub lens: u32,
    /// The volume, model coordinates.
    pub shape: Shape,
    /// Its faces where it is convex: unit normal and offset in model coordinates, inside where n·p ≤ d.
    pub planes: Vec<(DVec3, f64)>,
    /// Box around it, metres.
    pub bounds: Aabb,
}

impl Volume {
    /// Appends the volume's figures, and its planes, for an eye.
    pub fn push(&self, view: &View, shapes: &mut Vec<layout::Shape>, planes: &mut Vec<[f32; 4]>) {
        let view_from_world = view.basis.view_from_world();
        let eye = view.camera.eye;
        let place = |p: DVec3| (view_from_world * (p - eye)).as_vec3().to_array();
        let turn = |v: DVec3| (view_from_world * v).as_vec3().to_array();
        let mut out = layout::Shape { lens: self.lens, ..Default::default() };
        match &self.shape {
            Shape::Sphere { center, radius } => {
                out.kind = SPHERE;
                out.center = place(*center);
                out.size_x = *radius as f32;
            }
            Shape::Box { center, size, rotation } => {
                let axes = DMat3::from_quat(*rotation);
                out.kind = BOX;
                out.center = place(*center);
                out.axis_x = turn(axes.x_axis);
                out.axis_y = turn(axes.y_axis);
                out.axis_z = turn(axes.z_axis);
                [out.size_x, out.size_y, out.size_z] = (*size * 0.5).as_vec3().to_array();
            }
            Shape::Cylinder { center, radius, height, axis } => {
                out.kind = CYLINDER;
                out.center = place(*center);
                out.axis_z = turn(*axis);
                out.size_x = *radius as f32;
                out.size_z = (0.5 * height) as f32;
            }
            Shape::Convex { .. } => {
                out.kind = CONVEX;
                out.first_plane = planes.len() as u32;
                out.plane_count = self.planes.len() as u32;
                planes.extend(self.planes.iter().map(|&(normal, offset)| {
                    let [x, y, z] = turn(normal);
                    [x, y, z, (offset - normal.dot(eye)) as f32]
                }));
            }
        }
        shapes.push(out);
    }

    /// The part of the tile it may touch, outline included; `None` where it cannot be seen.
    pub fn screen_bounds(&self, view: &View, tile: PictureTile) -> Option<PictureTile> {
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
        (extent.x > 0.0 && extent.y > 0.0).then(|| PictureTile {
            origin: [low.x as u32, low.y as u32],
            size: [extent.x as u32, extent.y as u32],
        })
    }
}
