// The depth sprite of a lens that is no convex volume: the ends of its closed forms and the crossings with the faces of its solids, in their
// order along the ray; an entry into a solid counts 1, an exit -1, and the ray is in the solid where the sum is not 0. Where the
// combination of the leaves begins or ends to hold, an interval does. Twin: `veduta::lens::classify::intervals_of`.
//
// The entries and exits of a closed surface balance. Where they do not (a corner on another face's edge that the rasteriser went
// past, a list that found no room), the list of a texel beside it is followed.

@group(2) @binding(2) var<storage, read_write> lists: array<u32>;
@group(2) @binding(3) var<storage, read_write> crossings: array<u32>;
@group(2) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

const NONE: u32 = 0xffffffffu;
// Operations are 24 bits.
const IS_SOLID: u32 = 0x80000000u;

// Shorter intervals and gaps, as part of the distance, are roundings.
const SLIVER: f32 = 1e-6;

// Where we are along the ray that is followed: what comes next is the first event after it, by place and then by number.
struct Event {
    at: f32,
    number: u32,
    leaf: u32,
    step: i32,                  // of the winding number of a solid
}

// The lens.
fn whole() -> Combination {
    return combination_of(stage.region);
}

var<private> windings: array<i32, 64>;  // of each solid
var<private> programs: array<u32, 64>;  // of each leaf: its operations, and whether it is a solid
var<private> here: Event;
var<private> next: Event;
// The intervals found.
var<private> last: Span;                // not kept yet: what follows may join it
var<private> found: u32;                // how many, with it
var<private> is_over: bool;             // whether there were more than there are layers

fn visit(event: Event) {
    let is_later = event.at > here.at || (event.at == here.at && event.number > here.number);
    let is_sooner = event.at < next.at || (event.at == next.at && event.number < next.number);
    if is_later && is_sooner {
        next = event;
    }
}

// Looks at all events.
fn find_next(list: u32) {
    next = Event(FAR_AWAY, NONE, 0u, 0);
    let leaves = whole().count;
    for (var i = 0u; i < leaves; i++) {
        if spans[i].enter < spans[i].exit {
            visit(Event(spans[i].enter, 2u * i, i, 0));
            visit(Event(spans[i].exit, 2u * i + 1u, i, 0));
        }
    }
    for (var at = list & NEXT; at != 0u; at = crossings[2u * at - 1u] & NEXT) {
        let word = crossings[2u * at - 1u];
        let step = select(-1, 1, (word & IS_ENTRY) != 0u);
        visit(Event(bitcast<f32>(crossings[2u * at - 2u]), 2u * leaves + at, word >> LEAF_SHIFT & LEAF, step));
    }
}

// Whether the ray is in the lens just after `t`.
fn is_in_after(t: f32) -> bool {
    var bits = 0u;
    for (var i = 0u; i < whole().count; i++) {
        let is_in_form = spans[i].enter <= t && t < spans[i].exit;
        bits = pushed(bits, select(is_in_form, windings[i] != 0, (programs[i] & IS_SOLID) != 0u), programs[i] & ~IS_SOLID);
    }
    return bits == 1u;
}

fn add_interval(span: Span, first: u32, code: DepthCode, format: u32) {
    if span.exit - span.enter <= SLIVER * abs(span.exit) {
        return;
    }
    if found > 0u && span.enter - last.exit <= SLIVER * abs(span.enter) {
        last.exit = span.exit;
        return;
    }
    if found == stage.layers {
        // The last layer takes in what follows: in front and behind stay right.
        last.exit = span.exit;
        is_over = true;
        return;
    }
    if found > 0u {
        keep(first + found - 1u, codes_of(code, last), format);
    }
    last = span;
    found += 1u;
}

fn windings_around_eye(solid: Solid) -> i32 {
    return i32(floor(solid.around + 0.5));
}

fn is_in_doubt(solid: Solid) -> bool {
    return solid.around != floor(solid.around + 0.5);
}

