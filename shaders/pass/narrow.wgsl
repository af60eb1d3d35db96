// The lists of invokers, tile by tile, narrowed to what the tile shows: what acts inside of a lens alone is left out where no
// shown place of the tile lies in the box around the lens. First the depths that each tile shows are found, by an invocation for each
// two columns of it; then an invocation for each tile goes through its list. No invocation waits for another or counts with it: software
// adapters are slow at both. Loops leave at the end of their last round: such an adapter goes through a whole round to find that there
// is none.

@group(1) @binding(0) var scene_depth: texture_depth_2d;
// Per tile six places: where its invokers of each section begin, and where the last end; first those outside of all lenses. Then the
// invokers, three words each; the last is the number of the invoker.
@group(1) @binding(1) var<storage, read> lists: array<u32>;
@group(1) @binding(2) var<storage, read> reaches: array<Reach>;
@group(1) @binding(3) var<storage, read_write> narrowed: array<u32>;
// Of each two columns of each tile, the least and the most of the stored depths that something is shown at.
@group(1) @binding(4) var<storage, read_write> shown: array<vec2f>;

// Where an invoker may act: a box in x, y, and the distance D along the view axis, metres; from and to, as halves: a software
// adapter takes long for each word that it reads.
struct Reach {
    x: u32,
    y: u32,
    distance: u32,
}

// From there, and up to there; whatever the numbers are, there is no end.
const NO_START: u32 = 0xfc00u;
const NO_END: u32 = 0x7c00u;

const TILE_PX: u32 = 32u;
const PAIRS: u32 = 16u;         // of columns of a tile
const SECTIONS: u32 = 6u;
const ENTRY: u32 = 3u;          // words
// Places are rounded on both sides.
const SLACK: f32 = 1e-4;

// Tiles in a row, and rows.
fn tiles() -> vec2u {
    return (textureDimensions(scene_depth) + TILE_PX - 1u) / TILE_PX;
}

// Where the places of a tile begin among the words of the lists.
fn record_of(tile: u32) -> u32 {
    return (SECTIONS + 1u) * (1u + tile);
}

@compute @workgroup_size(16)
fn measure(@builtin(workgroup_id) at: vec3u, @builtin(local_invocation_index) pair: u32) {
    let size = textureDimensions(scene_depth);
    let tile = at.y * tiles().x + at.x;
    // An empty list needs none.
    let is_empty = lists[record_of(tile)] == lists[record_of(tile) + SECTIONS];
    let rounds = select(2u * TILE_PX, 1u, is_empty);
    var least = 2.0;
    var most = 0.0;
    for (var i = 0u; i < rounds; i++) {
        let pixel = at.xy * TILE_PX + vec2u(2u * pair + (i & 1u), i >> 1u);
        // What is beyond the picture is at its edge.
        let depth = textureLoad(scene_depth, min(pixel, size - 1u), 0);
        least = select(least, min(least, depth), depth > 0.0);
        most = max(most, depth);
        if i + 1u == rounds {
            break;
        }
    }
    shown[tile * PAIRS + pair] = vec2f(least, most);
}

// The box around all that a tile may show; inside out where that is nothing.
struct Box {
    low: vec3f,
    high: vec3f,
}

fn box_of(tile: u32) -> Box {
    var least = 2.0;
    var most = 0.0;
    for (var i = 0u; i < PAIRS; i++) {
        let own = shown[tile * PAIRS + i];
        least = min(least, own.x);
        most = max(most, own.y);
    }
    if most <= 0.0 {
        return Box(vec3f(FAR_AWAY), vec3f(-FAR_AWAY));
    }
    let near = distance_of_depth(most);
    let far = distance_of_depth(least);
    let corner = vec2f(vec2u(tile % tiles().x, tile / tiles().x) * TILE_PX);
    let first = ray_of_pixel(corner);
    let last = ray_of_pixel(corner + f32(TILE_PX));
    let a = first.origin.xy + near * first.direction.xy;
    let b = first.origin.xy + far * first.direction.xy;
    let c = last.origin.xy + near * last.direction.xy;
    let d = last.origin.xy + far * last.direction.xy;
    let low = vec3f(min(min(a, b), min(c, d)), near);
    let high = vec3f(max(max(a, b), max(c, d)), far);
    let reach = max(abs(low), abs(high));
    let slack = SLACK * (max(reach.x, max(reach.y, reach.z)) + 1.0);
    return Box(low - slack, high + slack);
}

fn meets(reach: Reach, own: Box) -> bool {
    let words = vec3u(reach.x, reach.y, reach.distance);
    let x = unpack2x16float(words.x);
    let y = unpack2x16float(words.y);
    let distance = unpack2x16float(words.z);
    let starts = (vec3f(x.x, y.x, distance.x) <= own.high) | ((words & vec3u(0xffffu)) == vec3u(NO_START));
    let ends = (vec3f(x.y, y.y, distance.y) >= own.low) | ((words >> vec3u(16u)) == vec3u(NO_END));
    return all(starts & ends);
}

@compute @workgroup_size(8)
fn narrow(@builtin(global_invocation_id) at: vec3u) {
    let tile = at.x;
    if tile >= tiles().x * tiles().y {
        return;
    }
    // Of what is outside of lenses nothing is left out.
    if tile == 0u {
        for (var i = 0u; i < lists[SECTIONS]; i++) {
            if i <= SECTIONS || i >= lists[0] {
                narrowed[i] = lists[i];
            }
        }
    }
    let own = box_of(tile);
    let record = record_of(tile);
    var place = lists[record];
    for (var section = 0u; section < SECTIONS; section++) {
        let last = lists[record + section + 1u];
        narrowed[record + section] = place;
        for (var i = lists[record + section]; i < last; i += ENTRY) {
            let invoker = lists[i + 2u];
            if meets(reaches[invoker], own) {
                narrowed[place] = lists[i];
                narrowed[place + 1u] = lists[i + 1u];
                narrowed[place + 2u] = invoker;
                place += ENTRY;
            }
            if i + ENTRY >= last {
                break;
            }
        }
    }
    narrowed[record + SECTIONS] = place;
}
