// Depth from the sun: the same vertices, seen through an orthographic view.

@vertex
fn vertex(@location(0) origin: vec3i, @location(2) position: vec3f) -> @builtin(position) @invariant vec4f {
    return clip_from_relative(relative_to_eye(origin, position));
}
