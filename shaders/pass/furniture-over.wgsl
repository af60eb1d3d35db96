// The layer of furniture (linear, premultiplied) over a transparent picture; the target holds straight alpha.

@group(0) @binding(0) var layer: texture_2d<f32>;
@group(0) @binding(1) var picture: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let over = textureLoad(layer, vec2i(at.xy), 0);
    let under = textureLoad(picture, vec2i(at.xy), 0);
    if over.a == 0.0 {
        return under;
    }
    let alpha = over.a + under.a * (1.0 - over.a);
    return vec4f((over.rgb + under.rgb * under.a * (1.0 - over.a)) / alpha, alpha);
}