// Whether the eye is so near a face of a solid that its winding number is in doubt.
fn is_near_solid() -> bool {
    var is_near = false;
    for (var i = 0u; i < whole().count; i++) {
        let leaf = leaf_at(whole(), i).region;
        is_near = is_near || (leaf.test == SOLID && is_in_doubt(solid_of(leaf)));
    }
    return is_near;
}

// Finds the intervals of a ray; false: its crossings do not balance.
fn follow(ray: Ray, list: u32, first: u32, code: DepthCode, format: u32) -> bool {
    let starts_at_eye = view.orthographic == 0u;
    found = 0u;
    is_over = false;
    find_spans(whole(), ray);
    let leaves = whole().count;
    for (var i = 0u; i < leaves; i++) {
        let leaf = leaf_at(whole(), i);
        let is_solid = leaf.region.test == SOLID;
        programs[i] = leaf.operations | select(0u, IS_SOLID, is_solid);
        windings[i] = select(0, windings_around_eye(solid_of(leaf.region)), starts_at_eye && is_solid);
        if is_solid {
            spans[i] = EMPTY_SPAN;
        }
    }
    if starts_at_eye && is_near_solid() {
        // Which side of a face the eye is on, the ray says best: it enters and leaves alike, but for what it begins in.
        here = Event(0.0, NONE, 0u, 0);
        find_next(list);
        while next.at < FAR_AWAY {
            here = next;
            windings[here.leaf] += here.step;
            find_next(list);
        }
        for (var i = 0u; i < leaves; i++) {
            let leaf = leaf_at(whole(), i).region;
            let known = windings_around_eye(solid_of(leaf));
            windings[i] = select(known, known - windings[i], leaf.test == SOLID && is_in_doubt(solid_of(leaf)));
        }
    }
    // A crossing just at the start has happened.
    here = Event(select(-FAR_AWAY, 0.0, starts_at_eye), NONE, 0u, 0);
    var is_in = is_in_after(here.at);
    var entered = here.at;
    loop {
        find_next(list);
        if next.at >= FAR_AWAY {
            break;
        }
        here = next;
        windings[here.leaf] += here.step;
        let is_in_now = is_in_after(here.at);
        if is_in && !is_in_now {
            add_interval(Span(entered, here.at), first, code, format);
        }
        if is_in_now && !is_in {
            entered = here.at;
        }
        is_in = is_in_now;
    }
    var is_closed = true;
    for (var i = 0u; i < leaves; i++) {
        is_closed = is_closed && windings[i] == 0;
    }
    if is_in && is_closed {
        add_interval(Span(entered, NO_END), first, code, format);
    }
    return is_closed;
}

fn store_texel(at: vec2u, code: DepthCode, format: u32) {
    let texel = at.y * stage.width + at.x;
    let first = texel * stage.layers;
    let ray = ray_of_texel(at);
    let word_before = half_word;
    let own = lists[stage.first_list + texel];
    var list = own;
    for (var attempt = 0u; ; attempt++) {
        half_word = word_before;
        if (follow(ray, list, first, code, format) && (list & INCOMPLETE) == 0u) || attempt == 5u {
            break;
        }
        list = own;
        if attempt < 4u {
            let beside = vec2i(at) + vec2i(vec4i(-1, 1, 0, 0)[attempt], vec4i(0, 0, -1, 1)[attempt]);
            let place = clamp(beside, vec2i(0), vec2i(vec2u(stage.width, stage.height)) - 1);
            list = lists[stage.first_list + u32(place.y) * stage.width + u32(place.x)];
        }
    }
    is_over = is_over || (list & INCOMPLETE) != 0u;
    if found > 0u {
        keep(first + found - 1u, codes_of(code, last), format);
    }
    for (var layer = found; layer < stage.layers; layer++) {
        keep(first + layer, vec2u(farthest_code(code), nearest_code(code)), format);
    }
    if is_over && stage.excess != 0u {
        atomicAdd(&counts[stage.excess], 1u);
    }
}
