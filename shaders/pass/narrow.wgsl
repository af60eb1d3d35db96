// The lists of invokers, tile by tile, narrowed to what the tile shows (L8): what acts inside of a lens alone is left out where
// all surfaces of the tile are nearer than the lens, or further away. One workgroup for each tile of 32 x 32 pixels.

@group(1) @binding(0) var scene_depth: texture_depth_2d;
// Per tile six places: where its invokers of each section begin, and where the last end; first those outside of all lenses.
@group(1) @binding(1) var<storage, read> lists: array<u32>;
// Of each invoker the distances D between which it may act, metres.
@group(1) @binding(2) var<storage, read> reaches: array<vec2f>;
@group(1) @binding(3) var<storage, read_write> narrowed: array<u32>;

const TILE_PX: u32 = 32u;
const SECTIONS: u32 = 5u;
// Distances are rounded on both sides.
const SLACK: f32 = 1e-4;

// Stored depths, as bits: those of positive numbers are in their order.
var<workgroup> lowest: atomic<u32>;
var<workgroup> highest: atomic<u32>;

@compute @workgroup_size(8, 8)
fn narrow(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) at: vec3u,
          @builtin(local_invocation_index) number: u32) {
    let size = textureDimensions(scene_depth);
    if number == 0u {
        atomicStore(&lowest, bitcast<u32>(2.0));
        atomicStore(&highest, 0u);
    }
    workgroupBarrier();
    var low = 2.0;
    var high = 0.0;
    for (var i = 0u; i < 16u; i++) {
        let pixel = tile.xy * TILE_PX + at.xy * 4u + vec2u(i % 4u, i / 4u);
        if all(pixel < size) {
            let depth = textureLoad(scene_depth, pixel, 0);
            high = max(high, depth);
            low = min(low, select(2.0, depth, depth > 0.0));
        }
    }
    atomicMin(&lowest, bitcast<u32>(low));
    atomicMax(&highest, bitcast<u32>(high));
    workgroupBarrier();
    if number != 0u {
        return;
    }
    if tile.x == 0u && tile.y == 0u {
        for (var i = 0u; i <= SECTIONS; i++) {
            narrowed[i] = lists[i];
        }
        for (var i = lists[0]; i < lists[SECTIONS]; i++) {
            narrowed[i] = lists[i];
        }
    }
    high = bitcast<f32>(atomicLoad(&highest));
    let is_empty = high <= 0.0;
    let nearest = distance_of_depth(max(high, 1e-30));
    let furthest = distance_of_depth(max(bitcast<f32>(atomicLoad(&lowest)), 1e-30));
    let slack = SLACK * (abs(furthest) + 1.0);
    let record = (SECTIONS + 1u) * (1u + tile.y * ((size.x + TILE_PX - 1u) / TILE_PX) + tile.x);
    var place = lists[record];
    for (var section = 0u; section < SECTIONS; section++) {
        let first = lists[record + section];
        let last = lists[record + section + 1u];
        narrowed[record + section] = place;
        for (var i = first; i < last; i++) {
            let reach = reaches[lists[i]];
            let is_always = reach.y >= FAR_AWAY;
            if is_always || (!is_empty && reach.x <= furthest + slack && reach.y >= nearest - slack) {
                narrowed[place] = lists[i];
                place++;
            }
        }
    }
    narrowed[record + SECTIONS] = place;
}
