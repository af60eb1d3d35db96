// Depth from the sun where lenses hide things: what is not there casts no shadow.

@group(2) @binding(7) var<uniform> eye: View;                   // the main view

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) surface: u32,
    @location(1) position: vec3f,       // in the main view's space, metres
    @location(2) height: f32,
    // Handed over, not read there: a fragment shader that reads two uniforms and the shapes by number crashes Mesa 22.3.
    @location(3) @interpolate(flat, either) flags: u32,     // bit 0: the main view's rays are parallel; above: the city's number
}

fn seen_by_sun(origin: vec3i, surface: u32, position: vec3f) -> Varying {
    let relative = relative_to_main_eye(origin, position);
    let clip = clip_from_relative(city_relative(origin, position));
    let height = f32(eye.eye_whole.z) + eye.eye_fraction.z + relative.z;
    return Varying(clip, city_surface(surface), eye.view_from_world * relative, height, eye.orthographic | (city_number() << 1u));
}

@vertex
fn vertex(@location(0) origin: vec3i, @location(1) surface: u32, @location(2) position: vec3f) -> Varying {
    return seen_by_sun(origin, surface, position);
}

//@handlers

fn is_seen(in: Varying, surface: Surface) -> bool {
    let is_parallel = (in.flags & 1u) == 1u;
    // Behind the eye there is none, and none is asked for.
    let distance = max(-in.position.z, 1e-30);
    let along = vec3f(0.0, 0.0, -1.0);
    var ray = Ray(vec3f(in.position.xy, 0.0), along);
    if !is_parallel {
        ray = Ray(vec3f(0.0), vec3f(in.position.xy / distance, -1.0));
    }
    let fragment = Fragment(vec2i(in.clip.xy), in.clip.z, in.position, in.height, in.surface, surface.object,
                            part_of(surface), decode_normal(surface.normal), ray, is_parallel, in.flags >> 1u,
                            0.5, 0.0, 1.0);
    return visible(fragment);
}

@fragment
fn fragment(in: Varying) {
    if !is_seen(in, surface_at(in.surface)) {
        discard;
    }
}

// ---- textures with holes

struct Textured {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) surface: u32,
    @location(1) position: vec3f,
    @location(2) height: f32,
    @location(3) @interpolate(flat, either) flags: u32,
    @location(4) texcoord: vec2f,
}

@vertex
fn vertex_textured(
    @location(0) origin: vec3i,
    @location(1) surface: u32,
    @location(2) position: vec3f,
    @location(4) texcoord: vec2f,
) -> Textured {
    let seen = seen_by_sun(origin, surface, position);
    return Textured(seen.clip, seen.surface, seen.position, seen.height, seen.flags, texcoord);
}

@fragment
fn textured(in: Textured) {
    let surface = surface_at(in.surface);
    let is_away = is_hole(surface, in.texcoord);
    if is_away || !is_seen(Varying(in.clip, in.surface, in.position, in.height, in.flags), surface) {
        discard;
    }
}
