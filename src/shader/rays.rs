//! Rays of pixels: what their handlers say.

use crate::shader::{
    effect::{
        definition::EffectDefinition,
        prototype::{EffectKind, Mode},
        registry::handlers,
    },
    plan::Bends,
};

/// The filling of the hook `ray` (`lib/view.wgsl`): `ray_of_pixel`, and `see_pixel`, which is told before which pixel is looked at, and how far; of rays
/// that are bent `lib/bent-rays.wgsl` has both.
pub(super) fn source(bends: Bends, is_carried: bool) -> String {
    if bends.is_any() {
        let Bends { images, planes, grids, fields, choosing, own } = bends;
        let lenses = if is_carried && bends.is_one() { CARRIED } else { IN_UNIFORM };
        let grids = if grids { "" } else { NO_GRIDS };
        let acting = if choosing > 0 { ON_SOME } else { ON_ALL };
        let own = own_rays(&own);
        return format!(
            "const RAY_IMAGES: u32 = {images}u;\nconst RAY_PLANES: u32 = {planes}u;\nconst RAY_CHOOSING: u32 = {choosing}u;\nconst RAY_FIELDS: bool = {fields};\n{lenses}{acting}{own}{grids}"
        );
    }
    let own = handlers().iter().find(|h| (h.kind, h.mode) == (EffectKind::Ray, Mode::Optional));
    let Some(own) = own else { unreachable!("the program has a ray of its own") };
    let name = own.wgsl_name();
    format!(
        "{}\nfn ray_of_pixel(pixel: vec2f) -> Ray {{
    let is_flat = view.orthographic == 1u;
    let across = pixel * view.across_from_pixel.xy + view.across_from_pixel.zw;
    let seen = {name}(across, vec3f(1.0, 1.0, select(1.0, 0.0, is_flat)));
    return Ray(vec3f(select(vec2f(0.0), seen.xy, is_flat), 0.0), vec3f(select(seen.xy, vec2f(0.0), is_flat), -seen.z));
}}\n{STRAIGHT}{NO_GRIDS}",
        own.source
    )
}

/// What is seen at a place of a lens with a handler of its user's, of the handlers of these numbers.
fn own_rays(numbers: &[u16]) -> String {
    let all = handlers();
    let used = || numbers.iter().filter(|number| **number > 0).map(|number| (number, &all[usize::from(*number)]));
    let sources: String = used().map(|(_, handler)| format!("{}\n", handler.source)).collect();
    let call = |handler: &EffectDefinition| {
        let parameters = match handler.slots() {
            0 => String::new(),
            _ => format!(", {}(ray_lens(lens).first_knot)", handler.own("parameters")),
        };
        format!("{}(place, size{parameters})", handler.wgsl_name())
    };
    let all: Vec<_> = used().collect();
    let body = match all[..] {
        [] => "    return vec3f(place, 1.0);\n".to_owned(),
        [(_, only)] => format!("    return {};\n", call(only)),
        _ => {
            let case = |(number, handler): &(&u16, &EffectDefinition)| {
                format!("        case {number}u: {{ return {}; }}\n", call(handler))
            };
            let cases: String = all.iter().map(case).collect();
            format!(
                "    switch ray_lens(lens).knots {{\n{cases}        default: {{ return vec3f(place, 1.0); }}\n    }}\n"
            )
        }
    };
    let has = !all.is_empty();
    format!(
        "\nconst HAS_OWN_RAYS = {has};\n\n{sources}fn said_of_place(lens: u32, place: vec2f, size: vec3f) -> vec3f {{\n{body}}}\n"
    )
}

/// Where all lenses act on all.
const ON_ALL: &str = "
fn acts(number: u32) -> bool {
    return true;
}

fn see_object(object: u32) {}

fn see_set(which: u32) {}

fn is_in_set(object: u32) -> bool {
    return true;
}
";

/// Where some act on some objects alone. A set is which of these do.
const ON_SOME: &str = "
// The lenses that act on what is looked at, a bit for each.
var<private> acting: u32;

fn acts(number: u32) -> bool {
    return (acting >> number & 1u) != 0u;
}

fn marks_of(number: u32) -> u32 {
    return ray_lenses.chosen[number / 4u][number % 4u];
}

fn lenses_that_act_on(object: u32) -> u32 {
    var found = 0u;
    for (var number = 0u; number < RAY_IMAGES + RAY_PLANES; number++) {
        let first = marks_of(number);
        let is_acting = first == 0u || is_chosen(max(first, 1u) - 1u, object);
        found |= select(0u, 1u << number, is_acting);
    }
    return found;
}

fn see_object(object: u32) {
    acting = lenses_that_act_on(object);
}

