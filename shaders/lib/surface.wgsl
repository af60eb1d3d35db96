// What a triangle is part of, and which way it faces: one entry per surface, direction and tile.

struct Surface {
    origin: vec3i,              // of its tile, whole metres
    object: u32,                // city object, or NO_OBJECT (the plain ground)
    color_rg: u32,              // natural colour, linear, 4 x float16
    color_ba: u32,
    flags: u32,                 // SURFACE_*
    normal: u32,                // octahedral, of its flat faces
}

const NO_OBJECT: u32 = 0xffffffffu;
const SURFACE_UNLIT: u32 = 1u;

@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;

fn natural_color(surface: u32) -> vec3f {
    return vec3f(unpack2x16float(surfaces[surface].color_rg), unpack2x16float(surfaces[surface].color_ba).x);
}

// Octahedral, 2 x snorm16: the inverse of the host's `encode_normal`.
fn decode_normal(code: u32) -> vec3f {
    let e = unpack2x16snorm(code);
    var n = vec3f(e, 1.0 - abs(e.x) - abs(e.y));
    let fold = max(-n.z, 0.0);
    n.x += select(fold, -fold, n.x >= 0.0);
    n.y += select(fold, -fold, n.y >= 0.0);
    return normalize(n);
}

fn encode_normal(n: vec3f) -> u32 {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
    return pack2x16snorm(select(p, folded, n.z < 0.0));
}
