// What a triangle is part of.

struct Surface {
    origin: vec3i,              // of its tile, whole metres
    object: u32,                // city object, or NO_OBJECT (the plain ground)
    color: u32,                 // natural colour, sRGB, 4 x unorm8
    flags: u32,                 // SURFACE_*
    model_surface: u32,         // index in the city model
    reserved: u32,
}

const NO_OBJECT: u32 = 0xffffffffu;
const SURFACE_UNLIT: u32 = 1u;
const SURFACE_WATER: u32 = 2u;

@group(1) @binding(0) var<storage, read> surfaces: array<Surface>;

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
