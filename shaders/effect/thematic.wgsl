// K2, scene style: each object in the colour of its attribute's value. The legend's hue and chroma
// stay; only lightness carries the shading.
fn thematic(color: vec3f, point: Point, p: Parameters) -> vec3f {
    if point.object == NO_OBJECT {
        return point.shade * vec3f(0.72);
    }
    let code = object_colors[u32(p.a.x) + point.object];
    let legend = linear_from_srgb(unpack4x8unorm(code).rgb);
    let lab = oklab_from_linear(legend);
    let lightness = lab.x * mix(0.62, 1.06, clamp(point.shade, 0.0, 1.0));
    return max(linear_from_oklab(vec3f(lightness, lab.yz)), vec3f(0.0));
}
