// The nearest translucent fragments of each pixel, a fixed number of them: K-buffer and peeling. Two or three passes over the
// city find them whatever the order in which it is drawn.
//
//   depths   each fragment goes down the slots of its pixel; a slot keeps the nearest depth that came by, the other goes on
//   codes    those whose depth was kept give their numbers; of equal depths, in the order of their numbers
//   rest     normals, and colours and shares of light of textures, where the picture has them
//
// `pass/link-slots.wgsl` makes lists of them as `pass/layers.wgsl` does, in order. Peeling does this again and again, with what
// is behind all that was laid before. A slot is a node as `lib/fragment-nodes.wgsl` has them; while slots are filled the bits of the number
// are inverted: the smaller the number the nearer.

override STAGE: u32 = 0u;
override SLOTS: u32 = 8u;           // of a pixel
override RECORD: u32 = 1u;          // words of a pixel's record: 1, or all where it is peeled
const DEPTHS: u32 = 0u;
const CODES: u32 = 1u;

// Words of `heads` before those of the pixels; a record for each pixel follows these.
const FIRST_RECORD: u32 = 272u;
// Words of a record.
const ALL_LAYERS: u32 = 0u;         // how many layers the pixel has
const LAST_DEPTH: u32 = 1u;         // of the last that was laid: bits of its depth; 0: none
const LAST_CODE: u32 = 2u;
const LET_THROUGH: u32 = 6u;
const LAID_SO_FAR: u32 = 7u;
// As `pass/composite.wgsl` has it.
const UNSEEN: f32 = 5.9604645e-8;

// The part of the picture that there are slots for.
struct Band {
    origin: vec2u,                  // pixels
    size: vec2u,
}

@group(0) @binding(1) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read_write> slots: array<atomic<u32>>;
@group(0) @binding(4) var<uniform> band: Band;

struct Laid {
    @location(0) nothing: vec4f,
}

fn record_of(pixel: vec2u) -> u32 {
    let size = vec2u(view.size);
    return FIRST_RECORD + size.x * size.y + (pixel.y * size.x + pixel.x) * RECORD;
}

// Whether a fragment is behind all that was laid before, and may still be seen.
fn is_behind_laid(record: u32, depth: u32, code: u32) -> bool {
    let last = atomicLoad(&heads[record + LAST_DEPTH]);
    if last == 0u {
        return true;
    }
    let is_behind = depth < last || (depth == last && code > atomicLoad(&heads[record + LAST_CODE]));
    let is_done = atomicLoad(&heads[record + LAID_SO_FAR]) > 0u
        && bitcast<f32>(atomicLoad(&heads[record + LET_THROUGH])) < UNSEEN;
    return is_behind && !is_done;
}

fn lay(at: vec2f, depth: f32, code: u32, plane: u32, normal: u32, color: u32, light: u32) -> Laid {
    let pixel = vec2u(at);
    let inside = pixel - band.origin;
    let room = arrayLength(&slots) / words_of_node();
    let first = (inside.y * band.size.x + inside.x) * SLOTS;
    let record = record_of(pixel);
    let bits = bitcast<u32>(depth);
    // The smaller the number the nearer, and the larger the key.
    var key = ~(code | plane);
    // A fragment farther than the last slot has no place; while depths are found, only where some were laid before is that all.
    var is_wanted = STAGE == DEPTHS || atomicLoad(&slots[key_place(first + SLOTS - 1u)]) <= bits;
    if RECORD > 1u {
        is_wanted = is_wanted && is_behind_laid(record, bits, code | plane);
    }
    if !is_wanted || !is_layer(fragment_at(at, depth, code)) {
        return Laid(vec4f(0.0));
    }
    if STAGE == DEPTHS {
        var is_counted = true;
        if RECORD > 1u {
            is_counted = atomicLoad(&heads[record + LAST_DEPTH]) == 0u;
        }
        if is_counted {
            atomicAdd(&heads[record + ALL_LAYERS], 1u);
        }
        var rest = bits;
        for (var i = 0u; i < SLOTS; i++) {
            let before = atomicMax(&slots[key_place(first + i)], rest);
            rest = min(before, rest);
            if rest == 0u || i + 1u == SLOTS {
                break;
            }
        }
    } else {
        for (var i = 0u; i < SLOTS; i++) {
            let place = key_place(first + i);
            let kept = atomicLoad(&slots[place]);
            if kept == bits && STAGE == CODES {
                let before = atomicMax(&slots[place + 1u], key);
                key = min(before, key);
            } else if kept == bits && atomicLoad(&slots[place + 1u]) == key {
                if SMOOTH {
                    atomicStore(&slots[rest_place(room, first + i, normal_word())], normal);
                }
                if TEXTURED {
                    atomicStore(&slots[rest_place(room, first + i, color_word())], color);
                }
                if TEXELS_EMIT {
                    atomicStore(&slots[rest_place(room, first + i, light_word())], light);
                }
            }
            if kept < bits || key == 0u || i + 1u == SLOTS {
                break;
            }
        }
    }
    return Laid(vec4f(0.0));
}
