// Depth from the sun: the same vertices, seen through an orthographic view.

@vertex
fn vertex(@location(0) origin: vec3i, @location(2) position: vec3f) -> @builtin(position) @invariant vec4f {
    return clip_from_relative(relative_to_eye(origin, position));
}

// ---- textures with holes

struct Textured {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) surface: u32,
    @location(1) texcoord: vec2f,
}

@vertex
fn vertex_textured(
    @location(0) origin: vec3i,
    @location(1) surface: u32,
    @location(2) position: vec3f,
    @location(4) texcoord: vec2f,
) -> Textured {
    return Textured(clip_from_relative(relative_to_eye(origin, position)), surface, texcoord);
}

@fragment
fn textured(in: Textured) {
    if is_hole(surface_at(in.surface), in.texcoord) {
        discard;
    }
}
