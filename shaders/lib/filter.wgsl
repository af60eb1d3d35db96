// What neighbourhood filters made (K3): each layer is one lens' own image, filtered before anything masks it.

@group(2) @binding(6) var filtered: texture_2d_array<f32>;     // linear, multiplied by opacity

fn filtered_at(layer: u32, point: Point) -> vec3f {
    let sum = textureLoad(filtered, point.pixel, layer, 0);
    return sum.rgb / max(sum.a, 1e-6);
}
