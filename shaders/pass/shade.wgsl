// Deferred shading of the shown surface, and what the lenses make of it.
//
// What the scene's context and lenses do is written out in `apply`, bottom lens first (L6): an effect, a lens
// or a class that nobody asked for is not in the shader (U3). Moving a lens or turning a parameter changes
// uniforms only.

override SMOOTH: bool = false;      // whether normals are in the target, not with the surfaces
override TEXTURED: bool = false;    // whether base colours are in a target of their own
override CLAY: bool = false;        // one colour for everything
override HAZE: bool = false;        // whether the air shows
override SUMMED: bool = false;      // weighted by coverage, to be summed over samples
override BACKGROUND: u32 = 0u;      // SKY, ONE_COLOR, NOTHING

const SKY: u32 = 0u;
const ONE_COLOR: u32 = 1u;

// The shown surface at a pixel; `surface` is NO_SURFACE where there is none (D infinite).
struct Point {
    relative: vec3f,            // to the eye, world axes, metres
    distance: f32,              // D, metres
    depth: f32,                 // D as the depth target stores it; 0 = nothing
    normal: vec3f,              // unit, towards the eye
    surface: u32,
    object: u32,                // or NO_OBJECT
    natural: vec3f,             // its own colour, linear; where it has a texture, that of the material
    base: vec3f,                // its colour before light, linear: clay, texture or natural
    lit: bool,                  // whether light acts on it
    sun: f32,                   // share of the sun that arrives, 0..1
    shade: f32,                 // light on a white surface, 0..1
}

const NO_SURFACE: u32 = 0xffffffffu;
const FAR_AWAY: f32 = 1e30;

@group(1) @binding(6) var codes: texture_2d<u32>;
@group(1) @binding(7) var scene_depth: texture_depth_2d;
@group(1) @binding(8) var colors: texture_2d<f32>;
@group(2) @binding(1) var<storage, read> object_colors: array<u32>;

// At depth 0, and exactly there: the depth test chooses between surface and background.
@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) @invariant vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
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
    point.depth = depth;
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
    return Point(vec3f(0.0), FAR_AWAY, 0.0, vec3f(0.0, 0.0, 1.0), NO_SURFACE, NO_OBJECT, vec3f(0.0), vec3f(0.0),
                 false, 1.0, 1.0);
}

fn shade(point: ptr<function, Point>, pixel: vec2i) -> vec3f {
    let sun = sun_share((*point).relative, (*point).normal);
    let arriving = irradiance((*point).normal, sun);
    (*point).shade = luminance(arriving);
    (*point).sun = sun;
    (*point).base = base_color(*point, pixel);
    if !CLAY && !(*point).lit {
        return (*point).base;
    }
    return (*point).base * arriving;
}

// What a user's effect returned, as a colour: no negative light, no infinity, nothing that is no number.
fn contained(color: vec3f) -> vec3f {
    return select(vec3f(0.0), min(color, vec3f(64.0)), color > vec3f(0.0));
}

//@apply

fn finished(paint: vec4f, point: Point, pixel: vec2i) -> vec4f {
    let seen = apply(paint, point, pixel);
    if SUMMED {
        return vec4f(seen.rgb * seen.a, seen.a);
    }
    return seen;
}

// Where something stands: the stored depth is not 0. The depth test chooses, so that neither shader runs in vain.
@fragment
fn surface(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    var point = point_at(pixel, ray_of_pixel(at.xy), textureLoad(scene_depth, pixel, 0));
    var color = shade(&point, pixel);
    if HAZE {
        let air = 1.0 - exp(-max(point.distance - light.scene_radius, 0.0) * view.haze);
        color = mix(color, light.horizon, air);
    }
    return finished(vec4f(color, 1.0), point, pixel);
}

// Where nothing stands: the stored depth is its clear value, 0.
@fragment
fn background(@builtin(position) at: vec4f) -> @location(0) vec4f {
    var paint = vec4f(0.0);
    if BACKGROUND == SKY {
        paint = vec4f(sky_color(ray_of_pixel(at.xy).direction * view.view_from_world), 1.0);
    } else if BACKGROUND == ONE_COLOR {
        paint = vec4f(light.zenith, 1.0);
    }
    return finished(paint, nowhere(), vec2i(at.xy));
}
