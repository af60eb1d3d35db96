// What pixels in lenses that bend pictures show: their rays, looked up in images of what the eye sees (`render::ray_sources`).
//
// Along a bent ray the places of the images that it passes are looked at one by one, as far as a lens goes on bending it: where what an image shows
// is nearer than the ray is there, the ray has met it (as relief mapping does, Policarpo et al. 2005). What images do not show, no ray meets.

override SMOOTH: bool = false;      // whether some faces of the picture have a normal per vertex

// Texels between two places of a ray that are looked at while a lens bends it, and how many there are at most; how often the step in which it meets
// something is halved.
const STEP_TEXELS: f32 = 4.0;
const MOST_STEPS: f32 = 48.0;
const HALVINGS: u32 = 5u;

struct RaySource {
    turn_x: vec4f,              // columns of the turn from the picture's view space to its own; near, metres
    turn_y: vec4f,              // far, metres
    turn_z: vec4f,              // 1: its rays are parallel
    texel: vec4f,               // where a place of its picture plane at distance 1 is: scale, offset; texels
    size: vec2f,                // texels
    reserved: vec2f,
}

struct RaySources {
    count: u32,
    all: array<RaySource, 48>,  // the finest first
}

@group(1) @binding(1) var<uniform> ray_sources: RaySources;
@group(1) @binding(2) var source_codes: texture_2d_array<u32>;
@group(1) @binding(3) var source_depth: texture_depth_2d_array;
@group(1) @binding(4) var source_colors: texture_2d_array<f32>;
@group(1) @binding(5) var source_lights: texture_2d_array<f32>;

// Where an image shows a place.
struct Source {
    number: u32,                // ray_sources.count: nowhere
    at: vec2f,                  // texels
    distance: f32,              // of the place, along the axis of the image, metres
}

// Where an image shows a place, and whether it does.
fn place_in(own: RaySource, number: u32, p: vec3f) -> Source {
    let q = mat3x3f(own.turn_x.xyz, own.turn_y.xyz, own.turn_z.xyz) * p;
    let across = q.xy / select(-q.z, 1.0, own.turn_z.w != 0.0);
    let at = across * own.texel.xy + own.texel.zw;
    let is_in = -q.z > 0.0 && all(at >= vec2f(0.0)) && all(at < own.size);
    return Source(select(ray_sources.count, number, is_in), at, -q.z);
}

fn source_of(p: vec3f) -> Source {
    var found = place_in(first_source, 0u, p);
    for (var i = 1u; i < ray_sources.count; i++) {
        if found.number == ray_sources.count {
            found = place_in(ray_sources.all[i], i, p);
        }
    }
    return found;
}

fn source_at(number: u32) -> RaySource {
    if number == 0u {
        return first_source;
    }
    return ray_sources.all[number];
}

// How far along the axis of an image what has this depth is.
fn source_distance(own: RaySource, depth: f32) -> f32 {
    let near = own.turn_x.w;
    let far = own.turn_y.w;
    let along = far - depth * (far - near);
    return select(select(near / depth, along, own.turn_z.w != 0.0), FAR_AWAY, depth <= 0.0);
}

fn point_at(line: Ray, t: f32) -> vec3f {
    return line.origin + t * line.direction;
}

// Where on its line, beyond the place at `t`, what the images show there is.
fn shown_at(line: Ray, t: f32) -> f32 {
    let source = source_of(point_at(line, t));
    let number = min(source.number, ray_sources.count - 1u);
    let depth = textureLoad(source_depth, vec2u(max(source.at, vec2f(0.0))), number, 0);
    let shown = source_distance(source_at(number), depth);
    return select(t * (shown / source.distance), FAR_AWAY, source.number == ray_sources.count || shown >= FAR_AWAY);
}


// Where the ray of a pixel is at what it meets: on which line, and there at which parameter.
struct Meeting {
    line: Ray,
    t: f32,
}

fn meeting_of(across: vec2f) -> Meeting {
    let path = path_of_place(across);
    if path.is_round || ray_lenses.events == 0u {
        return Meeting(path.ray, 1.0);
    }
    let is_flat = view.orthographic == 1u;
    let first = ray_event(0).distance;
    let last = ray_event(ray_lenses.events - 1u).distance;
    if shown_at(path.ray, first) <= first {
        return Meeting(path.ray, first);
    }
    let goes = source_of(point_at(bent_ray(across, last), last)).at - source_of(point_at(path.ray, first)).at;
    let steps = clamp(ceil(length(goes) / STEP_TEXELS), 1.0, MOST_STEPS);
    var before = first;
    var behind = last;
    var is_met = false;
    for (var i = 1.0; i <= steps; i += 1.0) {
        let share = i / steps;
        // In perspective equal steps in the picture.
        let t = select(1.0 / mix(1.0 / first, 1.0 / last, share), mix(first, last, share), is_flat);
        if shown_at(bent_ray(across, t), t) <= t {
            behind = t;
            is_met = true;
            break;
        }
        before = t;
    }
    if is_met {
        for (var i = 0u; i < HALVINGS; i++) {
            let middle = 0.5 * (before + behind);
            let is_behind = shown_at(bent_ray(across, middle), middle) <= middle;
            behind = select(behind, middle, is_behind);
            before = select(middle, before, is_behind);
        }
    }
    return Meeting(bent_ray(across, behind), behind);
}

