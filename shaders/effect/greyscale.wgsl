// K3, post style: the colour's own luminance, mixed in by `amount`.
fn greyscale(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return mix(color, vec3f(luminance(color)), p.a.x);
}
