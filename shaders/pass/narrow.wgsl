// The lists of invokers, tile by tile, narrowed to what the tile shows (L8): what acts inside of a lens alone is left out where no
// shown place of the tile lies in the box around the lens. One workgroup for each tile of 32 x 32 pixels.

@group(1) @binding(0) var scene_depth: texture_depth_2d;
// Per tile six places: where its invokers of each section begin, and where the last end; first those outside of all lenses.
@group(1) @binding(1) var<storage, read> lists: array<u32>;
@group(1) @binding(2) var<storage, read> reaches: array<Reach>;
@group(1) @binding(3) var<storage, read_write> narrowed: array<u32>;

// Where an invoker may act: a box in x, y, and the distance D along the view axis, metres.
struct Reach {
    low: vec3f,
    is_everywhere: u32,
    high: vec3f,
}

const TILE_PX: u32 = 32u;
const SECTIONS: u32 = 5u;
const LANES: u32 = 64u;
// Places are rounded on both sides.
const SLACK: f32 = 1e-4;

// The box around all shown places, as numbers in the order of the floats they stand for.
var<workgroup> lowest: array<atomic<u32>, 3>;
var<workgroup> highest: array<atomic<u32>, 3>;
// Which of the invokers at hand stay: a bit each.
var<workgroup> staying: array<atomic<u32>, 2>;

fn in_order(number: f32) -> u32 {
    let bits = bitcast<u32>(number);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn float_of(place: u32) -> f32 {
    return bitcast<f32>(select(~place, place & 0x7fffffffu, (place & 0x80000000u) != 0u));
}

@compute @workgroup_size(8, 8)
fn narrow(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) at: vec3u,
          @builtin(local_invocation_index) lane: u32) {
    let size = textureDimensions(scene_depth);
    if lane < 3u {
        atomicStore(&lowest[lane], in_order(FAR_AWAY));
        atomicStore(&highest[lane], in_order(-FAR_AWAY));
    }
    workgroupBarrier();
    var low = vec3f(FAR_AWAY);
    var high = vec3f(-FAR_AWAY);
    for (var i = 0u; i < 16u; i++) {
        let pixel = tile.xy * TILE_PX + at.xy * 4u + vec2u(i % 4u, i / 4u);
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
    // Nothing outside of lenses is left out.
    if tile.x == 0u && tile.y == 0u {
        for (var i = lane; i <= SECTIONS; i += LANES) {
            narrowed[i] = lists[i];
        }
        for (var i = lists[0] + lane; i < lists[SECTIONS]; i += LANES) {
            narrowed[i] = lists[i];
        }
    }
    for (var i = 0u; i < 3u; i++) {
        low[i] = float_of(atomicLoad(&lowest[i]));
        high[i] = float_of(atomicLoad(&highest[i]));
    }
    let is_empty = low.z > high.z;
    let far = max(abs(low), abs(high));
    let slack = SLACK * (max(far.x, max(far.y, far.z)) + 1.0);
    low -= slack;
    high += slack;
    let record = (SECTIONS + 1u) * (1u + tile.y * ((size.x + TILE_PX - 1u) / TILE_PX) + tile.x);
    var place = lists[record];
    for (var section = 0u; section < SECTIONS; section++) {
        if lane == 0u {
            narrowed[record + section] = place;
        }
        let last = lists[record + section + 1u];
        for (var first = lists[record + section]; first < last; first += LANES) {
            if lane < 2u {
                atomicStore(&staying[lane], 0u);
            }
            workgroupBarrier();
            let i = first + lane;
            var stays = false;
            if i < last {
                let reach = reaches[lists[i]];
                let meets = all(reach.low <= high) && all(reach.high >= low);
                stays = reach.is_everywhere != 0u || (!is_empty && meets);
            }
            if stays {
                atomicOr(&staying[lane / 32u], 1u << (lane % 32u));
            }
            workgroupBarrier();
            let those = vec2u(atomicLoad(&staying[0]), atomicLoad(&staying[1]));
            if stays {
                let earlier = those[lane / 32u] & ((1u << (lane % 32u)) - 1u);
                let before = countOneBits(earlier) + select(0u, countOneBits(those.x), lane >= 32u);
                narrowed[place + before] = lists[i];
            }
            place += countOneBits(those.x) + countOneBits(those.y);
            workgroupBarrier();
        }
    }
    if lane == 0u {
        narrowed[record + SECTIONS] = place;
    }
}
