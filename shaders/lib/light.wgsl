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
    fade_width: f32,            // metres from `fade` at which nothing is left of the plain ground
    // From positions relative to the eye: right and down from where the levels grow from, as the sun sees it, metres; depth as
    // the map stores it.
    sun_from_relative: mat4x4f,
    zenith: vec3f,              // the sky picture, linear; or the one colour of the background
    reserved_2: u32,
    horizon: vec3f,
    scene_radius: f32,          // metres
    // Of the point of the sky that the sample looks from, as the sun's.
    to_sky: vec3f,
    sky_scale: f32,
    sky_depth_step: f32,
    sky_levels: f32,
    sky_weight: f32,            // the solid angle that it stands for, over pi and over the sample's share
    sky_spread: f32,            // how far around it filters look, as a tangent
    sky_from_relative: mat4x4f,
    fade: vec4f,                // the rectangle from which on the plain ground fades: its middle, relative to the eye, and half its sides, metres
}

@group(1) @binding(4) var shadow_map: texture_depth_2d;
@group(1) @binding(5) var shadow_sampler: sampler_comparison;
@group(1) @binding(10) var sky_map: texture_depth_2d;
@group(1) @binding(11) var sky_in_picture: texture_2d<f32>;   // share of the sky, stored depth; at half the resolution

// The least cosine of the angle between a normal and its face's that a push makes up for: more would be seen at the feet of walls.
const LEAST_ALONG: f32 = 0.7;

// A software adapter runs both sides of every branch, so what is known before is a constant of the pipeline.
override SHADOWS: bool = false;
override SKY_SHADOWS: bool = false;
override SCREEN_OCCLUSION: bool = false;

// How a map of depth from a light is read; members as those of Light.
struct LightMap {
    from_relative: mat4x4f,
    to_light: vec3f,
    scale: f32,
    depth_step: f32,
    levels: f32,
}

// Share of the sun that arrives, 0..1.
fn sun_share(relative: vec3f, normal: vec3f, face: vec3f) -> f32 {
    if !SHADOWS {
        return 1.0;
    }
    let map = LightMap(light.sun_from_relative, light.to_sun, light.shadow_scale, light.shadow_depth_step, light.shadow_levels);
    return share_in(shadow_map, place_in(shadow_map, map, relative, normal, face));
}

// Light of the sky that arrives from the sample's point of it, as a multiple of what falls on a surface that faces it, of the whole sky: the
// mean over all samples is the share of the sky that is seen, each part weighted by its cosine. Where the picture tells it, that share itself.
var<private> sky_arriving: f32 = 1.0;

// A bound of what a sample may be brighter than its picture: a few points of the sky give walls all their light.
fn headroom() -> f32 {
    return select(1.0, 4.0, SKY_SHADOWS);
}

// Finds it for a place.
fn see_sky(relative: vec3f, normal: vec3f, face: vec3f) {
    if !SKY_SHADOWS {
        return;
    }
    let map = LightMap(light.sky_from_relative, light.to_sky, light.sky_scale, light.sky_depth_step, light.sky_levels);
    let place = place_in(sky_map, map, relative, normal, face);
    var distance = 0.0;
    // What is shaded by another normal lies in no plane that is known.
    if all(normal == face) {
        distance = distance_in_cone(sky_map, place, light.sky_spread);
    }
    var share = 1.0;
    if distance > 0.0 {
        share = share_in_disc(sky_map, place, max(light.sky_spread * distance, 0.5 * FILTER_TEXELS * place.texel));
    } else {
        share = share_in(sky_map, place);
    }
    sky_arriving = share * light.sky_weight;
}

