//! Places in the window and in the picture.

use crate::view::View;
use eframe::egui::{Pos2, Rect, vec2};
use glam::{DVec2, DVec3};

/// A place of the window in its picture, points from the upper left.
pub(super) fn in_rect(rect: Rect, at: Pos2) -> DVec2 {
    let off = at - rect.min;
    DVec2::new(f64::from(off.x), f64::from(off.y))
}

/// Where a place is shown in the window; `None`: behind the eye.
pub(super) fn spot_of(view: &View, rect: Rect, place: DVec3) -> Option<Pos2> {
    view.pixel(place).map(|pixel| rect.min + vec2(pixel.x as f32, pixel.y as f32))
}
