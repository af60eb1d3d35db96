// Values of objects that change over time: the one that holds at the moment that shows at the point.

var<private> moment_here: Moment;

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
