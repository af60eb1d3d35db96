// Fragments of the city that are shaded where they are drawn, without a place in the order of layers: what `pass/shade.wgsl`
// has of a pixel these have of a fragment. Which of them are translucent, and that they are shaded as the exact method does, is of
// the scene.

override PART: u32 = 1u;            // of the picture: the context's, or the lenses'

// Rules that count layers see one alone.
fn most_layers() -> u32 {
    return 1u;
}

// The answer of a rule as an opacity, 0 to 1; 0 where it is no number.
fn contained_opacity(opacity: f32) -> f32 {
    return select(0.0, min(opacity, 1.0), opacity > 0.0);
}

fn layer_point(at: vec2f, depth: f32, code: u32, normal: u32, color: u32, light_share: u32) -> Point {
    var point = point_of(vec2i(at), ray_of_pixel(at), depth, vec2u(code, normal), unpacked(light_share));
    point.base = point.natural;
    if TEXTURED {
        let texel = unpacked_texel(color);
        point.base = texel.rgb;
        point.opacity *= texel.a;
    }
    if CLAY {
        point.base = CLAY_COLOR;
    }
    return point;
}

fn layer_classes(point: Point) -> Classes {
    return classes_at(sight_at(point.pixel, ray_of_pixel(vec2f(point.pixel) + 0.5), point.depth, point.object), PART);
}
