// The silhouettes of lenses.

// `share`: how much of the pixel the line covers; `color`: and its opacity.
fn outlined(paint: vec4f, share: f32, color: vec4f) -> vec4f {
    let opacity = color.a * share;
    return vec4f(mix(paint.rgb, color.rgb, opacity), paint.a + (1.0 - paint.a) * opacity);
}
