// A region of a user's: in its box, what its handler says (shaders/effect has those of the program; this is written out for each).
// Handlers give a bound of the distance, by which rays are followed (Hart 1996).

struct OwnRegion {
    center: vec3f,              // a.xyz: metres
    x: vec3f,                   // b.xyz: its axes, unit
    first: u32,                 // b.w: number of its first row among the planes: half of its edges; then its parameters
    y: vec3f,                   // c.xyz
    z: vec3f,                   // d.xyz
}

// Steps to where a ray enters or leaves, at most; how near that is found, in longest half edges; and how many times that counts as there for
// rays that graze the region.
const OWN_STEPS: i32 = 128;
const OWN_EXACT: f32 = 1e-5;
const OWN_NEAR: f32 = 100.0;

fn in_own(s: OwnRegion, v: vec3f) -> vec3f {
    return vec3f(dot(v, s.x), dot(v, s.y), dot(v, s.z));
}

// What a handler gives at a place of the region's own, contained: what is no number is outside, and so is all beside its box.
fn contained_distance(distance: f32, place: vec3f, half: vec3f) -> f32 {
    let is_number = abs(distance) <= 3e38;
    return max(select(3e38, distance, is_number), distance_to_block(place, half));
}

fn span_of_own_box(ray: Ray, s: OwnRegion) -> Span {
    let o = in_own(s, ray.origin - s.center);
    let d = in_own(s, ray.direction);
    let half = planes[s.first].xyz;
    return meet(span_of_slab(o.x, d.x, half.x), meet(span_of_slab(o.y, d.y, half.y), span_of_slab(o.z, d.z, half.z)));
}

// Its classes, as those of a solid: what is between its parts is in front of it and behind it.
fn class_of_own(span: Span, is_inside: bool, sight: Sight) -> u32 {
    let starts_at_eye = !sight.is_parallel;
    let is_missed = span.enter > span.exit || (starts_at_eye && (span.exit <= 0.0 || sight.distance <= 0.0));
    let is_after = sight.distance >= span.exit;
    let side = select(select(select(FRONT | BEHIND, BEHIND, is_after), FRONT, sight.distance < span.enter), MISSED, is_missed);
    let nearer = select(BEHIND, FRONT, sight.distance - span.enter < span.exit - sight.distance);
    return select(side, INSIDE | nearer, is_inside);
}
