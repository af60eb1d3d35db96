// Makes lists of what `lib/slots.wgsl` found, in the order of their slots, as `pass/composite.wgsl` goes through them, and counts what
// is left.

struct Band {
    origin: vec2u,                  // pixels
    size: vec2u,
    picture: vec2u,                 // pixels of the whole
    round: u32,                     // of peeling, from 0
    reserved: u32,
}

@group(0) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read_write> slots: array<u32>;
@group(0) @binding(2) var<uniform> band: Band;

override SLOTS: u32 = 8u;
override WORDS: u32 = 3u;           // of a slot
override RECORD: u32 = 1u;          // of a pixel
override LIMIT: u32 = 0u;           // layers of a pixel at most; 0: all

// Words of `heads`: all layers, the largest number of layers of a pixel, layers that found no slot.
const NOTED: u32 = 0u;
const MOST_LAYERS: u32 = 1u;
const LEFT: u32 = 2u;
const FIRST_HEAD: u32 = 272u;
// Words of a record.
const LAST_DEPTH: u32 = 1u;
const LAST_CODE: u32 = 2u;
const LET_THROUGH: u32 = 6u;
const LAID: u32 = 7u;
const NOTHING_SEEN: f32 = 5.9604645e-8;

@compute @workgroup_size(64)
fn link(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = id.y * groups.x * 64u + id.x;
    if number >= band.size.x * band.size.y {
        return;
    }
    let pixel = band.origin + vec2u(number % band.size.x, number / band.size.x);
    let index = pixel.y * band.picture.x + pixel.x;
    let record = FIRST_HEAD + band.picture.x * band.picture.y + index * RECORD;
    let all = atomicLoad(&heads[record]);
    var laid = 0u;
    var is_done = false;
    if RECORD > 1u {
        laid = atomicLoad(&heads[record + LAID]);
        is_done = laid > 0u && bitcast<f32>(atomicLoad(&heads[record + LET_THROUGH])) < NOTHING_SEEN;
    }
    let room = arrayLength(&slots) / WORDS;
    var found = 0u;
    var last = 0u;
    for (var i = 0u; i < SLOTS; i++) {
        let slot = number * SLOTS + i;
        let place = key_place(slot);
        let is_there = slots[place] != 0u && (LIMIT == 0u || laid + i < LIMIT);
        if is_there {
            slots[place + 1u] = ~slots[place + 1u];
            slots[link_place(room, slot)] = 0u;
            if i > 0u {
                slots[link_place(room, slot - 1u)] = slot + 1u;
            }
            found = i + 1u;
            last = place;
        }
        if !is_there || i + 1u == SLOTS {
            break;
        }
    }
    atomicStore(&heads[FIRST_HEAD + index], select(0u, number * SLOTS + 1u, found > 0u));
    if found > 0u && RECORD > 1u {
        atomicStore(&heads[record + LAST_DEPTH], slots[last]);
        atomicStore(&heads[record + LAST_CODE], slots[last + 1u]);
    }
    if band.round == 0u && all > 0u {
        atomicAdd(&heads[NOTED], all);
        atomicMax(&heads[MOST_LAYERS], all);
    }
    // Of fragments that are alike in depth and surface one may have been laid for several: where nothing is found, nothing is left.
    if !is_done && (found > 0u || (LIMIT > 0u && laid >= LIMIT)) && all > laid + found {
        atomicAdd(&heads[LEFT], all - laid - found);
    }
}
