// Translucent layers of a pixel (O7), as `pass/layers.wgsl` noted them: sorted by their full depth, each shaded as what is opaque
// is, with its own place in the lenses, and laid one over the other in f32, nearest first.
//
// The nearest notes are found several at a time, in one walk through the list; that goes on from the last of them until all are
// laid or nothing more would be seen. What is not done after MOST_ROUNDS is told; the host has lists sorted then
// (`pass/sort-layers.wgsl`). Equal depths are told apart by the number of the surface, so the order in which the city is
// drawn does not matter.

@group(3) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
@group(3) @binding(1) var<storage, read> notes: array<u32>;

const FIRST_HEAD: u32 = 272u;
const NOTED_CODE: u32 = 0x07ffffffu;
override SORTED: bool = false;  // whether lists are in order
// Words of a record that methods keep of each pixel behind the heads, as `lib/slots.wgsl` has it; 0: none. One says how many layers
// there are; with more of them lists go on where others ended.
override RECORD: u32 = 0u;
// Whether what found no place in the lists is one layer behind them, as `lib/tail.wgsl` makes it.
override TAIL: bool = false;
@group(3) @binding(2) var tail_sums: texture_2d<f32>;
@group(3) @binding(3) var tail_through: texture_2d<f32>;
const RECORD_COLOR: u32 = 3u;
const RECORD_THROUGH: u32 = 6u;
const RECORD_LAID: u32 = 7u;
const RECORD_SHOWN: u32 = 8u;
const RECORD_SHOWN_DEPTH: u32 = 10u;
const RECORD_BEFORE: u32 = 11u;     // bits of the depth of the last layer
// Mesa's software driver ends the loops of a shader after 65535 rounds in all.
const MOST_ROUNDS: u32 = 50000u;
// Whether one layer is told, with its opacity below 0, in place of all: what is composited elsewhere.
override PICKS: bool = false;
const PICKED: u32 = 3u;         // the word of `heads` that has its number
const LONGEST: u32 = 2u;        // the word of `heads` that has the length of the longest list that was not done
const MOST_LAYERS: u32 = 1u;    // the word of `heads` that has the largest number of layers of a pixel
// What is let through below this is not seen, whatever its colour.
const NOTHING_SEEN: f32 = 5.9604645e-8;     // 2^-24

// A note, and what it is sorted by.
struct Note {
    depth: u32,                 // bits of the stored depth: the larger, the nearer; 0: none
    code: u32,                  // surface + 1, below how many layers of its plane may be over it
    number: u32,
}

const NO_NOTE = Note(0u, 0u, 0u);

fn note_words() -> u32 {
    return 3u + select(0u, 1u, SMOOTH) + select(0u, 1u, TEXTURED);
}

// How many layers the pixel of the picture has that has most.
fn most_layers() -> u32 {
    return atomicLoad(&heads[MOST_LAYERS]);
}

// What a rule returned, as an opacity: nothing that is no number.
fn contained_opacity(opacity: f32) -> f32 {
    return select(0.0, min(opacity, 1.0), opacity > 0.0);
}

//@opacity

// Whether a note comes before another: it is nearer, or stands in the plane of the other and is put before it.
fn precedes(a: Note, b: Note) -> bool {
    let is_before = a.code < b.code || (a.code == b.code && a.number < b.number);
    return a.depth > b.depth || (a.depth == b.depth && is_before);
}

// Keeps the nearer one; `other` is the farther one then.
fn keep_nearer(kept: ptr<function, Note>, other: ptr<function, Note>) {
    if precedes(*other, *kept) {
        let farther = *kept;
        *kept = *other;
        *other = farther;
    }
}

struct Composite {
    @location(0) veil: vec4f,   // colours times opacity; a: what is let through
    @location(1) shown: vec2u,  // number and normal of the layer that is the shown surface, as the geometry target has them; 0: none
    @location(2) depth: f32,    // its stored depth
}

@fragment
fn veil(in: Corner) -> @location(0) vec4f {
    return composite(in).veil;
}

@fragment
fn veil_and_shown(in: Corner) -> Composite {
    return composite(in);
}

// A number of a record.
fn recorded(word: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&heads[word]));
}

