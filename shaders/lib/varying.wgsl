// Values of objects that change over time: the one that holds at the moment that shows at the point.

var<private> moment_here: Moment;

// Of a frame under the sun of one of several moments: that moment, and whether it is the scene's own.
const LIT_MOMENT: u32 = 21u;
const IS_OWN_SUN: u32 = 23u;

// Whether a point is to be seen under that sun; what is behind the city is under the scene's own.
fn is_lit_by_this_sun(point: Point) -> bool {
    let is_own = object_values[IS_OWN_SUN] != 0u;
    return select(are_same(moment_here, moment_in(LIT_MOMENT)), is_own, point.surface == NO_SURFACE);
}

// A value of a list of values that begins at `first`. Where its highest byte is 0, the others say how far behind that stands, from when on it is
// which: how many there are, and of each a moment and the value.
fn value_then(first: u32, value: u32) -> u32 {
    if (value >> 24u) != 0u {
        return value;
    }
    let at = first + value;
    var found = object_values[at + 3u];
    let count = object_values[at];
    for (var i = 1u; i < count; i++) {
        let own = at + 1u + 3u * i;
        // Without a moment all are past.
        let is_past = moment_here.hour == TIMELESS_HOUR || !is_before(moment_here, moment_in(own));
        found = select(found, object_values[own + 2u], is_past);
    }
    return found;
}