// Finds it for what a pixel shows, in a picture of one sample: of the four nearest texels those that lie in the plane of its face. Each has looked in
// other directions.
fn see_sky_in_picture(pixel: vec2i, relative: vec3f, normal: vec3f) {
    if !SCREEN_OCCLUSION {
        return;
    }
    let across = view.view_from_world * normal;
    let place = view.view_from_world * relative;
    let pixel_m = abs(2.0 / (view.projection.y * view.size.y)) * select(-place.z, 1.0, view.orthographic == 1u);
    let width = 1.0 / (0.1 + 2.0 * pixel_m);
    // How far a texel's place is off the plane: from pixel to pixel it changes evenly.
    let room = dot(across, place);
    let step = across.xy * view.across_from_pixel.xy;
    let most = vec2i(textureDimensions(sky_in_picture)) - 1;
    let first = (pixel - 1) >> vec2u(1u);
    var sum = 0.0;
    var weights = 1e-4;
    for (var i = 0; i < 4; i++) {
        let texel = clamp(first + vec2i(i & 1, i >> 1), vec2i(0), most);
        let seen = textureLoad(sky_in_picture, texel, 0).xy;
        let distance = distance_of_depth(max(seen.y, 1e-30));
        let aside = dot(vec2f(min(texel * 2, vec2i(view.size) - 1) - pixel), step);
        let off = abs(select(distance * (aside - room / place.z) - room, aside - across.z * (distance + place.z), view.orthographic == 1u));
        let weight = select(0.0, max(1.0 - off * width, 0.0), seen.y > 0.0) + 1e-4;
        sum += weight * seen.x;
        weights += weight;
    }
    sky_arriving = (sum + 1e-4) / weights;
}

// Where a map shows a place.
struct MapPlace {
    at: vec2f,                  // in the map
    low: vec2f,                 // the part of the map that its level has
    high: vec2f,
    depth: f32,                 // as the map stores it, pushed off the face
    slope: vec2f,               // of the plane through it, depth per metre to the right and down
    depth_step: f32,            // metres that one unit of depth spans
    texel: f32,                 // of the level, metres
    per_metre: f32,             // share of the map's side that a metre is
    is_beside: bool,            // the map does not show it
}

// Pushed along the normal so that a surface does not shade itself; farther where it is aslant, or the face is that is shaded by another
// normal than its own.
//
// The map has one level, or four, two by two, each wider than the one before; the first that holds a place has its smallest texels.
fn place_in(depths: texture_depth_2d, map: LightMap, relative: vec3f, normal: vec3f, face: vec3f) -> MapPlace {
    let across = (map.from_relative * vec4f(relative, 1.0)).xyz;
    let push = (map.from_relative * vec4f(normal, 0.0)).xyz;
    let levels = u32(map.levels);
    let shift = vec2f(vec2u(levels, levels >> 8u) & vec2u(0xffu)) * (1.0 / 64.0);
    let ratio = f32(levels >> 16u);
    let side = select(0.5, 1.0, ratio == 1.0);                          // of a level, of the map's
    let texel = 1.0 / (f32(textureDimensions(depths).x) * side);   // of a level's side
    let wider = 1.0 / ratio;
    var scale = map.scale;
    var level = 0u;
    for (var i = 0; i < 3; i++) {
        let aside = abs(across.xy * scale + (shift - 0.5));
        let is_outside = ratio > 1.0 && max(aside.x, aside.y) > 0.5 - 5.0 * texel;
        scale *= select(1.0, wider, is_outside);
        level += select(0u, 1u, is_outside);
    }
    let metres = texel / scale;
    let slant = 1.0 - max(min(dot(normal, map.to_light), dot(face, map.to_light)), 0.0);
    // What is pushed along another normal leaves the face by less.
    let aside = select(1.0 / clamp(dot(normal, face), LEAST_ALONG, 1.0), 1.0, all(normal == face));
    let start = across + push * (metres * aside * (0.6 + 1.8 * slant));
    let local = start.xy * scale + shift;
    let low = vec2f(f32(level & 1u), f32(level >> 1u)) * side;
    let towards = max(push.z * map.depth_step, LEAST_TOWARDS);
    // Beyond all that the map shows, still before what it is cleared to.
    let depth = max(start.z + 0.35 * metres / map.depth_step, 1e-6);
    return MapPlace(low + local * side, low, low + side, depth, push.xy * (-1.0 / (towards * map.depth_step)),
                    map.depth_step, metres, scale * side, any(local < vec2f(0.0)) || any(local > vec2f(1.0)));
}

// The least cosine to a light at which a plane's slope is followed: what is more aslant has next to none of it.
const LEAST_TOWARDS: f32 = 0.05;
// The angle by which filters turn from sample to sample, and points of a spiral follow each other.
const GOLDEN_ANGLE: f32 = 2.399963;
const GOLDEN_TURN = mat2x2f(-0.7373688, 0.6754904, -0.6754904, -0.7373688);

// How wide filters are, texels.
const FILTER_TEXELS: f32 = 1.3;

