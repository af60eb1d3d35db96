//! Rays of pixels: what their handlers say.

use crate::shader::effect::{
    prototype::{EffectKind, Mode},
    registry::handlers,
};

/// The filling of the hook `ray` (`lib/view.wgsl`): `ray_of_pixel`, and `look_at_distance`, which says at which distance what is looked at is; of rays
/// that are bent `lib/bent-rays.wgsl` has both.
pub(super) fn source(bends: bool) -> String {
    if bends {
        return String::new();
    }
    let own = handlers().iter().find(|h| (h.kind, h.mode) == (EffectKind::Ray, Mode::Optional));
    let Some(own) = own else { unreachable!("the program has a ray of its own") };
    let name = own.wgsl_name();
    format!("{}\nfn ray_of_pixel(pixel: vec2f) -> Ray {{\n    return {name}(pixel);\n}}\n{STRAIGHT}", own.source)
}

/// Rays that are not bent are the same all along.
const STRAIGHT: &str = "\nfn look_at_distance(distance: f32) {}\n\nfn may_bend(pixel: vec2f, reach: f32) -> bool {\n    return false;\n}\n";
