// Depth from the sun: the same vertices, seen through an orthographic view.

@vertex
fn vertex(@location(0) position: vec3f, @location(2) surface: u32) -> @builtin(position) vec4f {
    return clip_from_relative(relative_to_eye(surfaces[surface].origin, position));
}
