// Lines that lenses draw, over what was shaded.

@group(3) @binding(0) var lines: texture_2d<f32>;     // linear colours times opacity

fn with_lines(paint: vec4f, pixel: vec2i) -> vec4f {
    let line = textureLoad(lines, pixel, 0);
    let opacity = line.a + paint.a * (1.0 - line.a);
    let color = line.rgb + paint.rgb * (paint.a * (1.0 - line.a));
    return vec4f(select(paint.rgb, color / opacity, line.a > 0.0), opacity);
}