// How many times as deep the plane of a flat face is at one place of an image as at another; 1 where it is seen so much edge on that this says
// nothing.
fn deepening(number: u32, code: u32, here: f32, from_at: vec2f, to_at: vec2f) -> f32 {
    let own = source_at(number);
    let surface = surface_at(code - 1u);
    let turn = mat3x3f(own.turn_x.xyz, own.turn_y.xyz, own.turn_z.xyz);
    let normal = turn * (view.view_from_world * decode_normal(surface.normal));
    let a = (from_at - own.texel.zw) / own.texel.xy;
    let b = (to_at - own.texel.zw) / own.texel.xy;
    // Of parallel rays it is the distance that grows evenly.
    let grown = dot(normal.xy, b - a) / normal.z / (own.turn_y.w - own.turn_x.w);
    let ratio = dot(normal, vec3f(b, -1.0)) / dot(normal, vec3f(a, -1.0));
    let found = select(ratio, 1.0 - grown / here, own.turn_z.w != 0.0);
    let is_flat = (surface.flags & SURFACE_LIT_AS_BEFORE) == 0u;
    return select(1.0, found, is_flat && found > 0.5 && found < 2.0);
}

// The depth at a place of an image: between the middles of texels as that of the plane that they show.
fn depth_there(number: u32, at: vec2f, code: u32) -> f32 {
    let texel = vec2i(at);
    let last = vec2i(source_at(number).size) - 1;
    let here = textureLoad(source_depth, texel, number, 0);
    let middle = vec2f(texel) + 0.5;
    let off = at - middle;
    var depth = here;
    var is_known = true;
    for (var axis = 0u; axis < 2u; axis++) {
        let step = select(vec2i(0, 1), vec2i(1, 0), axis == 0u);
        let next = min(texel + step, last);
        let previous = max(texel - step, vec2i(0));
        let is_next = textureLoad(source_codes, next, number, 0).x == code && any(next != texel);
        let is_previous = textureLoad(source_codes, previous, number, 0).x == code && any(previous != texel);
        let up = select(0.0, textureLoad(source_depth, next, number, 0) - here, is_next);
        let down = select(0.0, here - textureLoad(source_depth, previous, number, 0), is_previous);
        let slope = (up + down) * select(1.0, 0.5, is_next && is_previous);
        depth += slope * off[axis];
        is_known &= is_next || is_previous;
    }
    // Where it is alone its own plane says it.
    return select(here * deepening(number, code, here, middle, at), max(depth, 0.5 * here), is_known);
}

// The first image, and the only lens where there is one, are carried to fragments: `pass/shade.wgsl` says why.
struct Place {
    @builtin(position) at: vec4f,
    @location(0) @interpolate(flat, either) turn_x: vec4f,
    @location(1) @interpolate(flat, either) turn_y: vec4f,
    @location(2) @interpolate(flat, either) turn_z: vec4f,
    @location(3) @interpolate(flat, either) texel: vec4f,
    @location(4) @interpolate(flat, either) size: vec2f,
    //@carried
}

var<private> first_source: RaySource;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Place {
    let own = ray_sources.all[0];
    var place: Place;
    place.at = vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    place.turn_x = own.turn_x;
    place.turn_y = own.turn_y;
    place.turn_z = own.turn_z;
    place.texel = own.texel;
    place.size = own.size;
    carry(&place);
    return place;
}

//@handlers

struct Warped {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    @location(4) light: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn warp(in: Place) -> Warped {
    take_own(in);
    first_source = RaySource(in.turn_x, in.turn_y, in.turn_z, in.texel, in.size, vec2f(0.0));
    let place = in.at;
    // Where a lens is that follows rays, they are followed.
    let over = lenses_over(place.xy);
    if (over & ray_lenses.warped) == 0u || (over & ray_lenses.followed) != 0u {
        discard;
    }
    // No lens that tells objects apart is over it.
    see_object(NO_OBJECT);
    let met = meeting_of(across_of_pixel(place.xy));
    let source = source_of(point_at(met.line, met.t));
    var warped: Warped;
    if source.number < ray_sources.count {
        let texel = vec2i(source.at);
        let code = textureLoad(source_codes, texel, source.number, 0).xy;
        if code.x != 0u {
            let depth = depth_there(source.number, source.at, code.x);
            let t = met.t * (source_distance(source_at(source.number), depth) / source.distance);
            warped.code = select(vec2u(code.x, 0u), code, SMOOTH);
            warped.color = textureLoad(source_colors, texel, source.number, 0);
            warped.depth = depth_of_distance(t);
            warped.own_depth = warped.depth;
            if TEXELS_EMIT {
                warped.light = textureLoad(source_lights, texel, source.number, 0);
            }
        }
    }
    return warped;
}