fn composite(in: Corner) -> Composite {
    take(in);
    let pixel = vec2i(in.clip.xy);
    let ray = ray_of_pixel(in.clip.xy);
    let words = note_words();
    let head = atomicLoad(&heads[FIRST_HEAD + u32(pixel.y) * u32(view.size.x) + u32(pixel.x)]);
    var color = vec3f(0.0);
    var through = 1.0;
    var shown = vec2u(0u);
    var shown_depth = 0.0;
    var laid = 0u;
    var last = Note(0xffffffffu, 0u, 0u);
    var count = 0u;
    var rounds = 0u;            // of walks
    var picked = vec4f(0.0, 0.0, 0.0, 1.0);
    let least_seen = select(NOTHING_SEEN, 0.0, PICKS);
    var listed = head;          // of a list in order: the next note
    var is_left = head != 0u;
    if SORTED {
        for (var next = head; next != 0u; next = notes[(next - 1u) * words]) {
            count += 1u;
        }
    }
    let size = vec2u(view.size);
    let record = FIRST_HEAD + size.x * size.y + (u32(pixel.y) * size.x + u32(pixel.x)) * RECORD;
    if RECORD > 0u {
        count = atomicLoad(&heads[record]);
    }
    if RECORD > 1u {
        laid = atomicLoad(&heads[record + RECORD_LAID]);
    }
    if RECORD > 1u && laid > 0u {
        color = vec3f(recorded(record + RECORD_COLOR), recorded(record + RECORD_COLOR + 1u), recorded(record + RECORD_COLOR + 2u));
        through = recorded(record + RECORD_THROUGH);
        shown = vec2u(atomicLoad(&heads[record + RECORD_SHOWN]), atomicLoad(&heads[record + RECORD_SHOWN + 1u]));
        shown_depth = recorded(record + RECORD_SHOWN_DEPTH);
        // What is in the list comes after it.
        last.depth = atomicLoad(&heads[record + RECORD_BEFORE]);
    }
    while is_left {
        //@found
        var next = select(head, 0u, SORTED);
        count = select(0u, count, SORTED);
        if SORTED {
            let place = (listed - 1u) * words;
            found_0 = Note(notes[place + 1u], notes[place + 2u], listed);
            listed = notes[place];
        }
        while next != 0u {
            let place = (next - 1u) * words;
            var note = Note(notes[place + 1u], notes[place + 2u], next);
            if !precedes(last, note) {
                note = NO_NOTE;
            }
            //@keep
            count += 1u;
            next = notes[place];
            // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
            if next == 0u {
                break;
            }
        }
        rounds += count;
        while found_0.depth != 0u {
            let note = found_0;
            let place = (note.number - 1u) * words;
            let depth = bitcast<f32>(note.depth);
            var normal = 0u;
            if SMOOTH {
                normal = notes[place + 3u];
            }
            let code = note.code & NOTED_CODE;
            var point = point_of(pixel, ray, depth, vec2u(code, normal));
            point.base = point.natural;
            if TEXTURED {
                point.base = unpacked(notes[place + words - 1u]);
            }
            if CLAY {
                point.base = CLAY_COLOR;
            }
            point.layer = laid;
            point.last_layer = count - 1u;
            point.is_covered = note.depth == last.depth;
            let classes = classes_at(sight_at(pixel, ray, depth, point.object), in.part.x);
            let opacity = opacity_at(point, classes);
            let paint = shade(&point, classes);
            color += (through * opacity) * paint;
            through *= 1.0 - opacity;
            if PICKS {
                picked = select(picked, vec4f(paint, -opacity), laid == atomicLoad(&heads[PICKED]));
            }
            if through <= 0.5 && shown.x == 0u {
                shown = vec2u(code, normal);
                shown_depth = depth;
                write_classes(pixel, point, classes);
            }
            laid += 1u;
            last = note;
            //@shift
            if found_0.depth == 0u || through < least_seen {
                break;
            }
        }
        is_left = select(laid < count, listed != 0u, SORTED) && through >= least_seen;
        if is_left && !SORTED && rounds + count > MOST_ROUNDS {
            atomicMax(&heads[LONGEST], count);
            is_left = false;
        }
        if !is_left {
            break;
        }
    }
    if TAIL {
        let sum = textureLoad(tail_sums, pixel, 0);
        let rest = textureLoad(tail_through, pixel, 0).x;
        if sum.a > 0.0 {
            color += (through * (1.0 - rest)) * (sum.rgb / sum.a);
        }
        through *= rest;
        // Which of the layers is the shown surface is not known: it is what is opaque.
        if through <= 0.5 && shown.x == 0u {
            let point = point_at(pixel, ray, textureLoad(scene_depth, pixel, 0));
            write_classes(pixel, point, classes_at(sight_at(pixel, ray, point.depth, point.object), in.part.x));
        }
    }
    if RECORD > 1u && laid > 0u {
        for (var i = 0u; i < 3u; i++) {
            atomicStore(&heads[record + RECORD_COLOR + i], bitcast<u32>(color[i]));
            if i == 2u {
                break;
            }
        }
        atomicStore(&heads[record + RECORD_THROUGH], bitcast<u32>(through));
        atomicStore(&heads[record + RECORD_LAID], laid);
        atomicStore(&heads[record + RECORD_SHOWN], shown.x);
        atomicStore(&heads[record + RECORD_SHOWN + 1u], shown.y);
        atomicStore(&heads[record + RECORD_SHOWN_DEPTH], bitcast<u32>(shown_depth));
        atomicStore(&heads[record + RECORD_BEFORE], last.depth);
    }
    return Composite(select(vec4f(color, through), picked, PICKS), shown, shown_depth);
}
