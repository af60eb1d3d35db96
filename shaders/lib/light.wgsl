// Sun, sky and what the ground throws back. Linear light; a white wall in full sun comes out just below 1.

struct Light {
    to_sun: vec3f,              // unit, world axes
    shadow_scale: f32,          // share of the first level's side that a metre is
    sun: vec3f,
    shadow_depth_step: f32,     // metres that one unit of shadow depth spans
    sky: vec3f,
    shadow_levels: f32,         // a whole number: where the levels grow from, in 64ths of their sides, x and from bit 8 on y; from bit 16 on how
                                // much wider each is than the last
    ground: vec3f,
    reserved_1: f32,
    // From positions relative to the eye: right and down from where the levels grow from, as the sun sees it, metres; depth as
    // the map stores it.
    sun_from_relative: mat4x4f,
    zenith: vec3f,              // the sky picture, linear; or the one colour of the background
    reserved_2: u32,
    horizon: vec3f,
    scene_radius: f32,          // metres
}

@group(1) @binding(4) var shadow_map: texture_depth_2d;
@group(1) @binding(5) var shadow_sampler: sampler_comparison;

// The least cosine of the angle between a normal and its face's that a push makes up for: more would be seen at the feet of walls.
const LEAST_ALONG: f32 = 0.7;

// A software adapter runs both sides of every branch, so what is known before is a constant of the pipeline.
override SHADOWS: bool = false;

// Share of the sun that arrives, 0..1: four bilinear comparisons, pushed along the normal so that a surface does not shade itself;
// farther where it is aslant, or the face is that is shaded by another normal than its own; the filter turns from sample to sample, which softens the border.
//
// The map has one level, or four, two by two, each wider than the one before; the first that holds a place has its smallest texels.
fn sun_share(relative: vec3f, normal: vec3f, face: vec3f) -> f32 {
    if !SHADOWS {
        return 1.0;
    }
    let across = (light.sun_from_relative * vec4f(relative, 1.0)).xyz;
    let push = (light.sun_from_relative * vec4f(normal, 0.0)).xyz;
    let levels = u32(light.shadow_levels);
    let shift = vec2f(vec2u(levels, levels >> 8u) & vec2u(0xffu)) * (1.0 / 64.0);
    let ratio = f32(levels >> 16u);
    let side = select(0.5, 1.0, ratio == 1.0);                          // of a level, of the map's
    let texel = 1.0 / (f32(textureDimensions(shadow_map).x) * side);   // of a level's side
    let wider = 1.0 / ratio;
    var scale = light.shadow_scale;
    var level = 0u;
    for (var i = 0; i < 3; i++) {
        let aside = abs(across.xy * scale + (shift - 0.5));
        let is_outside = ratio > 1.0 && max(aside.x, aside.y) > 0.5 - 5.0 * texel;
        scale *= select(1.0, wider, is_outside);
        level += select(0u, 1u, is_outside);
    }
    let metres = texel / scale;
    let slant = 1.0 - max(min(dot(normal, light.to_sun), dot(face, light.to_sun)), 0.0);
    // What is pushed along another normal leaves the face by less.
    let aside = select(1.0 / clamp(dot(normal, face), LEAST_ALONG, 1.0), 1.0, all(normal == face));
    let start = across + push * (metres * aside * (0.6 + 1.8 * slant));
    let local = start.xy * scale + shift;
    if any(local < vec2f(0.0)) || any(local > vec2f(1.0)) {
        return 1.0;
    }
    let at = (vec2f(f32(level & 1u), f32(level >> 1u)) + local) * side;
    let depth = start.z + 0.35 * metres / light.shadow_depth_step;
    let angle = 2.399963 * f32(view.sample_index);
    let turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle)) * (1.3 * texel * side);
    var share = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = turn * vec2f(f32(i & 1) - 0.5, f32(i >> 1) - 0.5);
        share += textureSampleCompareLevel(shadow_map, shadow_sampler, at + offset, depth);
    }
    return 0.25 * share;
}

// Light that falls on a surface (irradiance over pi), without its own colour.
fn irradiance(normal: vec3f, sun: f32) -> vec3f {
    let up = 0.5 + 0.5 * normal.z;
    let ambient = mix(light.ground, light.sky, up);
    return ambient + light.sun * (max(dot(normal, light.to_sun), 0.0) * sun);
}

// The sky behind the city.
override BACKGROUND: u32 = 0u;

const SKY: u32 = 0u;
const ONE_COLOR: u32 = 1u;
const NOTHING: u32 = 2u;

fn sky_color(direction: vec3f) -> vec3f {
    let height = clamp(direction.z * inverseSqrt(dot(direction, direction)), 0.0, 1.0);
    let low = 1.0 - height;
    return mix(light.horizon, light.zenith, 1.0 - low * low);
}
