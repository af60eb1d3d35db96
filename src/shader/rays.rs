//! Rays of pixels: what their handlers say.

use crate::shader::effect::{
    prototype::{EffectKind, Mode},
    registry::handlers,
};

/// The filling of the hook `ray` (`lib/view.wgsl`): `ray_of_pixel`.
pub(super) fn source() -> String {
    let own = handlers().iter().find(|h| (h.kind, h.mode) == (EffectKind::Ray, Mode::Optional));
    let Some(own) = own else { unreachable!("the program has a ray of its own") };
    let name = own.wgsl_name();
    format!("{}\nfn ray_of_pixel(pixel: vec2f) -> Ray {{\n    return {name}(pixel);\n}}\n", own.source)
}
