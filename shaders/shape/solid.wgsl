// Solids of any form: the winding number of their surface about a place, counted along the line straight up from it in the
// solid's own coordinates. Twin: `veduta::geom::shape::Solid`, which says how.

struct Solid {
    center: vec3f,              // a.xyz: where its own origin is, metres
    x: vec3f,                   // b.xyz: its axes, unit
    first: u32,                 // b.w: number of its first entry
    y: vec3f,                   // c.xyz
    z: vec3f,                   // d.xyz
    around: f32,                // d.w: how often it goes around the eye, and a quarter more where that is in doubt
}

// Each solid has: low x, y of the columns, columns per metre in x, y (f32); columns in x and y, where the numbers of their faces begin,
// counted from the first entry as all that follow; where the nodes begin, how many there are, where the faces begin. Then where
// the faces of each column begin; the numbers of the faces of all columns; the nodes, two entries each: a box, the node that
// follows when all in it is done with, its first face and how many it has (three bits; an inner one, whose first child follows
// it, none); the faces, four entries each: corners by x, and whether that is their turn (1 or -1), whether it is at the border and not
// where bodies touch (1 or 0); upward normal, and how much higher than its first corner an upright face counts as above.
@group(1) @binding(2) var<storage, read> solids: array<vec4u>;

const NO_SOLID_NODE: u32 = 0xffffffffu;

struct SolidNode {
    low: vec3f,
    high: vec3f,
    next: u32,
    first: u32,                 // face
    count: u32,
}

struct SolidFace {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    turn: i32,
    normal: vec3f,
    rise: f32,
}

fn in_solid(s: Solid, v: vec3f) -> vec3f {
    return vec3f(dot(v, s.x), dot(v, s.y), dot(v, s.z));
}

fn solid_node(at: u32) -> SolidNode {
    let low = solids[at];
    let high = solids[at + 1u];
    // Lanes of a software adapter that no pixel belongs to read zeros, and its loops wait for them too: they end at once.
    let next = select(low.w, NO_SOLID_NODE, low.w == 0u);
    return SolidNode(bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz), next, high.w >> 3u, high.w & 7u);
}

fn solid_face(at: u32) -> SolidFace {
    let a = solids[at];
    let normal = bitcast<vec4f>(solids[at + 3u]);
    return SolidFace(bitcast<vec3f>(a.xyz), bitcast<vec3f>(solids[at + 1u].xyz), bitcast<vec3f>(solids[at + 2u].xyz),
                     bitcast<i32>(a.w), normal.xyz, normal.w);
}

// Whether the line from a place towards +y crosses an edge that runs to the right.
fn is_under_edge(left: vec3f, right: vec3f, at: vec2f) -> bool {
    let along = right.xy - left.xy;
    let to = at - left.xy;
    return left.x <= at.x && at.x < right.x && along.x * to.y < along.y * to.x;
}

// The same of four places: 1 or 0 each.
fn are_under_edge(left: vec3f, right: vec3f, x: vec4f, y: vec4f) -> vec4i {
    let along = right.xy - left.xy;
    let is_between = (vec4f(left.x) <= x) & (x < vec4f(right.x));
    return select(vec4i(0), vec4i(1), is_between & (along.x * (y - left.y) < along.y * (x - left.x)));
}

// Places beside one are no further away than this part of the extent: the faces over them are in its column too.
const BESIDE: f32 = 1.0 / 32768.0;

// `distance`: D of the place, which may be `off` beside its face, metres. A solid holds what lies on its faces, as other shapes do on
// flat ones: those that look up or down by their height, upright ones by asking for the places beside it as well.
fn solid_holds(s: Solid, p: vec3f, distance: f32, off: f32) -> bool {
    let on_face = ON_FACE * max(abs(distance), length(s.center)) + off;
    let o = in_solid(s, p - s.center);
    let first = s.first;
    let grid = bitcast<vec4f>(solids[first]);
    let sizes = solids[first + 1u];
    let column = floor((o.xy - grid.xy) * grid.zw);
    if !(all(column >= vec2f(0.0)) && all(column < vec2f(sizes.xy))) {
        return false;
    }
    let number = u32(column.y) * sizes.x + u32(column.x);
    let begin = solids[first + 3u + number / 4u][number % 4u];
    let end = solids[first + 3u + (number + 1u) / 4u][(number + 1u) % 4u];
    let numbers = first + sizes.z;
    let faces = first + solids[first + 2u].z;
    let extent = vec2f(sizes.xy) / grid.zw;
    let aside = min(on_face, BESIDE * max(extent.x, extent.y));
    let x = o.x + vec4f(aside, -aside, 0.0, 0.0);
    let y = o.y + vec4f(0.0, 0.0, aside, -aside);
    var winding = 0;
    var beside = vec4i(0);
    for (var i = begin; i < end; i++) {
        let face = solid_face(faces + 4u * solids[numbers + i / 4u][i % 4u]);
        let turns = face.turn * (i32(is_under_edge(face.a, face.c, o.xy)) - i32(is_under_edge(face.a, face.b, o.xy))
            - i32(is_under_edge(face.b, face.c, o.xy)));
        let height = dot(face.normal, o - face.a) - face.rise;
        winding += select(0, turns, height <= select(-on_face, on_face, turns > 0));
        let turns_beside = face.turn * (are_under_edge(face.a, face.c, x, y) - are_under_edge(face.a, face.b, x, y)
            - are_under_edge(face.b, face.c, x, y));
        let heights = height + face.normal.x * (x - o.x) + face.normal.y * (y - o.y);
        let most = select(vec4f(-on_face), vec4f(on_face), turns_beside > vec4i(0));
        beside += select(vec4i(0), turns_beside, heights <= most);
    }
    return winding != 0 || any(beside != vec4i(0));
}

