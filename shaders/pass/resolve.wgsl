// The mean of all samples, with straight alpha; the target encodes sRGB.

struct Resolve {
    sample_count: f32,
}

@group(0) @binding(0) var<uniform> resolve: Resolve;
@group(0) @binding(1) var sums: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let mean = textureLoad(sums, vec2i(at.xy), 0) / resolve.sample_count;
    return vec4f(mean.rgb / max(mean.a, 1e-6), mean.a);
}
