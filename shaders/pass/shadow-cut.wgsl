// Depth from the sun where lenses hide things: what is not there casts no shadow.
//
// A sprite drawn from the eye says nothing of what only the sun sees. So classes come from the shapes themselves, along
// the main eye's ray through the fragment, wherever it is: beside the picture or behind the eye as well.


@group(2) @binding(7) var<uniform> eye: View;                   // the main view

// On distances along the ray, from the fragment on (`classify` in `lib/lens.wgsl` does it on stored depths).
fn class_of(volume: u32, fragment: Fragment) -> u32 {
    let shape = shapes[volume];
    let distance = -fragment.position.z;
    let is_seen = fragment.is_parallel || distance > 0.0;
    let away = select(fragment.position / distance, vec3f(0.0, 0.0, -1.0), fragment.is_parallel || !is_seen);
    let span = span_of_shape(Ray(fragment.position, away), shape, shape.kind);
    let is_missed = span.enter > span.exit || (!fragment.is_parallel && span.exit <= -distance);
    let is_inside = span.enter <= 0.0 && span.exit > 0.0;
    // Behind the eye nobody looks past a lens.
    let beside = select(MISSED, select(BEHIND, FRONT, span.enter > 0.0), is_seen);
    return select(select(beside, INSIDE, is_inside), MISSED, is_missed);
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) surface: u32,
    @location(1) position: vec3f,       // in the main view's space, metres
    @location(2) height: f32,
    // Handed over, not read there: a fragment shader that reads two uniforms and the shapes by number crashes Mesa 22.3.
    @location(3) @interpolate(flat, either) is_parallel: u32,
}

@vertex
fn vertex(@location(0) origin: vec3i, @location(1) surface: u32, @location(2) position: vec3f) -> Varying {
    let relative = (vec3f(origin - eye.eye_whole) - eye.eye_fraction) + position;
    let clip = clip_from_relative(relative_to_eye(origin, position));
    return Varying(clip, surface, eye.view_from_world * relative, f32(origin.z) + position.z, eye.orthographic);
}

//@handlers

@fragment
fn fragment(in: Varying) {
    let surface = surface_at(in.surface);
    let fragment = Fragment(vec2i(in.clip.xy), in.clip.z, in.position, in.height, in.surface, surface.object,
                            part_of(surface), decode_normal(surface.normal), in.is_parallel == 1u);
    if !visible(fragment) {
        discard;
    }
}