// Of the lenses that choose those act whose bits are set.
fn see_set(which: u32) {
    acting = 0u;
    var bit = 0u;
    for (var number = 0u; number < RAY_IMAGES + RAY_PLANES; number++) {
        let chooses = marks_of(number) != 0u;
        let is_acting = !chooses || (which >> bit & 1u) != 0u;
        acting |= select(0u, 1u << number, is_acting);
        bit += select(0u, 1u, chooses);
    }
}

fn is_in_set(object: u32) -> bool {
    return lenses_that_act_on(object) == acting;
}
";

/// Where no lens has a grid.
const NO_GRIDS: &str = "\nfn gridded(paint: vec4f, pixel: vec2i) -> vec4f {\n    return paint;\n}\n";

/// Lenses, and what happens along the view axis, where several are, or fragments read uniforms where they stand.
const IN_UNIFORM: &str = "
fn ray_lens(number: u32) -> RayLens {
    return ray_lenses.lenses[number];
}

fn ray_event(number: u32) -> RayEvent {
    return ray_lenses.along[number];
}

fn take_ray_lens(a: vec4f, b: vec4f, c: vec4f, d: vec4u) {}
";

/// One lens that is carried to fragments: `pass/shade.wgsl` says why. Its plane is met, and then the ray goes on.
const CARRIED: &str = "
var<private> only_ray_lens: RayLens;

fn ray_lens(number: u32) -> RayLens {
    return only_ray_lens;
}

fn ray_event(number: u32) -> RayEvent {
    return RayEvent(select(only_ray_lens.distance, only_ray_lens.until, number == 1u), RAY_IMAGES, number, 0u);
}

fn take_ray_lens(a: vec4f, b: vec4f, c: vec4f, d: vec4u) {
    only_ray_lens = RayLens(a.xy, a.z, a.w, b.x, b.y, b.z, d.x, d.y, d.z, d.w, b.w, c.xyz, c.w);
}
";

/// Vectors that a lens takes where it is carried.
pub(super) const CARRIED_VECTORS: u32 = 4;

/// Members of a struct that is handed to fragments, from that location on; what fills them in a vertex shader; what takes them.
pub(super) fn carried(first: u32) -> [String; 3] {
    let kinds = ["vec4f", "vec4f", "vec4f", "vec4u"];
    let member = |(i, (kind, name)): (u32, (&str, char))| {
        format!("    @location({}) @interpolate(flat, either) ray_{name}: {kind},\n", first + i)
    };
    let members = (0..).zip(kinds.into_iter().zip('a'..)).map(member).collect();
    [members, FILLED.to_owned(), "    take_ray_lens(in.ray_a, in.ray_b, in.ray_c, in.ray_d);\n".to_owned()]
}

const FILLED: &str = "    let ray_lens_0 = ray_lenses.lenses[0];
    (*corner).ray_a = vec4f(ray_lens_0.center, ray_lens_0.radius, ray_lens_0.border);
    (*corner).ray_b = vec4f(ray_lens_0.distance, ray_lens_0.until, ray_lens_0.power, ray_lens_0.angle);
    (*corner).ray_c = vec4f(ray_lens_0.color, ray_lens_0.grid);
    (*corner).ray_d = vec4u(ray_lens_0.kind, ray_lens_0.outline, ray_lens_0.first_knot, ray_lens_0.knots);
";

/// The same where there is no room to carry it.
pub(super) const TAKEN_FROM_UNIFORM: &str = "    let ray_lens_0 = ray_lenses.lenses[0];
    take_ray_lens(vec4f(ray_lens_0.center, ray_lens_0.radius, ray_lens_0.border),
                  vec4f(ray_lens_0.distance, ray_lens_0.until, ray_lens_0.power, ray_lens_0.angle),
                  vec4f(ray_lens_0.color, ray_lens_0.grid),
                  vec4u(ray_lens_0.kind, ray_lens_0.outline, ray_lens_0.first_knot, ray_lens_0.knots));
";

/// Rays that are not bent are the same all along.
const STRAIGHT: &str = "\n// (x, y, -1) for parallel rays, too.\nfn picture_place(ray: Ray) -> vec3f {\n    return ray.origin + ray.direction;\n}\n\nfn picture_place_at(distance: f32, place: vec3f) -> vec3f {\n    return place;\n}\n\nfn ray_at_distance(pixel: vec2f, distance: f32) -> Ray {\n    return ray_of_pixel(pixel);\n}\n\nfn line_ends(pixel: vec2f, distance: f32) -> f32 {\n    return FAR_AWAY;\n}\n\nfn see_pixel(pixel: vec2f, distance: f32) {}\n\nfn see_object(object: u32) {}\n\nfn most_stretch(pixel: vec2f, reach: f32, distance: f32) -> f32 {\n    return 1.0;\n}\n";
