// Deferred shading of the shown surface, and what the lenses make of it.
//
// The operations of all lenses stand in one list, bottom lens first (L6). `apply` is put together
// from the effects that this scene uses, so an effect nobody asked for is not in the shader (U3).

override LENSES: bool = false;      // whether this part of the picture meets a lens
override SMOOTH: bool = false;      // whether normals are in the target, not with the surfaces
override TEXTURED: bool = false;    // whether base colours are in a target of their own
override CLAY: bool = false;        // one colour for everything
override OUTLINES: bool = false;    // whether some lens shows its silhouette
override MASK_LAYERS: u32 = 3u;     // per 32 lenses: 3 = inside, in front, behind; 1 = inside is all that is asked for
override HAZE: bool = false;        // whether the air shows
override SUMMED: bool = false;      // weighted by coverage, to be summed over samples

struct Parameters {
    a: vec4f,
    b: vec4f,
}

struct Operation {
    effect: u32,                // EFFECT_*, or OUTLINE
    lens: u32,                  // from 0; CONTEXT = everywhere
    class_: u32,                // INSIDE, FRONT, BEHIND, REST
    reserved: u32,
    parameters: Parameters,
}

struct Operations {
    count: u32,
    list: array<Operation>,
}

// The shown surface at a pixel; `surface` is NO_SURFACE where there is none (D infinite).
struct Point {
    relative: vec3f,            // to the eye, world axes, metres
    distance: f32,              // D, metres
    normal: vec3f,              // unit, towards the eye
    surface: u32,
    object: u32,                // or NO_OBJECT
    natural: vec3f,             // its own colour, linear
    lit: bool,                  // whether light acts on it
    shade: f32,                 // light on a white surface, 0..1
}

const NO_SURFACE: u32 = 0xffffffffu;
const CONTEXT: u32 = 0xffffffffu;
const FAR_AWAY: f32 = 1e30;
const OUTLINE: u32 = 0xffffu;
const INSIDE: u32 = 0u;
const FRONT: u32 = 1u;
const BEHIND: u32 = 2u;
const REST: u32 = 3u;

@group(1) @binding(6) var codes: texture_2d<u32>;
@group(1) @binding(7) var scene_depth: texture_depth_2d;
@group(1) @binding(8) var colors: texture_2d<f32>;
@group(2) @binding(0) var masks: texture_2d_array<u32>;
@group(2) @binding(1) var<storage, read> operations: Operations;
@group(2) @binding(2) var<storage, read> object_colors: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

fn mask_bit(pixel: vec2i, lens: u32, class_: u32) -> bool {
    let word = textureLoad(masks, pixel, MASK_LAYERS * (lens / 32u) + class_, 0).x;
    return (word >> (lens % 32u) & 1u) == 1u;
}

// A lens of several volumes is in front only before the first, behind only after the last (S5).
fn in_class(pixel: vec2i, lens: u32, class_: u32) -> bool {
    if lens == CONTEXT {
        return true;
    }
    let inside = mask_bit(pixel, lens, INSIDE);
    if MASK_LAYERS == 1u || class_ == INSIDE {
        return inside;
    }
    let front = mask_bit(pixel, lens, FRONT);
    let behind = mask_bit(pixel, lens, BEHIND);
    switch class_ {
        case FRONT: { return front && !behind && !inside; }
        case BEHIND: { return behind && !front && !inside; }
        default: { return !inside && front == behind; }
    }
}

fn covered(pixel: vec2i, lens: u32) -> bool {
    return mask_bit(pixel, lens, INSIDE) || mask_bit(pixel, lens, FRONT) || mask_bit(pixel, lens, BEHIND);
}

// How much of the pixel a line of `width` pixels along the lens' silhouette covers: by the nearest
// pixel of the other state. The cross of far taps settles nearly all pixels.
fn silhouette(pixel: vec2i, lens: u32, width: f32) -> f32 {
    let last = vec2i(view.size) - 1;
    let here = covered(pixel, lens);
    let reach = i32(ceil(0.5 * width + 0.5));
    var nearest = 1e9;
    for (var j = -reach; j <= reach; j++) {
        for (var i = -reach; i <= reach; i++) {
            let other = clamp(pixel + vec2i(i, j), vec2i(0), last);
            if (i != 0 || j != 0) && covered(other, lens) != here {
                nearest = min(nearest, length(vec2f(f32(i), f32(j))));
            }
        }
    }
    return clamp(0.5 * width + 1.0 - nearest, 0.0, 1.0);
}

fn base_color(point: Point, pixel: vec2i) -> vec3f {
    if CLAY {
        return vec3f(0.62, 0.585, 0.54);
    }
    if TEXTURED {
        return textureLoad(colors, pixel, 0).rgb;
    }
    return point.natural;
}

fn point_at(pixel: vec2i, ray: Ray, depth: f32) -> Point {
    let code = textureLoad(codes, pixel, 0).xy;
    var point: Point;
    point.distance = distance_of_depth(depth);
    point.relative = (ray.origin + point.distance * ray.direction) * view.view_from_world;
    point.surface = code.x - 1u;
    let surface = surface_at(point.surface);
    point.normal = decode_normal(select(surface.normal, code.y, SMOOTH));
    if dot(point.normal, ray.direction * view.view_from_world) > 0.0 {
        point.normal = -point.normal;
    }
    point.object = surface.object;
    point.natural = surface.color;
    point.lit = (surface.flags & SURFACE_UNLIT) == 0u;
    return point;
}

fn nowhere() -> Point {
    return Point(vec3f(0.0), FAR_AWAY, vec3f(0.0, 0.0, 1.0), NO_SURFACE, NO_OBJECT, vec3f(0.0), false, 1.0);
}

fn shade(point: ptr<function, Point>, pixel: vec2i) -> vec3f {
    let sun = sun_share((*point).relative, (*point).normal);
    let arriving = irradiance((*point).normal, sun);
    (*point).shade = luminance(arriving);
    let base = base_color(*point, pixel);
    if !CLAY && !(*point).lit {
        return base;
    }
    return base * arriving;
}

//@apply

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let ray = ray_of_pixel(at.xy);
    let depth = textureLoad(scene_depth, pixel, 0);
    var color = vec3f(0.0);
    var alpha = 1.0;
    var point = nowhere();
    if depth > 0.0 {
        point = point_at(pixel, ray, depth);
        color = shade(&point, pixel);
        if HAZE {
            let air = 1.0 - exp(-max(point.distance - light.scene_radius, 0.0) * view.haze);
            color = mix(color, light.horizon, air);
        }
    } else if light.background == 2u {
        alpha = 0.0;
    } else if light.background == 1u {
        color = light.zenith;
    } else {
        color = sky_color(ray.direction * view.view_from_world);
    }
    color = apply(color, point, pixel);
    if LENSES && OUTLINES {
        for (var i = 0u; i < operations.count; i++) {
            let operation = operations.list[i];
            if operation.effect == OUTLINE {
                let share = silhouette(pixel, operation.lens, operation.parameters.b.x);
                let opacity = share * operation.parameters.a.w;
                color = mix(color, operation.parameters.a.rgb, opacity);
                alpha = alpha + (1.0 - alpha) * opacity;
            }
        }
    }
    if SUMMED {
        return vec4f(color * alpha, alpha);
    }
    return vec4f(color, alpha);
}
