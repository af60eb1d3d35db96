// What neighbourhood filters made (K3): each is one lens' own image, filtered before anything masks it. Its pixels stand
// where `pass/filter.wgsl` put them.

@group(2) @binding(6) var filtered: texture_2d_array<f32>;     // linear, multiplied by opacity

// `slot` of the parameters says which of them.
fn filtered_at(slot: u32, point: Point) -> vec3f {
    let columns = i32(textureDimensions(filtered).x >> 2u);
    let place = vec2i((point.pixel.x & 3) * columns, 0) + (point.pixel >> vec2u(2u));
    let layer = 4 * i32(parameters[slot].x) + (point.pixel.y & 3);
    let sum = textureLoad(filtered, place, layer, 0);
    return sum.rgb / max(sum.a, 1e-6);
}