// Share of a light that arrives, 0..1: four bilinear comparisons, in the corners of a square around the place that turns from sample to sample, which
// softens borders.
fn share_in(depths: texture_depth_2d, place: MapPlace) -> f32 {
    if place.is_beside {
        return 1.0;
    }
    let angle = GOLDEN_ANGLE * f32(view.sample_index);
    let turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle)) * (FILTER_TEXELS * place.texel * place.per_metre);
    var share = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = turn * vec2f(f32(i & 1) - 0.5, f32(i >> 1) - 0.5);
        share += textureSampleCompareLevel(depths, shadow_sampler, place.at + offset, place.depth);
    }
    return 0.25 * share;
}

const COMPARED: i32 = 8;

// The same on a disc of so many metres around the place, on the plane through it, along a spiral.
fn share_in_disc(depths: texture_depth_2d, place: MapPlace, radius: f32) -> f32 {
    if place.is_beside {
        return 1.0;
    }
    let angle = GOLDEN_ANGLE * f32(view.sample_index);
    var way = vec2f(cos(angle), sin(angle));
    var share = 0.0;
    for (var i = 0; i < COMPARED; i++) {
        let aside = way * (radius * sqrt((f32(i) + 0.5) / f32(COMPARED)));
        let at = clamp(place.at + aside * place.per_metre, place.low, place.high);
        share += textureSampleCompareLevel(depths, shadow_sampler, at, place.depth + dot(place.slope, aside));
        way = GOLDEN_TURN * way;
    }
    return share / f32(COMPARED);
}

const SEARCHED: i32 = 13;       // places where something in the way is looked for
const NEAREST_M: f32 = 0.5;     // from how near
const FARTHER: f32 = 1.6;       // and how much farther each time: to 100 m

// How far something in the way is, metres, in a cone around the light's direction: straight on, or else on average; 0 where nothing is found. As far as that
// is, so wide is the filter (Fernando 2005); it follows the plane in which the place lies, which hides nothing from itself. `spread`: the tangent of half
// the cone's angle.
fn distance_in_cone(depths: texture_depth_2d, place: MapPlace, spread: f32) -> f32 {
    let angle = GOLDEN_ANGLE * f32(view.sample_index);
    let size = vec2f(textureDimensions(depths));
    var way = vec2f(cos(angle), sin(angle));
    // The first looks straight on.
    var reach = 0.0;
    var next = 0.7 * NEAREST_M * spread;
    var sum = 0.0;
    var count = 0.0;
    var straight = FAR_AWAY;
    for (var i = 0; i < SEARCHED; i++) {
        let aside = reach * way;
        let at = clamp(place.at + aside * place.per_metre, place.low, place.high);
        let stored = textureLoad(depths, vec2i(min(at * size, size - 1.0)), 0);
        let height = (stored - place.depth - dot(place.slope, aside)) * place.depth_step;
        // In the cone, and not the plane itself.
        let is_found = height > place.texel && height * spread >= reach;
        sum += select(0.0, height, is_found);
        count += select(0.0, 1.0, is_found);
        straight = select(straight, height, is_found && i == 0);
        way = GOLDEN_TURN * way;
        reach = next;
        next *= FARTHER;
    }
    return min(sum / max(count, 1.0), straight);
}

// Light that falls on a surface (irradiance over pi), without its own colour.
fn irradiance(normal: vec3f, sun: f32) -> vec3f {
    let up = 0.5 + 0.5 * normal.z;
    var ambient = mix(light.ground, light.sky, up);
    if SCREEN_OCCLUSION {
        ambient = light.ground * (1.0 - up) + light.sky * (up * sky_arriving);
    }
    if SKY_SHADOWS {
        ambient = light.ground * (1.0 - up) + light.sky * (max(dot(normal, light.to_sky), 0.0) * sky_arriving);
    }
    return ambient + light.sun * (max(dot(normal, light.to_sun), 0.0) * sun);
}

// The sky behind the city.
override BACKGROUND: u32 = 0u;

const SKY: u32 = 0u;
const ONE_COLOR: u32 = 1u;
const NOTHING: u32 = 2u;

// What is behind the city in a direction, which need not be unit; nothing is black.
fn behind_city(direction: vec3f) -> vec3f {
    if BACKGROUND == SKY {
        return sky_color(direction);
    }
    return select(vec3f(0.0), light.zenith, BACKGROUND == ONE_COLOR);
}

fn sky_color(direction: vec3f) -> vec3f {
    let height = clamp(direction.z * inverseSqrt(dot(direction, direction)), 0.0, 1.0);
    let low = 1.0 - height;
    return mix(light.horizon, light.zenith, 1.0 - low * low);
}
