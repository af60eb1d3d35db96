// The shown surface at a pixel, and what lies around it: what shading and its handlers look at.

override SMOOTH: bool = false;      // whether normals are in the target, not with the surfaces
override TEXTURED: bool = false;    // whether base colours are in a target of their own
override CLAY: bool = false;        // one colour for everything
override EMITS: bool = false;       // whether some surfaces have light of their own
override GROUND_FADES: bool = false;    // whether there is a plain ground
override FACADES: bool = false;     // whether some walls have storeys and windows
override SECTIONS: bool = false;    // whether some of what is shown are sections; their colours are in the target

// The shown surface at a pixel; `surface` is NO_SURFACE where there is none (D infinite).
struct Point {
    pixel: vec2i,
    relative: vec3f,            // to the eye, world axes, metres
    distance: f32,              // D, metres
    depth: f32,                 // D as the depth target stores it; 0 = nothing
    normal: vec3f,              // unit, towards the eye
    surface: u32,
    object: u32,                // or NO_OBJECT
    part: u32,                  // PART_*
    layer: u32,                 // of a translucent one: how many are nearer; of what is opaque 0
    last_layer: u32,            // how many lie behind the nearest in all
    is_covered: bool,           // of a translucent one: whether the one before it lies in its plane, over it
    natural: vec3f,             // its own colour, linear; where it has a texture, that of the material
    base: vec3f,                // its colour before light, linear: clay, texture or natural, with storeys and windows
    facade: f32,                // how much of the colour storeys and windows leave, 1 where there are none
    lit: bool,                  // whether light acts on it
    sun: f32,                   // share of the sun that arrives, 0..1
    arriving: vec3f,            // light on a white surface, linear
    shade: f32,                 // its luminance, 0..1
    highlight: vec3f,           // light that does not come out of its colour, linear
    opacity: f32,               // of its material and texture, 0..1
    emission: vec3f,            // light of its own, linear
    value: f32,                 // of a field: where it is on its ramp, 0..1; of what is none -1
}

const NO_SURFACE: u32 = 0xffffffffu;
const CLAY_COLOR = vec3f(0.62, 0.585, 0.54);

@group(1) @binding(6) var codes: texture_2d<u32>;
@group(1) @binding(7) var scene_depth: texture_depth_2d;
@group(1) @binding(8) var colors: texture_2d<f32>;
@group(1) @binding(9) var emissions: texture_2d<f32>;

fn is_section(number: u32) -> bool {
    return SECTIONS && (number & SECTION) != 0u;
}

// The surface of a number in the geometry target.
fn surface_shown(number: u32) -> Surface {
    if is_section(number) {
        let object = number & SECTION_OBJECT;
        return Surface(select(object, NO_OBJECT, object == SECTION_OBJECT), 0u, vec3f(0.0), 0u);
    }
    return surface_at(number);
}

fn base_color(point: Point, pixel: vec2i) -> vec3f {
    if is_section(point.surface) {
        return textureLoad(colors, pixel, 0).rgb;
    }
    if CLAY {
        return CLAY_COLOR;
    }
    if TEXTURED {
        return textureLoad(colors, pixel, 0).rgb;
    }
    return point.natural;
}

fn point_at(pixel: vec2i, ray: Ray, depth: f32) -> Point {
    var share = vec3f(1.0);
    if TEXELS_EMIT {
        share = textureLoad(emissions, pixel, 0).rgb;
    }
    var point = point_of(pixel, ray, depth, textureLoad(codes, pixel, 0).xy, share);
    point.base = base_color(point, pixel);
    if is_section(point.surface) {
        point.natural = point.base;
    } else if FACADES {
        point.facade = textureLoad(colors, pixel, 0).a;
        point.base *= select(1.0, point.facade, CLAY);
    }
    return point;
}

// How a point is seen. Sections lie beside the volumes that they close, and on no face that the rasteriser moves.
fn sight_of_point(point: Point, ray: Ray) -> Sight {
    var sight = sight_at(point.pixel, ray, point.depth, point.object);
    sight.off = select(sight.off, 0.0, is_section(point.surface));
    return sight;
}

