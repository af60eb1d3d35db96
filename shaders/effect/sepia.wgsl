// K3, post style: the warm brown of an albumen print; luminance is kept.
fn sepia(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let grey = luminance(color);
    let toned = grey * vec3f(1.22, 0.97, 0.68);
    return mix(color, mix(toned, vec3f(1.0), 0.06 * grey), p.a.x);
}
