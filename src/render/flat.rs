//! Flat lenses in the view that they are looked through in: their figures for the shader, and where they are seen.

use glam::DVec3;

use crate::{
    geom::shape::{Flat, FlatFigure},
    render::{layout, volume::along},
    view::View,
};

/// `figure` of `shape/flat.wgsl`.
const DISC: f32 = 0.0;
const RECTANGLE: f32 = 1.0;
const POLYGON: f32 = 2.0;

/// The projective map from the picture to the figure's plane, as `span_of_flat` reads it, and the figure; the sides of a polygon
/// are appended to `planes`.
pub(super) fn figures(flat: &Flat, view: &View, out: &mut layout::Region, planes: &mut Vec<[f32; 4]>) {
    let view_from_world = view.basis.view_from_world();
    let axes = view_from_world * flat.axes();
    let (normal, center) = (axes.z_axis, view_from_world * (flat.center() - view.camera.eye));
    let side = flat.side();
    // Where the plane is crossed, times the weight w = axis_z.a: all have the sign that makes w positive.
    let (weight, depth, across): (DVec3, DVec3, [DVec3; 2]) = if view.is_orthographic() {
        // Rays begin at (x, y, 0) and go along -z; the axes sheared along them into the picture's plane.
        let slope = -normal.z;
        let sheared = [axes.x_axis, axes.y_axis].map(|axis| axis * slope + normal * axis.z);
        (
            DVec3::new(0.0, 0.0, -slope),
            DVec3::new(-normal.x, -normal.y, -normal.dot(center)),
            sheared.map(|axis| DVec3::new(axis.x, axis.y, axis.dot(center))),
        )
    } else {
        let reach = normal.dot(center);
        let turned = [axes.x_axis, axes.y_axis].map(|axis| axis * reach - normal * axis.dot(center));
        (normal, DVec3::new(0.0, 0.0, -reach), turned)
    };
    let signed = |v: DVec3| (side * v).as_vec3();
    let (size, kind) = match flat.figure() {
        FlatFigure::Disc { radius } => ([*radius as f32, 0.0], DISC),
        FlatFigure::Rectangle { size } => ((0.5 * *size).as_vec2().to_array(), RECTANGLE),
        FlatFigure::Polygon { points } => {
            let size = [planes.len() as f32, points.len() as f32];
            let next = points.iter().cycle().skip(1);
            planes.extend(points.iter().zip(next).map(|(a, b)| {
                let ([x, y], [z, w]) = (a.as_vec2().to_array(), b.as_vec2().to_array());
                [x, y, z, w]
            }));
            (size, POLYGON)
        }
    };
    out.a = signed(depth).to_array();
    out.b = signed(across[0]).extend(size[0]).to_array();
    out.c = signed(across[1]).extend(size[1]).to_array();
    out.d = signed(weight).extend(kind).to_array();
}

/// The least and the most of x, y, x + y and x - y, pixels, of what is looked through; else whether it may be anywhere: it
/// reaches beside the eye, or else lies wholly behind it. It may lie before the near plane, or behind an orthographic eye: what
/// it holds does not.
pub(super) fn projected(flat: &Flat, view: &View) -> Result<([f64; 4], [f64; 4]), bool> {
    let corners = flat.corners_of_bounds();
    let pixels = corners.map(|corner| view.pixel(corner));
    if pixels.iter().all(Option::is_none) {
        return Err(false);
    }
    let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
    for pixel in pixels {
        let at = along(pixel.ok_or(true)?.truncate());
        for (i, at) in at.into_iter().enumerate() {
            (low[i], high[i]) = (low[i].min(at), high[i].max(at));
        }
    }
    Ok((low, high))
}
