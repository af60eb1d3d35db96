// Images of neighbourhood filters: each is one lens' own image, filtered before anything masks it. Its pixels stand
// where `pass/filter.wgsl` put them. Of a transparent picture there are two images: colours times opacity, and opacity.

@group(2) @binding(6) var filtered: texture_2d_array<u32>;

// `slot` of the parameters says which of them.
fn filtered_at(slot: u32, point: Point) -> vec3f {
    let layer = i32(parameters[slot].x) + (point.pixel.y & 3);
    let color = filtered_pixel(point.pixel, layer);
    if BACKGROUND != NOTHING {
        return color * headroom();
    }
    return color * headroom() / max(filtered_pixel(point.pixel, layer + 4).x, 1e-6);
}

fn filtered_pixel(pixel: vec2i, layer: i32) -> vec3f {
    return unpacked(textureLoad(filtered, pixel >> vec2u(2u), layer, 0)[pixel.x & 3]);
}
