// Surfaces of triangles, and which way they face: one texel per surface, direction and tile.

const NO_OBJECT: u32 = 0xffffffffu;
const SURFACE_UNLIT: u32 = 1u;
const SURFACE_PART: u32 = 6u;   // bits that hold the part
const SURFACE_PART_SHIFT: u32 = 1u;
// Parts of the city that a surface may be of.
const PART_OTHER: u32 = 0u;
const PART_ROOF: u32 = 1u;
const PART_WALL: u32 = 2u;      // with its windows and doors
const PART_TERRAIN: u32 = 3u;   // terrain, roads, water, land use, the plain ground
const PART_SECTION: u32 = 4u;   // the inside of a closed shell, where it is laid open: of no surface
const SURFACE_CLOSED: u32 = 8u;     // its object is a closed shell
const SURFACE_INWARD: u32 = 16u;    // whose faces look inwards
const SURFACE_LIT_AS_BEFORE: u32 = 32u;     // by a normal that it does not have where it lies
const SURFACE_CLEAR_SHIFT: u32 = 6u;        // above it: how much light its material lets through, in 511ths
const SURFACE_EMITS: u32 = 0x8000u; // light of its own: the colour of what follows in the table
const LIGHT_OF_TEXELS: u32 = 1u;    // of what follows: texels say how much of it there is
// Numbers in the geometry target that are none of a surface: sections, and the bits that say of which object.
const SECTION: u32 = 0x80000000u;
const SECTION_OBJECT: u32 = 0x03ffffffu;    // all: of several
const SURFACES_PER_ROW: u32 = 4096u;
const OBJECT_BITS: u32 = 26u;       // of a texel's object; above them for which moment it is drawn (`lib/moving.wgsl`)

struct Surface {
    object: u32,                // city object, or NO_OBJECT (the plain ground)
    normal: u32,                // octahedral, of its flat faces
    color: vec3f,               // natural colour, linear
    flags: u32,                 // SURFACE_*
}

@group(1) @binding(0) var surfaces: texture_2d<u32>;

override TEXELS_EMIT: bool = false; // whether texels of the picture say how much light of their own surfaces have

// Opacity of the texel that is drawn, 0..1; 1 where there is no texture, or its opacity does not count.
var<private> texel_opacity: f32 = 1.0;

fn surface_at(number: u32) -> Surface {
    let texel = textureLoad(surfaces, vec2u(number % SURFACES_PER_ROW, number / SURFACES_PER_ROW), 0);
    let color = vec3f(unpack2x16float(texel.z), unpack2x16float(texel.w & 0xffffu).x);
    let object = select(texel.x & ((1u << OBJECT_BITS) - 1u), NO_OBJECT, texel.x == NO_OBJECT);
    return Surface(object, texel.y, color, texel.w >> 16u);
}

fn part_of(surface: Surface) -> u32 {
    return (surface.flags & SURFACE_PART) >> SURFACE_PART_SHIFT;
}

// Opacity of its material, 0..1.
fn opacity_of(surface: Surface) -> f32 {
    return 1.0 - f32((surface.flags >> SURFACE_CLEAR_SHIFT) & 511u) * (1.0 / 511.0);
}

// Octahedral, 2 x snorm16: the inverse of the host's `encode_normal`. Multiplied where the built-in functions divide:
// it runs per pixel.
fn decode_normal(code: u32) -> vec3f {
    let e = vec2f(vec2i(i32(code << 16u), i32(code)) >> vec2u(16u)) * (1.0 / 32767.0);
    var n = vec3f(e, 1.0 - abs(e.x) - abs(e.y));
    let fold = max(-n.z, 0.0);
    n.x += select(fold, -fold, n.x >= 0.0);
    n.y += select(fold, -fold, n.y >= 0.0);
    return n * inverseSqrt(dot(n, n));
}

fn encode_normal(n: vec3f) -> u32 {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
    return pack2x16snorm(select(p, folded, n.z < 0.0));
}
