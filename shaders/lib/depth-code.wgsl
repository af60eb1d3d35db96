// How distances are stored in depth sprites. Twin: `veduta::lens::sprite::DepthCode`, which says what the codes mean.

struct DepthCode {
    kind: u32,                  // format; mapping from bit 4 on
    near: f32,                  // metres
    far: f32,
}

// Formats.
const UNORM8: u32 = 0u;
const UNORM16: u32 = 1u;
const UINT32: u32 = 2u;
const FLOAT16: u32 = 3u;
const FLOAT32: u32 = 4u;
// Mappings.
const BY_Z: u32 = 0u;
const BY_COMPLEMENTARY_Z: u32 = 1u;
const BY_W: u32 = 2u;
const BY_INVERSE_W: u32 = 3u;
const BY_COMPLEMENTARY_W: u32 = 4u;

fn format_of(c: DepthCode) -> u32 {
    return c.kind & 15u;
}

fn encoded(c: DepthCode, distance: f32) -> f32 {
    let n = c.near;
    let f = c.far;
    let d = max(distance, n);
    var depth = n / d;
    switch c.kind >> 4u {
        case BY_Z: { depth = f / (f - n) * (1.0 - n / d); }
        case BY_COMPLEMENTARY_Z: { depth = n / (f - n) * (f / d - 1.0); }
        case BY_W: { depth = distance / f; }
        case BY_COMPLEMENTARY_W: { depth = (f - distance) / (f - n); }
        default: {}
    }
    return clamp(depth, 0.0, 1.0);
}

fn decoded(c: DepthCode, depth: f32) -> f32 {
    let n = c.near;
    let f = c.far;
    switch c.kind >> 4u {
        case BY_Z: { return n * f / (f - depth * (f - n)); }
        case BY_COMPLEMENTARY_Z: { return n * f / (n + depth * (f - n)); }
        case BY_W: { return depth * f; }
        case BY_COMPLEMENTARY_W: { return f - depth * (f - n); }
        default: { return n / max(depth, 1e-30); }
    }
}

fn top_code(c: DepthCode) -> u32 {
    switch format_of(c) {
        case UNORM8: { return 0xffu; }
        case UNORM16: { return 0xffffu; }
        case UINT32: { return 0xffffffffu; }
        case FLOAT16: { return 0x3c00u; }
        default: { return 0x3f800000u; }
    }
}

fn quantised(c: DepthCode, depth: f32) -> u32 {
    let bits = bitcast<u32>(depth);
    switch format_of(c) {
        case UNORM8: { return u32(depth * 255.0 + 0.5); }
        case UNORM16: { return u32(depth * 65535.0 + 0.5); }
        case UINT32: { return select(u32(min(depth, 0.99999994) * 4294967296.0), 0xffffffffu, depth >= 1.0); }
        case FLOAT16: {
            let small = u32(depth * 16777216.0 + 0.5);
            return select(((bits + 0xfffu + (bits >> 13u & 1u)) >> 13u) - (112u << 10u), small, depth < 0.00006103515625);
        }
        default: { return bits; }
    }
}

fn dequantised(c: DepthCode, code: u32) -> f32 {
    switch format_of(c) {
        case UNORM8: { return f32(code) / 255.0; }
        case UNORM16: { return f32(code) / 65535.0; }
        case UINT32: { return f32(code) / 4294967296.0; }
        case FLOAT16: {
            return select(bitcast<f32>((code << 13u) + (112u << 23u)), f32(code) / 16777216.0, code < 1024u);
        }
        default: { return bitcast<f32>(code); }
    }
}

// The codes that are no distances: of an entry, none before what is seen; of an exit, the ray misses.
fn nearest_code(c: DepthCode) -> u32 {
    let mapping = c.kind >> 4u;
    return select(top_code(c), 0u, mapping == BY_Z || mapping == BY_W);
}

// The code of an exit where the lens has no end.
fn farthest_code(c: DepthCode) -> u32 {
    return top_code(c) - nearest_code(c);
}

fn code_of(c: DepthCode, distance: f32) -> u32 {
    return clamp(quantised(c, encoded(c, distance)), 1u, top_code(c) - 1u);
}

fn distance_of(c: DepthCode, code: u32) -> f32 {
    return decoded(c, dequantised(c, code));
}
