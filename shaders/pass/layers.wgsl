// Translucent layers: every fragment that is seen through is noted in a list of its pixel. `pass/composite.wgsl` sorts them.
//
// A list begins at `heads` and goes on from node to node. A node has three words and, where the picture has them, a normal per
// vertex, a colour and a share of light of textures, in places that `lib/fragment-nodes.wgsl` tells.
//
// Where there is much room, it is shared out between pools, one for each tile of the picture in turn, and what a pool has no
// room for spills into the rest: processors that draw different tiles neither count with the same counter nor write
// side by side. Nodes that find no room are counted all the same: the host sees it, and draws what did not fit in narrower bands.

override TEXTURED: bool = false;    // whether nodes have a colour of a texture
override ALL: bool = false;         // whether all that is drawn is translucent

// The first words of `heads`; those of the pixels follow.
const SPILLED: u32 = 0u;            // how many nodes their pool had no room for
const FIRST_POOL: u32 = 16u;        // how many nodes a pool was to take, those that spilled included; each in a line of its own
const FIRST_HEAD: u32 = 272u;

// As the host counts (`render::layers`).
const POOLS: u32 = 16u;
const MANY: u32 = 65536u;           // nodes that there is room for: with less there is one pool
const TILE_SHIFT: u32 = 6u;         // tiles of 64 pixels, as software adapters draw them
// The bits of a noted number that are that of the surface. Above them is how many layers of a plane may be over this one.
const NODE_CODE: u32 = 0x07ffffffu;
const PLANE_SHIFT: u32 = 27u;
const MOST_IN_PLANE: u32 = 31u;
const ALONE: u32 = 0xf8000000u;     // in its plane: as the lowest

@group(0) @binding(1) var<storage, read_write> heads: array<atomic<u32>>;   // number of the node + 1; 0: none
@group(0) @binding(2) var<storage, read_write> nodes: array<vec2u>;
@group(0) @binding(3) var opaque_depth: texture_depth_2d;

fn write_word(place: u32, word: u32) {
    nodes[place >> 1u][place & 1u] = word;
}

// `plane`: what is noted with the number, of its layer in a plane.
fn add_node(at: vec2f, depth: f32, code: u32, plane: u32, normal: u32, color: u32, light: u32) {
    if !ALL && !is_layer(fragment_at(at, depth, code)) {
        return;
    }
    let pixel = vec2u(at);
    let tile = pixel >> vec2u(TILE_SHIFT);
    let room = 2u * arrayLength(&nodes) / words_of_node();
    let has_pools = room >= MANY;
    let pool = select(0u, (tile.x + 5u * tile.y) % POOLS, has_pools);
    let each = select(room, room / 64u * 3u, has_pools);
    var number = atomicAdd(&heads[FIRST_POOL + 16u * pool], 1u);
    if number < each {
        number += pool * each;
    } else {
        number = select(1u, POOLS, has_pools) * each + atomicAdd(&heads[SPILLED], 1u);
    }
    if number >= room {
        return;
    }
    nodes[number] = vec2u(bitcast<u32>(depth), code | plane);
    let before = atomicExchange(&heads[FIRST_HEAD + pixel.y * u32(view.size.x) + pixel.x], number + 1u);
    write_word(link_place(room, number), before);
    if SMOOTH {
        write_word(rest_place(room, number, normal_word()), normal);
    }
    if TEXTURED {
        write_word(rest_place(room, number, color_word()), color);
    }
    if TEXELS_EMIT {
        write_word(rest_place(room, number, light_word()), light);
    }
}

fn natural_color(code: u32) -> u32 {
    if TEXTURED {
        return packed_texel(surface_at(code - 1u).color);
    }
    return 0u;
}

@fragment //@early
fn note_plain(in: Varying) {
    //@behind
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, 0u, natural_color(in.code), 0u);
}

@fragment //@early
fn note_smooth(in: SmoothVarying) {
    //@behind
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, normal_code(in.normal, in.code), natural_color(in.code), 0u);
}

@fragment //@early
fn note_textured(in: TexturedVarying) {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    //@behind
    if look.opacity < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    add_node(in.clip.xy, in.clip.z, in.code, ALONE, look.normal, packed_texel(look.color), packed(look.light));
}

// The instance is the layer of the face in its plane: of equal depths the upper one is nearer. It is told with the number.
@vertex
fn vertex_coplanar_layer(in: Vertex, plane: Plane, @builtin(instance_index) layer: u32) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = code_in_plane(face.code, layer);
    return face;
}

fn code_in_plane(code: u32, layer: u32) -> u32 {
    return (code & NODE_CODE) | ((MOST_IN_PLANE - min(layer, MOST_IN_PLANE)) << PLANE_SHIFT);
}

// Its depth is that of the plane, not the interpolated one that the depth test would take.
@fragment
fn note_coplanar(in: CoplanarVarying) {
    let depth = depth_on_plane(in.plane, in.clip);
    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, in.plane.xy) {
        return;
    }
    let code = in.code & NODE_CODE;
    let normal = select(0u, normal_code(in.normal, code), SMOOTH);
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, normal, natural_color(code), 0u);
}

@vertex
fn vertex_textured_layer(
    in: Vertex,
    plane: Plane,
    @location(7) texcoord: vec2f,
    @builtin(instance_index) layer: u32,
) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.code = code_in_plane(face.code, layer);
    face.texcoord = texcoord;
    return face;
}

@fragment
fn note_textured_coplanar(in: CoplanarVarying) {
    let code = in.code & NODE_CODE;
    let look = look_at(in.texcoord, in.normal, in.relative, code);
    let depth = depth_on_plane(in.plane, in.clip);
    let is_behind = textureLoad(opaque_depth, vec2i(in.clip.xy), 0) > depth - room_before_opaque(depth, in.plane.xy);
    if is_behind || look.opacity < ALPHA_CUTOFF {
        return;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    add_node(in.clip.xy, depth, code, in.code & ~NODE_CODE, look.normal, packed_texel(look.color), packed(look.light));
}
