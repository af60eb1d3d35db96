// The bare lit draw that the plain frame is measured against: the same buffers, one pass, one colour target.

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) normal: vec3f,
}

@vertex
fn vertex(@location(0) origin: vec3i, @location(2) position: vec3f, @location(3) normal: u32) -> Varying {
    return Varying(clip_from_relative(relative_to_eye(origin, position)), decode_normal(normal));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let sky = mix(vec3f(0.20, 0.185, 0.165), vec3f(0.335, 0.375, 0.43), 0.5 + 0.5 * in.normal.z);
    let sun = vec3f(0.86, 0.82, 0.74) * max(dot(in.normal, vec3f(-0.3838, -0.5481, 0.7431)), 0.0);
    return vec4f(vec3f(0.62, 0.585, 0.54) * (sky + sun), 1.0);
}