fn inside_solid(s: Solid, sight: Sight) -> u32 {
    return select(MISSED, INSIDE, sight.distance < FAR_AWAY && solid_holds(s, sight.position, sight.distance, sight.off));
}

// Where a ray crosses a face of a solid, if it does (Moller and Trumbore).
struct FaceHit {
    is_met: bool,
    is_entry: bool,
    t: f32,
}

fn face_hit(origin: vec3f, direction: vec3f, face: SolidFace) -> FaceHit {
    let along_b = face.b - face.a;
    let along_c = face.c - face.a;
    let across = cross(direction, along_c);
    let slope = dot(along_b, across);
    let to = origin - face.a;
    let u = dot(to, across) / slope;
    let around = cross(to, along_b);
    let v = dot(direction, around) / slope;
    let is_met = slope != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    // Corners are in the order of x; `turn` says whether that is theirs.
    return FaceHit(is_met, slope * f32(face.turn) > 0.0, dot(along_c, around) / slope);
}

// Boxes are this part of their distance from where the line begins wider: by more than roundings move it.
const ON_LINE: f32 = 1.0 / 131072.0;

// Whether a line meets a box: seen along each axis of the box, and so across all.
fn line_meets_box(origin: vec3f, direction: vec3f, low: vec3f, high: vec3f) -> bool {
    let to = 0.5 * (low + high) - origin;
    let half = 0.5 * (high - low);
    let wide = half + ON_LINE * (length(to) + length(half));
    let along = abs(direction);
    return all(abs(cross(to, direction)) <= wide.yzx * along.zxy + wide.zxy * along.yzx);
}

// Of a solid, from one of its nodes on: the next leaf that a line meets, own coordinates. Where to go on, its first face and how many it
// has; none: that was all.
struct MetLeaf {
    next: u32,
    first: u32,
    count: u32,
}

fn next_leaf(s: Solid, from_node: u32, origin: vec3f, direction: vec3f) -> MetLeaf {
    let sizes = solids[s.first + 2u];
    for (var at = from_node; at < sizes.y;) {
        let node = solid_node(s.first + sizes.x + 2u * at);
        if !line_meets_box(origin, direction, node.low, node.high) {
            at = node.next;
        } else if node.count > 0u {
            return MetLeaf(node.next, s.first + sizes.z + 4u * node.first, node.count);
        } else {
            at = select(at + 1u, NO_SOLID_NODE, node.next == NO_SOLID_NODE);
        }
    }
    return MetLeaf(sizes.y, 0u, 0u);
}

// First and last crossing of a ray with the surface; `around` is how often it goes around the eye. What lies behind
// the eye is not seen.
fn span_of_solid(ray: Ray, s: Solid, starts_at_eye: bool) -> Span {
    let origin = in_solid(s, ray.origin - s.center);
    let direction = in_solid(s, ray.direction);
    var span = Span(FAR_AWAY, -FAR_AWAY);
    var leaf = next_leaf(s, 0u, origin, direction);
    while leaf.count > 0u {
        for (var i = 0u; i < leaf.count; i++) {
            let hit = face_hit(origin, direction, solid_face(leaf.first + 4u * i));
            let is_seen = hit.is_met && (!starts_at_eye || hit.t > 0.0);
            span = Span(select(span.enter, min(span.enter, hit.t), is_seen), select(span.exit, max(span.exit, hit.t), is_seen));
        }
        leaf = next_leaf(s, leaf.next, origin, direction);
    }
    if span.exit > -FAR_AWAY && starts_at_eye && abs(s.around) > 0.5 {
        span.enter = 0.0;
    }
    return span;
}

// The sides of what is not inside, from where the ray enters first and leaves last.
fn side_of_solid(is_missed: bool, is_before: bool, is_after: bool) -> u32 {
    let between = FRONT | BEHIND;
    return select(select(select(between, BEHIND, is_after), FRONT, is_before), MISSED, is_missed);
}

// From the faces alone: of a place that the picture may not show.
fn class_by_faces(s: Solid, sight: Sight) -> u32 {
    let span = span_of_solid(sight.ray, s, !sight.is_parallel);
    let is_missed = span.enter > span.exit || (!sight.is_parallel && sight.distance <= 0.0);
    let is_before = sight.distance < span.enter;
    let side = side_of_solid(is_missed, is_before, sight.distance >= span.exit);
    let nearer = select(BEHIND, FRONT, sight.distance - span.enter < span.exit - sight.distance);
    return select(side, INSIDE | nearer, inside_solid(s, sight) == INSIDE);
}

// Whether the ray of a pixel's centre meets it.
fn covers_by_faces(s: Solid, pixel: vec2i) -> bool {
    let span = span_of_solid(ray_of_pixel(vec2f(pixel) + 0.5), s, view.orthographic == 0u);
    return span.enter <= span.exit;
}
