// The shown surface where it is a translucent layer: it takes the place of what is opaque in the targets, for AOVs.

@group(0) @binding(0) var shown: texture_2d<u32>;     // as `pass/composite.wgsl` leaves it
@group(0) @binding(1) var shown_depth: texture_2d<f32>;

struct Shown {
    @location(0) code: vec2u,
    @location(1) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> Shown {
    let code = textureLoad(shown, vec2i(at.xy), 0).xy;
    if code.x == 0u {
        discard;
    }
    return Shown(code, textureLoad(shown_depth, vec2i(at.xy), 0).x);
}
