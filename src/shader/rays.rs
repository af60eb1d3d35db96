//! Rays of pixels: what their handlers say.

use crate::shader::{
    effect::{
        prototype::{EffectKind, Mode},
        registry::handlers,
    },
    plan::Bends,
};

/// The filling of the hook `ray` (`lib/view.wgsl`): `ray_of_pixel`, and `see_pixel`, which is told before which pixel is looked at, and how far; of rays
/// that are bent `lib/bent-rays.wgsl` has both.
pub(super) fn source(bends: Bends) -> String {
    if bends.is_any() {
        return format!("const RAY_IMAGES: u32 = {}u;\nconst RAY_PLANES: u32 = {}u;\n", bends.images, bends.planes);
    }
    let own = handlers().iter().find(|h| (h.kind, h.mode) == (EffectKind::Ray, Mode::Optional));
    let Some(own) = own else { unreachable!("the program has a ray of its own") };
    let name = own.wgsl_name();
    format!("{}\nfn ray_of_pixel(pixel: vec2f) -> Ray {{\n    return {name}(pixel);\n}}\n{STRAIGHT}", own.source)
}

/// Rays that are not bent are the same all along.
const STRAIGHT: &str = "\n// (x, y, -1) for parallel rays, too.\nfn picture_place(ray: Ray) -> vec3f {\n    return ray.origin + ray.direction;\n}\n\nfn picture_place_at(distance: f32, place: vec3f) -> vec3f {\n    return place;\n}\n\nfn ray_at_distance(pixel: vec2f, distance: f32) -> Ray {\n    return ray_of_pixel(pixel);\n}\n\nfn line_ends(distance: f32) -> f32 {\n    return FAR_AWAY;\n}\n\nfn see_pixel(pixel: vec2f, distance: f32) {}\n\nfn gridded(paint: vec4f, pixel: vec2i) -> vec4f {\n    return paint;\n}\n\nfn most_stretch(pixel: vec2f, reach: f32) -> f32 {\n    return 1.0;\n}\n";
