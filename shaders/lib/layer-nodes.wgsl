// The lists of translucent layers, as `pass/layers.wgsl` fills them.

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
    //@elsewhere
    if !ALL && !is_layer(fragment_at(at, depth, code)) {
        return;
    }
    keep_node(at, depth, code, plane, normal, color, light);
}

// A layer that is there.
fn keep_node(at: vec2f, depth: f32, code: u32, plane: u32, normal: u32, color: u32, light: u32) {
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