// That of a number, and where it has one a normal, in the geometry target; it has no base colour yet. `share`: of light of its own,
// where texels say it.
fn point_of(pixel: vec2i, ray: Ray, depth: f32, code: vec2u, share: vec3f) -> Point {
    var point: Point;
    point.pixel = pixel;
    point.depth = depth;
    point.distance = distance_of_depth(depth);
    point.relative = (ray.origin + point.distance * ray.direction) * view.view_from_world;
    point.surface = code.x - 1u;
    let surface = surface_shown(point.surface);
    point.normal = decode_normal(select(surface.normal, code.y, SMOOTH));
    let is_turned = (surface.flags & SURFACE_LIT_AS_BEFORE) == 0u;
    let away = ray.direction * view.view_from_world;
    point.normal *= select(1.0, -1.0, is_turned && dot(point.normal, away) > 0.0);
    // Of the face, where that is shaded smoothly or by an image: as it is at rest, so it says how much, and not which way.
    var face = point.normal;
    if SMOOTH && !is_section(point.surface) && code.y != surface.normal {
        face = decode_normal(surface.normal);
        face *= select(1.0, -1.0, dot(face, point.normal) < 0.0);
    }
    point.object = surface.object;
    point.facade = 1.0;
    point.part = part_of(surface);
    point.lit = CLAY || (surface.flags & SURFACE_UNLIT) == 0u;
    point.natural = surface.color;
    point.sun = sun_share(point.relative, point.normal, face);
    see_sky(point.relative, point.normal, face);
    see_sky_in_picture(pixel, point.relative, face);
    point.arriving = irradiance(point.normal, point.sun);
    point.shade = luminance(point.arriving);
    point.opacity = opacity_of(surface);
    point.value = -1.0;
    if EMITS && !CLAY && (surface.flags & SURFACE_EMITS) != 0u {
        let own = surface_at(point.surface + 1u);
        point.emission = select(own.color, own.color * share, TEXELS_EMIT && (own.flags & LIGHT_OF_TEXELS) != 0u);
    }
    return point;
}

fn nowhere(pixel: vec2i) -> Point {
    return Point(pixel, vec3f(0.0), FAR_AWAY, 0.0, vec3f(0.0, 0.0, 1.0), NO_SURFACE, NO_OBJECT, PART_OTHER, 0u, 0u, false,
                 vec3f(0.0), vec3f(0.0), 1.0, false, 1.0, vec3f(1.0), 1.0, vec3f(0.0), 1.0, vec3f(0.0), -1.0);
}

// The surface shown beside a point, `offset` pixels away; at the picture's edge, what is at the edge.
struct Beside {
    depth: f32,                 // as Point's
    normal: vec3f,              // unit; whichever way it faces
    object: u32,                // or NO_OBJECT
    surface: u32,               // or NO_SURFACE
}

fn beside(point: Point, offset: vec2i) -> Beside {
    let pixel = clamp(point.pixel + offset, vec2i(0), vec2i(view.size) - 1);
    let code = textureLoad(codes, pixel, 0).xy;
    if code.x == 0u {
        return Beside(0.0, vec3f(0.0, 0.0, 1.0), NO_OBJECT, NO_SURFACE);
    }
    let surface = surface_shown(code.x - 1u);
    let normal = decode_normal(select(surface.normal, code.y, SMOOTH));
    return Beside(textureLoad(scene_depth, pixel, 0), normal, surface.object, code.x - 1u);
}

// How much of a point is seen before what is behind the city, 0..1: plain ground fades away from it.
fn not_faded(point: Point) -> f32 {
    if !GROUND_FADES || point.object != NO_OBJECT || point.part != PART_TERRAIN {
        return 1.0;
    }
    let beyond = max(abs(point.relative.xy - light.fade.xy) - light.fade.zw, vec2f(0.0));
    return 1.0 - smoothstep(0.0, light.fade_width, length(beyond));
}

// A colour as it is seen before the sky.
fn before_sky(color: vec3f, point: Point) -> vec3f {
    if !GROUND_FADES || BACKGROUND == NOTHING {
        return color;
    }
    return mix(behind_city(point.relative), color, not_faded(point));
}

// From a point to the eye: unit, world axes.
fn towards_eye(point: Point) -> vec3f {
    let back = vec3f(0.0, 0.0, 1.0) * view.view_from_world;
    return select(-normalize(point.relative), back, view.orthographic == 1u);
}

// The pixel of a point in the whole picture, whatever part of it is drawn: for patterns.
fn pixel_in_picture(point: Point) -> vec2i {
    return point.pixel + vec2i(vec2u(view.first_pixel & 0xffffu, view.first_pixel >> 16u));
}

// Metres of the picture plane at a point that one pixel spans.
fn metres_per_pixel(point: Point) -> f32 {
    let at_one = 2.0 / (view.projection.y * view.size.y);
    return abs(at_one) * select(point.distance, 1.0, view.orthographic == 1u);
}

// Where a point is in a grid of `period` metres (to the millimetre, at most 60 m), 0..period: the same wherever the eye is.
fn within(point: Point, period: f32) -> vec3f {
    let step = max(i32(round(period * 1000.0)), 1);
    let whole = vec3f(((view.eye_whole % step) * 1000) % step) * 0.001;
    let at = (whole + view.eye_fraction + point.relative) / period;
    return (at - floor(at)) * period;
}

// The answer of a user's effect as a colour: no negative light, no infinity, nothing that is no number.
fn contained(color: vec3f) -> vec3f {
    return select(vec3f(0.0), min(color, vec3f(64.0)), color > vec3f(0.0));
}
