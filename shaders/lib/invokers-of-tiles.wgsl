// Per tile seven places: where its invokers of each section begin, and where the last end; first those outside of all lenses. Then the
// invokers, three words each: place and call, which most is asked of, and the number in the table.
@group(2) @binding(8) var<storage, read> tile_lists: array<u32>;

const OPACITIES: u32 = 0u;
const MATERIALS: u32 = 1u;
const LIGHTS: u32 = 2u;
const STYLES: u32 = 3u;
const OUTLINES: u32 = 4u;
const MASKS: u32 = 5u;
const ENTRY: u32 = 3u;          // words

fn invokers_of(classes: Classes, section: u32) -> vec2u {
    let record = 7u * tile_of(classes) + section;
    return vec2u(tile_lists[record], tile_lists[record + 1u]);
}

fn listed(at: u32) -> Invoker {
    let others = invokers[tile_lists[at + 2u]];
    return unpacked_invoker(PackedInvoker(tile_lists[at], tile_lists[at + 1u], others.slots, others.number));
}

// Which of the invokers from `first` up to `end` of the lists, at most 32, run at a place: a bit for each.
fn running(first: u32, end: u32, classes: Classes) -> u32 {
    var bits = 0u;
    var bit = 1u;
    for (var k = first; k < end; k += ENTRY) {
        bits |= select(0u, bit, runs(listed(k), classes));
        bit <<= 1u;
        if k + ENTRY == end {
            break;
        }
    }
    return bits;
}
