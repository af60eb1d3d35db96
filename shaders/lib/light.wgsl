// Sun, sky and what the ground throws back. Linear light; a white wall in full sun comes out just below 1.

struct Light {
    to_sun: vec3f,              // unit, world axes
    shadow_texel: f32,          // metres per shadow-map texel; 0 = no shadow map
    sun: vec3f,
    shadow_depth_step: f32,     // metres that one unit of shadow depth spans
    sky: vec3f,
    reserved_0: f32,
    ground: vec3f,
    reserved_1: f32,
    // Shadow map from positions relative to the eye: u, v in 0..1, depth as the map stores it.
    shadow_from_relative: mat4x4f,
    zenith: vec3f,              // the sky picture, linear; or the one colour of the background
    reserved_2: u32,
    horizon: vec3f,
    scene_radius: f32,          // metres
}

@group(1) @binding(4) var shadow_map: texture_depth_2d;
@group(1) @binding(5) var shadow_sampler: sampler_comparison;

// A software adapter runs both sides of every branch, so what is known before is a constant of the pipeline.
override SHADOWS: bool = false;

// Share of the sun that arrives, 0..1: four bilinear comparisons, pushed along the normal so that a
// surface does not shade itself; the filter turns from sample to sample, which softens the border.
fn sun_share(relative: vec3f, normal: vec3f) -> f32 {
    if !SHADOWS {
        return 1.0;
    }
    let slant = 1.0 - max(dot(normal, light.to_sun), 0.0);
    let start = relative + normal * light.shadow_texel * (0.6 + 1.8 * slant);
    let at = light.shadow_from_relative * vec4f(start, 1.0);
    if any(at.xy < vec2f(0.0)) || any(at.xy > vec2f(1.0)) {
        return 1.0;
    }
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    let depth = at.z + 0.35 * light.shadow_texel / light.shadow_depth_step;
    let angle = 2.399963 * f32(view.sample_index);
    let turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle));
    var share = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = turn * vec2f(f32(i & 1) - 0.5, f32(i >> 1) - 0.5) * 1.3;
        share += textureSampleCompareLevel(shadow_map, shadow_sampler, at.xy + offset * texel, depth);
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
