//! Flat lenses in the view that they are looked through in: where they are seen.

use crate::{geom::shape::Flat, render::volume::along, view::View};

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
