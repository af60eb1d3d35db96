// When objects are there, in what effects read of objects: the moment of the scene, where lifetimes begin, the first and the last moment
// that any lens shows; how many combinations of instants there are, where their weights begin, the scene's instants and its ghosts; where the
// moments of what moves begin; whether what is there at some of the scene's instants is there whole; then what time operators read; then the lifetimes, that of no object first.

const LIFETIMES: u32 = 2u;
const LIFETIME_WORDS: u32 = 3u;     // of an object: its first moment and its last, a bit for each lens that may hold some of it, and all of it
const EARLIEST: u32 = 4u;
const LATEST: u32 = 6u;

fn moment_in(first: u32) -> Moment {
    return Moment(bitcast<i32>(object_values[first]), object_values[first + 1u]);
}

// The moment of the scene.
fn scene_moment() -> Moment {
    return moment_in(0u);
}

fn lifetime_place(object: u32) -> u32 {
    return object_values[LIFETIMES] + object_values[LIFETIME_WORDS] * (object + 1u);
}

// How many words of bits there are of an object, for either kind.
fn words_of_lenses() -> u32 {
    return (object_values[LIFETIME_WORDS] - 4u) / 2u;
}

// The bits of 32 lenses that may hold some of an object.
fn lenses_that_may(object: u32, word: u32) -> u32 {
    return object_values[lifetime_place(object) + 4u + word];
}

// Those among them that surely hold all of it.
fn lenses_that_surely_do(object: u32, word: u32) -> u32 {
    return object_values[lifetime_place(object) + 4u + words_of_lenses() + word];
}

// From its first moment up to its last, which is not of it.
struct Lifetime {
    begin: Moment,
    end: Moment,
}

fn lifetime_of(object: u32) -> Lifetime {
    let first = lifetime_place(object);
    return Lifetime(moment_in(first), moment_in(first + 2u));
}

fn holds(lifetime: Lifetime, at: Moment) -> bool {
    return at.hour == TIMELESS_HOUR || (!is_before(at, lifetime.begin) && is_before(at, lifetime.end));
}

// Whether it is there at no moment that may be shown: where the scene has none, all is there.
fn is_never(lifetime: Lifetime) -> bool {
    let is_apart = is_before(moment_in(LATEST), lifetime.begin) || !is_before(moment_in(EARLIEST), lifetime.end);
    return is_apart && scene_moment().hour != TIMELESS_HOUR;
}

// Whether it is there at all moments that may be shown.
fn is_always(lifetime: Lifetime) -> bool {
    return !is_before(moment_in(EARLIEST), lifetime.begin) && is_before(moment_in(LATEST), lifetime.end);
}
