// Boolean combinations of volumes: their leaves in the order of a stack machine. A leaf is pushed; then come the
// operations that follow it. What is inside is decided at the place; the sides, along the ray, by the ends of the leaves, at
// which alone a combination can begin or end. A choice of objects counts as the box around them there. `leaf_holds` and `span_of_leaf`
// know the kinds of leaves that a module needs. Twin: `veduta::geom::combination`.

const UNION: u32 = 1u;
const INTERSECTION: u32 = 2u;
const DIFFERENCE: u32 = 3u;

struct Combination {
    first: u32,                 // b.x: where its leaves begin among the planes, five of these to each
    count: u32,                 // b.y: how many there are
    holds_eye: f32,             // b.z: 1: the eye is inside
}

struct Leaf {
    region: Region,
    first: f32,                 // of members: where their marks begin; `region` is the box around them
    operations: u32,            // two bits each, the first in the lowest; 0 ends them
}

fn leaf_at(s: Combination, i: u32) -> Leaf {
    let at = s.first + 5u * i;
    let center = planes[at];
    let own = planes[at + 4u];
    return Leaf(Region(center.xyz, u32(own.x), planes[at + 1u], planes[at + 2u], planes[at + 3u]), own.z, u32(own.y));
}

// Puts a leaf on the stack of bits and does what follows it.
fn pushed(stack: u32, is_in: bool, operations: u32) -> u32 {
    var bits = stack << 1u | u32(is_in);
    for (var left = operations; left != 0u; left >>= 2u) {
        let top = bits & 1u;
        let below = bits >> 1u & 1u;
        let operation = left & 3u;
        let joined = select(select(below & (1u - top), below & top, operation == INTERSECTION), below | top, operation == UNION);
        bits = bits >> 2u << 1u | joined;
    }
    return bits;
}

// Loops over leaves leave at the end of their last round: a software adapter goes through a whole round to find that there is none.
fn inside_combined(s: Combination, sight: Sight) -> u32 {
    var bits = 0u;
    for (var i = 0u; i < s.count; i++) {
        let leaf = leaf_at(s, i);
        let is_in = leaf_holds(leaf, sight);
        bits = pushed(bits, is_in, leaf.operations);
        if i + 1u == s.count {
            break;
        }
    }
    return select(MISSED, INSIDE, bits == 1u);
}

// Where one ray is inside of each leaf; of solids nothing.
var<private> spans: array<Span, 64>;

fn find_spans(s: Combination, ray: Ray) {
    for (var i = 0u; i < s.count; i++) {
        let leaf = leaf_at(s, i).region;
        let span = span_of_leaf(ray, leaf);
        spans[i] = Span(span.enter, select(span.exit, span.enter, span.exit < span.enter));
        if i + 1u == s.count {
            break;
        }
    }
}

// Whether that ray is inside just before `t`, and whether just after it: leaves of closed forms by where they begin and end, solids by the
// place, but `own`, which says itself that it begins there, or ends.
struct Around {
    before: bool,
    after: bool,
}

fn around(s: Combination, ray: Ray, t: f32, own: u32, is_entry: bool) -> Around {
    var before = 0u;
    var after = 0u;
    for (var i = 0u; i < s.count; i++) {
        let leaf = leaf_at(s, i);
        let span = spans[i];
        var is_before = span.enter < t && t <= span.exit;
        var is_after = span.enter <= t && t < span.exit;
        if i == own {
            is_before = !is_entry;
            is_after = is_entry;
        } else if leaf.region.test == SOLID {
            is_before = solid_holds(solid_of(leaf.region), ray.origin + t * ray.direction, t, 0.0);
            is_after = is_before;
        }
        before = pushed(before, is_before, leaf.operations);
        after = pushed(after, is_after, leaf.operations);
        if i + 1u == s.count {
            break;
        }
    }
    return Around(before == 1u, after == 1u);
}

const NO_LEAF: u32 = 0xffffffffu;

// Where a ray enters first and leaves last, of what lies in front of the eye, by the ends of its closed forms alone.
fn span_of_forms(s: Combination, ray: Ray, starts_at_eye: bool) -> Span {
    find_spans(s, ray);
    var span = Span(FAR_AWAY, -FAR_AWAY);
    for (var end = 0u; end < 2u * s.count; end++) {
        let own = spans[end / 2u];
        let t = select(own.enter, own.exit, end % 2u == 1u);
        // The others are asked for only where there is an end.
        if own.enter < own.exit && (!starts_at_eye || t > 0.0) {
            let is_in = around(s, ray, t, NO_LEAF, false);
            span.enter = select(span.enter, min(span.enter, t), is_in.after && !is_in.before);
            span.exit = select(span.exit, max(span.exit, t), is_in.before && !is_in.after);
        }
        if end + 1u == 2u * s.count {
            break;
        }
    }
    return span;
}

// The same for the ends of its solids too: of a place that the picture may not show.
fn class_by_leaves(s: Combination, sight: Sight) -> u32 {
    let starts_at_eye = !sight.is_parallel;
    var span = span_of_forms(s, sight.ray, starts_at_eye);
    for (var i = 0u; i < s.count; i++) {
        let leaf = leaf_at(s, i).region;
        if leaf.test != SOLID {
            continue;
        }
        let solid = solid_of(leaf);
        let origin = in_solid(solid, sight.ray.origin - solid.center);
        let direction = in_solid(solid, sight.ray.direction);
        var met = next_leaf(solid, 0u, origin, direction);
        while met.count > 0u {
            for (var f = 0u; f < met.count; f++) {
                let hit = face_hit(origin, direction, solid_face(met.first + 4u * f));
                if !hit.is_met || (starts_at_eye && hit.t <= 0.0) {
                    continue;
                }
                let is_in = around(s, sight.ray, hit.t, i, hit.is_entry);
                span.enter = select(span.enter, min(span.enter, hit.t), is_in.after && !is_in.before);
                span.exit = select(span.exit, max(span.exit, hit.t), is_in.before && !is_in.after);
            }
            met = next_leaf(solid, met.next, origin, direction);
        }
    }
    span.enter = select(span.enter, 0.0, starts_at_eye && s.holds_eye > 0.5 && span.exit > -FAR_AWAY);
    let is_missed = span.enter > span.exit || (starts_at_eye && sight.distance <= 0.0);
    let is_before = sight.distance < span.enter;
    let side = side_of_solid(is_missed, is_before, sight.distance >= span.exit);
    let nearer = select(BEHIND, FRONT, sight.distance - span.enter < span.exit - sight.distance);
    return select(side, INSIDE | nearer, inside_combined(s, sight) == INSIDE);
}

// Whether the ray of a pixel's centre meets it.
fn covers_by_leaves(s: Combination, pixel: vec2i) -> bool {
    let span = span_of_forms(s, ray_of_pixel(vec2f(pixel) + 0.5), view.orthographic == 0u);
    return span.enter < span.exit;
}
