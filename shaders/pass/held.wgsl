// The city in triangles that hold their depth, for adapters that need it (`Gpu::holds_depth`); behind `pass/geometry.wgsl`.
//
// An adapter that covers pixels by corners on its grid, and takes depth from corners in their places, has a triangle that is seen edge on
// cover pixels beside it, at depths that it does not have: a wall from above, 100 m before its roof (hard case 12). Here each corner
// reads all three of its triangle, and no depth leaves theirs.

struct Corner {
    origin: vec3i,
    surface: u32,
    position: vec3f,
    normal: u32,
}

@group(4) @binding(0) var<storage, read> corner_numbers: array<u32>;
@group(4) @binding(1) var<storage, read> corners: array<Corner>;
@group(4) @binding(2) var<storage, read> corner_words: array<u32>; // what each has besides

// Words that each has besides: none, a texture coordinate, a plane, a plane and a texture coordinate.
override WORDS_BESIDES: u32 = 0u;
const WORDS_OF_TEXTURE: u32 = 2u;
const WORDS_OF_PLANE: u32 = 7u;
const WORDS_OF_BOTH: u32 = 9u;
// Faces of a plane take their depths from it, alike to the last bit: they are not held that closely.
const PLANE_ROOM: f32 = 1e-6;

struct HeldVarying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
    @location(1) normal: vec3f,
    @location(2) texcoord: vec2f,
    @location(3) @interpolate(flat, either) plane: vec3f,
    @location(4) @interpolate(flat, either) range: vec2f,    // depths: the farthest, the nearest
    @location(5) relative: vec3f,   // to the eye, world axes, metres
}

fn corner_at(index: u32) -> Vertex {
    let corner = corners[corner_numbers[index]];
    return Vertex(corner.origin, corner.surface, corner.position, corner.normal);
}

fn word_besides(index: u32, word: u32) -> u32 {
    return corner_words[WORDS_BESIDES * corner_numbers[index] + word];
}

fn number_besides(index: u32, word: u32) -> f32 {
    return bitcast<f32>(word_besides(index, word));
}

fn is_of_plane() -> bool {
    return WORDS_BESIDES >= WORDS_OF_PLANE;
}

fn held_corner(index: u32) -> HeldVarying {
    let in = corner_at(index);
    let face = placed(in);
    var range = vec2f(1.0, 0.0);
    for (var k = 0u; k < 3u; k++) {
        let clip = placed(corner_at(index - index % 3u + k)).clip;
        // What reaches behind the eye is seen as near as anything.
        let depth = select(1.0, clip.z / clip.w, clip.w > clip.z);
        range = vec2f(min(range.x, depth), max(range.y, depth));
    }
    var texcoord = vec2f(0.0);
    if WORDS_BESIDES == WORDS_OF_TEXTURE || WORDS_BESIDES == WORDS_OF_BOTH {
        texcoord = vec2f(number_besides(index, WORDS_BESIDES - 2u), number_besides(index, WORDS_BESIDES - 1u));
    }
    var plane = vec3f(0.0);
    if is_of_plane() {
        let normal = vec3f(number_besides(index, 0u), number_besides(index, 1u), number_besides(index, 2u));
        let origin = bitcast<vec3i>(vec3u(word_besides(index, 3u), word_besides(index, 4u), word_besides(index, 5u)));
        plane = coplanar(in, Plane(normal, origin, number_besides(index, 6u))).plane;
    }
    let relative = city_relative(in.origin, in.position);
    return HeldVarying(face.clip, face.code, city_direction(decode_normal(in.normal)), texcoord, plane, range, relative);
}

@vertex
fn vertex_held(@builtin(vertex_index) index: u32) -> HeldVarying {
    return held_corner(index);
}

// Of the triangle's own plane, and of the plane that it shares.
fn held_depths(in: HeldVarying) -> vec2f {
    let own = clamp(in.clip.z, in.range.x, in.range.y);
    if is_of_plane() {
        return vec2f(own, clamp(depth_on_plane(in.plane, in.clip), in.range.x - PLANE_ROOM, in.range.y + PLANE_ROOM));
    }
    return vec2f(own);
}

fn held_normal(in: HeldVarying, code: u32) -> u32 {
    if !SMOOTH {
        return 0u;
    }
    return normal_code(in.normal, code);
}

@fragment
fn held_full(in: HeldVarying) -> CoplanarFull {
    let depths = held_depths(in);
    cut(in.clip.xy, depths.y, in.code);
    let color = vec4f(surface_at(in.code - 1u).color, 1.0);
    return CoplanarFull(vec2u(in.code, held_normal(in, in.code)), color, depths.x/*@region*/, depths.y);
}

@fragment
fn held_textured(in: HeldVarying) -> CoplanarTextured {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    if look.opacity < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    let depths = held_depths(in);
    cut(in.clip.xy, depths.y, in.code);
    let code = vec2u(in.code, look.normal);
    return CoplanarTextured(code, vec4f(look.color, look.facade), depths.x/*@region*/, vec4f(look.light, 1.0), depths.y);
}
