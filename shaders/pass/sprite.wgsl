// Volumetric depth sprite of one lens volume, created in two stages (S1, V §3.1):
// stage 1 keeps the nearest entry (clear 0, test greater), stage 2 the farthest exit (clear 1, test
// less); stored depth decreases with distance (1/w, S4's default), so both tests are swapped.
// Depth is clamped, not clipped. An entry behind the eye is not written: an exit without an entry
// says that the eye, or the near plane, is inside.

struct SpriteStage {
    shape: Shape,
    // Target pixels per sprite texel: a coarser sprite takes the ray of its own texel's centre.
    pixels_per_texel: vec2f,
    // Of the part of the sprite that is kept (the lens' screen bounds), texels.
    origin: vec2f,
}

@group(2) @binding(0) var<uniform> stage: SpriteStage;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

fn span_at(texel: vec2f) -> Span {
    let span = span_of_shape(ray_of_pixel((texel + stage.origin) * stage.pixels_per_texel), stage.shape);
    // Perspective rays start at the eye; what lies behind it is not seen.
    if view.orthographic == 0u && span.exit <= 0.0 {
        return EMPTY_SPAN;
    }
    return span;
}

@fragment
fn entry(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    let span = span_at(at.xy);
    if span.enter > span.exit || (view.orthographic == 0u && span.enter <= 0.0) {
        discard;
    }
    // Never 0, which says "no entry".
    return max(depth_of_distance(span.enter), 1e-30);
}

@fragment
fn exit(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    let span = span_at(at.xy);
    if span.enter > span.exit {
        discard;
    }
    // Never 1, which says "no exit": a lens nearer than the near plane ends just behind it.
    return min(depth_of_distance(span.exit), 0.99999994);
}
