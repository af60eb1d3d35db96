// Translucent layers, over what was shaded: `pass/composite.wgsl` made them.

@group(3) @binding(1) var transparency_target: texture_2d<f32>;     // linear colours times opacity; a: what is let through

fn with_transparency(paint: vec4f, pixel: vec2i) -> vec4f {
    let over = textureLoad(transparency_target, pixel, 0);
    let opacity = 1.0 - over.a * (1.0 - paint.a);
    let color = over.rgb + paint.rgb * (paint.a * over.a);
    return vec4f(select(paint.rgb, color / opacity, over.a < 1.0), opacity);
}

// Whether a layer is the shown surface: half or more of the light comes from it and those before it.
fn is_layer_shown(pixel: vec2i) -> bool {
    return textureLoad(transparency_target, pixel, 0).a <= 0.5;
}
