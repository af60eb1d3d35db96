// Several moments that show together, and what is there by halves at a moment: what is gone and fades, what will come and is drawn in
// outline. `lib/lifetime.wgsl` says where it lies.

const COMBINATIONS: u32 = 8u;
const WEIGHTS: u32 = 9u;
const SCENE_INSTANTS: u32 = 10u;
const SCENE_PAST: u32 = 13u;
const SCENE_FUTURE: u32 = 16u;
const SCENE_SHOWS_ANY: u32 = 20u;

// Of what has no date, where that is a ghost.
const UNDATED_OPACITY: f32 = 0.35;
// Of what fades, when it begins to.
const GONE_OPACITY: f32 = 0.5;

// A set of instants: where its first begins, how many there are, and every how many combinations it goes on to the next.
struct Instants {
    first: u32,
    count: u32,
    stride: u32,
}

const INSTANT_WORDS: u32 = 4u;      // of one: 1 where it is a span; the moment or the span

// Which combination of the instants of all sets is meant.
var<private> combination: u32 = 0u;
// How long what is gone fades where the last moment was made, and how long before its time what will be there is drawn.
var<private> ghost_past: Duration;
var<private> ghost_future: Duration;

// Whether what is there in some combination is there whole.
var<private> shows_any: bool;

fn duration_in(first: u32) -> Duration {
    return Duration(bitcast<i32>(object_values[first]), bitcast<i32>(object_values[first + 1u]), object_values[first + 2u]);
}

// The instant of a set that a combination has, where `below` is shown below.
fn instant_of(instants: Instants, below: Moment) -> Moment {
    let at = instants.first + INSTANT_WORDS * ((combination / instants.stride) % instants.count);
    if object_values[at] == 0u {
        return moment_in(at + 1u);
    }
    if below.hour == TIMELESS_HOUR {
        return below;
    }
    return shifted(below, duration_in(at + 1u));
}

// The moment of the scene in a combination, with the ghosts of the scene.
fn scene_instant() -> Moment {
    shows_any = object_values[SCENE_SHOWS_ANY] != 0u;
    ghost_past = duration_in(SCENE_PAST);
    ghost_future = duration_in(SCENE_FUTURE);
    let own = Instants(object_values[SCENE_INSTANTS], object_values[SCENE_INSTANTS + 1u], object_values[SCENE_INSTANTS + 2u]);
    return instant_of(own, scene_moment());
}

fn combinations() -> u32 {
    return object_values[COMBINATIONS];
}

// How much a combination counts; all together count 1.
fn weight_of_combination() -> f32 {
    return bitcast<f32>(object_values[object_values[WEIGHTS] + combination]);
}

fn is_ghost(lifetime: Lifetime) -> bool {
    return lifetime.begin.hour == i32(-2147483648) && lifetime.begin.micro == 1u;
}

// Whole hours and parts of one between moments, the later one last: of what is more than 2^24 hours, the nearest f32.
fn hours_between(first: Moment, last: Moment) -> f32 {
    return f32(last.hour - first.hour) + (f32(last.micro) - f32(first.micro)) / f32(MICROS_OF_HOUR);
}

// How much of an object is there at a moment, 0..1.
fn share_there(lifetime: Lifetime, at: Moment) -> f32 {
    if holds(lifetime, at) {
        return 1.0;
    }
    if is_before(at, lifetime.end) || !is_before(lifetime.begin, lifetime.end) {
        return 0.0;
    }
    let end = shifted(lifetime.end, ghost_past);
    if !is_before(at, end) {
        return 0.0;
    }
    return GONE_OPACITY * hours_between(at, end) / hours_between(lifetime.end, end);
}

// Whether an object will be there soon after a moment.
fn will_be(lifetime: Lifetime, at: Moment) -> bool {
    let comes = is_before(at, lifetime.begin) && is_before(lifetime.begin, lifetime.end);
    return comes && at.hour != TIMELESS_HOUR && !is_before(shifted(at, ghost_future), lifetime.begin);
}
