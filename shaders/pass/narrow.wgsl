// The lists of invokers, tile by tile, narrowed to what the tile shows (L8): what acts inside of a lens alone is left out where no
// shown place of the tile lies in the box around the lens. First a workgroup for each tile of 32 x 32 pixels finds the box around what
// it shows, then an invocation for each tile goes through its list: nobody waits, which software adapters are slow at.

@group(1) @binding(0) var scene_depth: texture_depth_2d;
// Per tile six places: where its invokers of each section begin, and where the last end; first those outside of all lenses.
@group(1) @binding(1) var<storage, read> lists: array<u32>;
@group(1) @binding(2) var<storage, read> reaches: array<Reach>;
@group(1) @binding(3) var<storage, read_write> narrowed: array<u32>;
// Of each tile, where its places begin and where they end; both with a rounding's room.
@group(1) @binding(4) var<storage, read_write> shown: array<array<vec3f, 2>>;

// Where an invoker may act: a box in x, y, and the distance D along the view axis, metres.
struct Reach {
    low: vec3f,
    is_everywhere: u32,
    high: vec3f,
}

const TILE_PX: u32 = 32u;
const SECTIONS: u32 = 5u;
// Places are rounded on both sides.
const SLACK: f32 = 1e-4;

// The box around all shown places, as numbers in the order of the floats they stand for.
var<workgroup> lowest: array<atomic<u32>, 3>;
var<workgroup> highest: array<atomic<u32>, 3>;

fn in_order(number: f32) -> u32 {
    let bits = bitcast<u32>(number);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn float_of(place: u32) -> f32 {
    return bitcast<f32>(select(~place, place & 0x7fffffffu, (place & 0x80000000u) != 0u));
}

// Tiles in a row, and rows.
fn tiles() -> vec2u {
    return (textureDimensions(scene_depth) + TILE_PX - 1u) / TILE_PX;
}

// Few invocations with many pixels each: what they join by atomics is done one after the other.
@compute @workgroup_size(8, 2)
fn measure(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) at: vec3u,
           @builtin(local_invocation_index) lane: u32) {
    let size = textureDimensions(scene_depth);
    if lane < 3u {
        atomicStore(&lowest[lane], in_order(FAR_AWAY));
        atomicStore(&highest[lane], in_order(-FAR_AWAY));
    }
    workgroupBarrier();
    var low = vec3f(FAR_AWAY);
    var high = vec3f(-FAR_AWAY);
    for (var i = 0u; i < 64u; i++) {
        let pixel = tile.xy * TILE_PX + at.xy * vec2u(4u, 16u) + vec2u(i % 4u, i / 4u);
        if all(pixel < size) {
            let depth = textureLoad(scene_depth, pixel, 0);
            if depth > 0.0 {
                let ray = ray_of_pixel(vec2f(pixel) + 0.5);
                let distance = distance_of_depth(depth);
                let place = vec3f(ray.origin.xy + distance * ray.direction.xy, distance);
                low = min(low, place);
                high = max(high, place);
            }
        }
    }
    for (var i = 0u; i < 3u; i++) {
        atomicMin(&lowest[i], in_order(low[i]));
        atomicMax(&highest[i], in_order(high[i]));
    }
    workgroupBarrier();
    if lane != 0u {
        return;
    }
    for (var i = 0u; i < 3u; i++) {
        low[i] = float_of(atomicLoad(&lowest[i]));
        high[i] = float_of(atomicLoad(&highest[i]));
    }
    let far = max(abs(low), abs(high));
    let slack = SLACK * (max(far.x, max(far.y, far.z)) + 1.0);
    // Where nothing is shown the box stays inside out: no other one meets it.
    let widened = select(0.0, slack, low.z <= high.z);
    shown[tile.y * tiles().x + tile.x] = array<vec3f, 2>(low - widened, high + widened);
}

@compute @workgroup_size(8, 1)
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
    let low = shown[tile][0];
    let high = shown[tile][1];
    let record = (SECTIONS + 1u) * (1u + tile);
    var place = lists[record];
    for (var section = 0u; section < SECTIONS; section++) {
        let first = lists[record + section];
        let last = lists[record + section + 1u];
        narrowed[record + section] = place;
        for (var i = first; i < last; i++) {
            let by = lists[i];
            let reach = reaches[by];
            if reach.is_everywhere != 0u || (all(reach.low <= high) && all(reach.high >= low)) {
                narrowed[place] = by;
                place++;
            }
        }
    }
    narrowed[record + SECTIONS] = place;
}
