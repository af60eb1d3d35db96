// Meshes fine enough for deformations, in rounds: `geom::deform::refine` is the reference and says why.
//
// In each round every edge that is not known to be fine enough is asked (`ask`), triangles without halved edges are looked into
// (`look_inside`), what each becomes is counted and added up (`add_up`, `add_groups`), and written where it belongs (`split`). The host
// reads the sums, and stops when nothing is halved. Then corners are moved (`place`, `mix`), and triangles written as indices (`draw`).
// Whatever is asked of an edge is asked of its two ends in an order of their own, in one place of one shader: both neighbours get the same
// bits. Ends are cells of a lattice, and the middle of an edge is one: it is the same from both sides.

struct Refinement {
    eye: vec3i,             // cells
    items: u32,             // triangles of this round
    eye_offset: vec3f,      // metres
    corners: u32,           // of this round
    forward: vec3f,
    pixels: f32,            // per metre: at distance 1, or everywhere
    near: f32,
    orthographic: u32,
    tolerance: f32,         // pixels
    shortest: f32,          // metres
    anchor: vec3i,          // whole metres; the origin of the lattice
    shift: u32,             // cells in a metre: 2^shift
    met: u32,               // triangles of the city
    chunks: u32,
    lift: f32,              // of a layer over the one below, pixels
    narrowest: f32,         // what is narrower is not drawn, pixels
    is_smooth: u32,
    asked: u32,             // of the triangles of this round, those that are not done
}

// A corner of a triangle of the city that a deformation may meet; three of each, in the order of their places.
struct RestCorner {
    origin: vec3i,
    surface: u32,
    position: vec3f,
    normal: u32,
}

// Bits of such a triangle: which corner flat values come from, whether the corners were put in order by an odd number of exchanges, and
// above them the layer of coplanar faces that it is in.
const PROVOKING: u32 = 3u;
const TURNED: u32 = 4u;
const LAYER_SHIFT: u32 = 3u;

// A corner of what they become. Weights: those of the second and the third corner of its source.
struct Corner {
    cell: vec3i,
    source: u32,
    weights: vec2f,
}

// Bits of an edge: how many edges inside triangles led to it, whether it is fine enough, and whether its ends see all that there is between
// them.
const GENERATION: u32 = 63u;
const IS_FINE: u32 = 64u;
const IS_CLOSE: u32 = 128u;
const EDGE_BITS: u32 = 8u;
const EDGE: u32 = 255u;
// Of an answer.
const HALVED: u32 = 1u;
// Of a triangle: nothing is to be asked any more.
const IS_DONE: u32 = 1u << 31u;

struct Triangle {
    a: u32,
    b: u32,
    c: u32,
    source: u32,
    edges: u32,             // ab, bc, ca
}

// Stored rather than uniform: software adapters prepare a shader anew for every dispatch where it branches on a uniform.
@group(0) @binding(0) var<storage, read> refinement: Refinement;
@group(0) @binding(1) var<uniform> numbers: array<vec4f, NUMBERS>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read_write> corners: array<Corner>;
// Per triangle: of each edge whether it is halved, and whether it is close; and the weights of a corner inside, or zeros.
@group(0) @binding(4) var<storage, read_write> answers: array<u32>;
// Per triangle: triangles and corners that those before it in its group become, and how many of these triangles are not done; then per
// group, those of the groups before; then of all.
@group(0) @binding(5) var<storage, read_write> sums: array<vec3u>;
@group(0) @binding(6) var<storage, read_write> split_triangles: array<Triangle>;
@group(0) @binding(7) var<storage, read> rest_corners: array<RestCorner>;
@group(0) @binding(8) var<storage, read> rest_bits: array<u32>;
@group(0) @binding(9) var<storage, read> rest_texcoords: array<vec2f>;
@group(0) @binding(10) var<storage, read_write> made: array<u32>;
// Triangles of this round that are not done, and those of the next one.
@group(0) @binding(13) var<storage, read> asked_triangles: array<u32>;
@group(0) @binding(14) var<storage, read_write> asked_next: array<u32>;
// Texels and routes of deformations.
@group(0) @binding(12) var<storage, read> tables: array<f32>;
// Edges and triangles that stay too far off because they are short.
@group(0) @binding(11) var<storage, read_write> coarse: atomic<u32>;

const ANSWER_WORDS: u32 = 5u;
const GROUP: u32 = 256u;
// As many groups in a row of them: more than adapters take are in several rows.
const ROW: u32 = 32768u;

// Of `geom::deform::refine`.
const GENERATIONS: u32 = 32u;
const PARTS: u32 = 6u;
const MOST_PARTS: u32 = 64u;
const FEWEST_PARTS: f32 = 3.0;
const KINK: f32 = 0.75;
const UNSEEN: f32 = 0.1;
const INSIDE: f32 = 2.0;
const CLOSE: f32 = 6.0;
// What ways that are computed in the frame of a lens may be off, of the distance from its pivot: some units in the last place. Finer edges
// would not be nearer to where they should be.
const NOISE: f32 = 5e-7;
// How exact corners are that rasterisers find where they cut triangles off, of the distance of the farthest corner.
const CUT_NOISE: f32 = 1e-6;

fn number_of(group: vec3u, local: u32) -> u32 {
    return (group.y * ROW + group.x) * GROUP + local;
}

// ---- corners of the city

@compute @workgroup_size(GROUP)
fn gather(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = number_of(group, local);
    if i >= refinement.met {
        return;
    }
    let scale = f32(1u << refinement.shift);
    for (var k = 0u; k < 3u; k++) {
        let at = rest_corners[3u * i + k];
        let cell = (at.origin - refinement.anchor) * i32(1u << refinement.shift) + vec3i(round(at.position * scale));
        corners[3u * i + k] = Corner(cell, i, vec2f(f32(k == 1u), f32(k == 2u)));
    }
    split_triangles[i] = Triangle(3u * i, 3u * i + 1u, 3u * i + 2u, i, 0u);
    asked_next[i] = i;
}

// ---- what is shown, seen from the eye

fn pixels_per_m(cell: vec3i, offset: vec3f) -> f32 {
    if refinement.orthographic == 1u {
        return refinement.pixels;
    }
    let way = vec3f(cell - refinement.eye) * cell_size() + (offset - refinement.eye_offset);
    let distance = max(length(way), refinement.near);
    // What is further aside than any picture reaches counts as if it were nearer to its middle.
    let depth = max(max(dot(way, refinement.forward), 0.25 * distance), refinement.near);
    return refinement.pixels * distance / (depth * depth);
}

// Unit, from a place to the eye.
fn towards_eye(cell: vec3i, offset: vec3f) -> vec3f {
    if refinement.orthographic == 1u {
        return -refinement.forward;
    }
    let way = vec3f(refinement.eye - cell) * cell_size() + (refinement.eye_offset - offset);
    let distance = length(way);
    return select(-refinement.forward, way / distance, distance > 0.0);
}

// Where the last sample was before each step, and the longest way from one sample to the next, by what it may be.
const NOWHERE: f32 = 1e30;
var<private> last: array<vec3f, STEPS>;
var<private> stride: f32;

fn note(step: u32, p: vec3f, rate: vec3f, is_first: bool) {
    if !is_first && abs(p.x) < NOWHERE && abs(last[step].x) < NOWHERE {
        let way = abs(p - last[step]) * rate;
        stride = max(stride, max(way.x, max(way.y, way.z)));
    }
    last[step] = p;
}

//@traced

// From which to which part of the way between two places a support has it; from > to: nowhere.
fn range_of(lens: u32, a: vec3f, b: vec3f) -> vec2f {
    let low = numbers[lens + SUPPORT_LOW].xyz;
    let high = numbers[lens + SUPPORT_HIGH].xyz;
    let way = b - a;
    var range = vec2f(0.0, 1.0);
    for (var i = 0u; i < 3u; i++) {
        if way[i] == 0.0 {
            if a[i] < low[i] || a[i] > high[i] {
                range = vec2f(2.0, -1.0);
            }
            continue;
        }
        let ends = vec2f(low[i] - a[i], high[i] - a[i]) / way[i];
        range.x = max(range.x, min(ends.x, ends.y));
        range.y = min(range.y, max(ends.x, ends.y));
    }
    // An end that is in it is so whatever rounding says.
    let is_in = vec2<bool>(is_supported(lens, a), is_supported(lens, b));
    let touched = select(range, vec2f(0.0, 1.0), range.x > range.y && any(is_in));
    return select(touched, vec2f(0.0, 1.0), is_in);
}

fn is_before(a: vec3i, b: vec3i) -> bool {
    if a.x != b.x {
        return a.x < b.x;
    }
    if a.y != b.y {
        return a.y < b.y;
    }
    return a.z < b.z;
}

fn middle_of(a: vec3i, b: vec3i) -> vec3i {
    return (a >> vec3u(1u)) + (b >> vec3u(1u)) + (a & b & vec3i(1));
}

// What a way is longer than noise.
fn beyond(way: vec3f, noise: f32) -> vec3f {
    let size = length(way);
    return way * select(0.0, (size - noise) / size, size > noise);
}

// Whether an edge is farther from where it should be than the tolerance, and whether it is close; its first end is the one before the
// other.
//
// First both ends are looked at, to see in how many parts the rest is to be; then the ends of these. That all are looked at in one place
// keeps the shader small: software adapters take seconds for what stands in it often.
fn answer_of(a: vec3i, b: vec3i) -> u32 {
    let whole = vec3f(b - a) * cell_size();
    var range = vec2f(2.0, -1.0);
    var noise = 0.0;            // metres
    for (var i = 0u; i < DEFORMERS; i++) {
        let lens = deformer_at(i);
        let p = in_frame(lens, a, vec3f(0.0));
        let q = in_frame(lens, a, whole);
        let own = range_of(lens, p, q);
        if own.x <= own.y {
            range = vec2f(min(range.x, own.x), max(range.y, own.y));
            noise = max(noise, NOISE * max(length(p), length(q)));
        }
    }
    // Beyond the supports nothing moves.
    if range.x > range.y {
        return 0u;
    }
    var close = 0u;
    var start = vec3f(0.0);     // how far the ends are moved
    var end = vec3f(0.0);
    var parts = 1.0;
    var i = -2.0;
    var worst = 0.0;            // pixels
    var before = vec3f(0.0);    // how far off the last two samples are, metres
    var here = vec3f(0.0);
    var bend = 0.0;             // the second difference at the one before the last
    var scales = vec2f(0.0);
    stride = 0.0;
    loop {
        let along = select(range.x + (range.y - range.x) * i / parts, range.y, i == parts);
        let t = select(along, -1.0 - i, i < 0.0);
        let rest = whole * t;
        let way = traced(a, rest, i == -2.0 || i == 0.0);
        if i == -2.0 {
            end = way;
        } else if i == -1.0 {
            start = way;
            close = select(0u, IS_CLOSE, stride <= CLOSE);
            let strides = stride * (range.y - range.x);
            parts = select(max(f32(PARTS), ceil(min(strides, 1e9))), FEWEST_PARTS, strides <= 1.0);
            stride = 0.0;
            if range.x == 0.0 {
                // This is the first of the parts' ends, too.
                scales = vec2f(0.0, pixels_per_m(a, way));
                i = 0.0;
            }
        } else {
            // By ways rather than places: where nothing moves, nothing is off.
            let is_end = t == 0.0 || t == 1.0;
            let off = select(beyond(way - (start + (end - start) * t), noise + NOISE * length(way)), vec3f(0.0), is_end);
            let scale = pixels_per_m(a, rest + way);
            if length(off) * scale > refinement.tolerance {
                return HALVED | close;
            }
            let next = select(length(before + off - 2.0 * here), 0.0, i < 2.0);
            if i >= 2.0 {
                worst = max(worst, (max(length(before), length(here)) + KINK * (bend + next)) * max(scales.x, scales.y));
            }
            bend = next;
            scales = vec2f(scales.y, scale);
            before = here;
            here = off;
            if i == parts {
                worst = max(worst, (max(length(before), length(here)) + KINK * bend) * max(scales.x, scales.y));
                let is_off = worst + UNSEEN * refinement.tolerance > refinement.tolerance;
                // A few say that it is near; that it is not, only PARTS and more.
                if stride <= 1.00001 && (!is_off || parts >= f32(PARTS)) {
                    return select(0u, HALVED, is_off) | close;
                }
                // Not all was seen.
                parts = max(max(parts + 1.0, f32(PARTS)), ceil(min(stride * parts, 1e9)));
                stride = 0.0;
                worst = 0.0;
                before = vec3f(0.0);
                here = vec3f(0.0);
                bend = 0.0;
                i = -1.0;
            }
        }
        if parts > f32(MOST_PARTS) {
            return HALVED;
        }
        i += 1.0;
    }
    return HALVED;
}

fn edge_of(edges: u32, i: u32) -> u32 {
    return (edges >> (EDGE_BITS * i)) & EDGE;
}

// Each edge of each triangle: 1 if it is halved.
@compute @workgroup_size(GROUP)
fn ask(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = number_of(group, local);
    let k = number % 3u;
    if number >= 3u * refinement.asked {
        return;
    }
    let i = asked_triangles[number / 3u];
    let own = triangles[i];
    let edge = edge_of(own.edges, k);
    var answer = 0u;
    if (edge & IS_FINE) == 0u {
        var names = array<u32, 3>(own.a, own.b, own.c);
        let p = corners[names[k]].cell;
        let q = corners[names[(k + 1u) % 3u]].cell;
        let is_ordered = is_before(p, q);
        let a = select(q, p, is_ordered);
        let b = select(p, q, is_ordered);
        let middle = middle_of(a, b);
        if any(middle != a) && any(middle != b) {
            answer = answer_of(a, b);
        }
        if (answer & HALVED) != 0u {
            let is_short = length(vec3f(b - a) * cell_size()) < refinement.shortest;
            if is_short || (edge & GENERATION) > GENERATIONS {
                answer = answer & ~HALVED;
                atomicAdd(&coarse, 1u);
            }
        }
    } else {
        answer = edge & IS_CLOSE;
    }
    answers[ANSWER_WORDS * i + k] = answer;
}

// ---- the insides of triangles

// Corners of the part of a triangle that a support has, as weights of its second and third corner.
const MOST_CLIPPED: u32 = 9u;
var<private> piece: array<vec2f, MOST_CLIPPED>;
var<private> piece_size: u32;

// Cuts the piece where a number, which is linear over the triangle, is below zero.
fn clip_piece(at: vec3f) {
    var kept: array<vec2f, MOST_CLIPPED>;
    var size = 0u;
    for (var i = 0u; i < piece_size; i++) {
        let p = piece[i];
        let q = piece[select(i + 1u, 0u, i + 1u == piece_size)];
        let start = at.x + (at.y - at.x) * p.x + (at.z - at.x) * p.y;
        let to = at.x + (at.y - at.x) * q.x + (at.z - at.x) * q.y;
        if start >= 0.0 && size < MOST_CLIPPED {
            kept[size] = p;
            size++;
        }
        if (start < 0.0) != (to < 0.0) && size < MOST_CLIPPED {
            kept[size] = p + (q - p) * (start / (start - to));
            size++;
        }
    }
    piece_size = size;
    piece = kept;
}

// Where the inside of a triangle is off by more than twice the tolerance, as weights; zeros: nowhere.
//
// First its corners are looked at; then, of every part of it that a support has, cut into triangles, the corners and a grid of places. All
// in one place, as for edges.
fn worst_inside(cell: vec3i, ab: vec3f, ac: vec3f) -> vec2f {
    var moved_a = vec3f(0.0);   // how far corners are moved
    var moved_b = vec3f(0.0);
    var moved_c = vec3f(0.0);
    var pixels = INSIDE * refinement.tolerance;
    var found = vec2f(0.0);
    var phase = 0u;         // the triangle's corners, a piece's, places inside of it
    var n = 0u;             // which corner
    var lens_number = 0u;   // the next one
    var last_corner = 2u;   // of the piece
    var u = vec2f(0.0);
    var v = vec2f(1.0, 0.0);
    var w = vec2f(0.0, 1.0);
    var parts = 3u;
    var x = 1u;
    var y = 1u;
    var is_large = false;
    piece_size = 0u;
    stride = 0.0;
    loop {
        let corner = select(select(u, v, n == 1u), w, n == 2u);
        let inner = (u * f32(x) + v * f32(y) + w * f32(parts - x - y)) / f32(parts);
        let weights = select(corner, inner, phase == 2u);
        let rest = ab * weights.x + ac * weights.y;
        let way = traced(cell, rest, phase == 2u || n == 0u);
        var is_through = false;
        if phase < 2u {
            if phase == 0u {
                moved_a = select(moved_a, way, n == 0u);
                moved_b = select(moved_b, way, n == 1u);
                moved_c = select(moved_c, way, n == 2u);
            }
            n++;
            if n == 4u {
                n = 0u;
                if phase == 0u {
                    // Where corners see all that there is, so do edges.
                    if stride <= CLOSE {
                        return found;
                    }
                    is_through = true;
                } else {
                    is_large = stride > f32(MOST_PARTS);
                    parts = select(max(3u, u32(ceil(min(stride, 1e3)))), 3u, is_large);
                    x = 1u;
                    y = 1u;
                    phase = 2u;
                    is_through = stride <= CLOSE;
                }
            }
        } else {
            if min(min(weights.x, weights.y), 1.0 - weights.x - weights.y) > 1e-6 {
                let off = way - (moved_a + (moved_b - moved_a) * weights.x + (moved_c - moved_a) * weights.y);
                // What is too large to see all in it is as bad as can be.
                let own = select(length(off) * pixels_per_m(cell, rest + way), NOWHERE, is_large);
                if own > pixels {
                    pixels = own;
                    found = weights;
                }
            }
            y++;
            if y >= parts - x {
                x++;
                y = 1u;
                is_through = x + 1u >= parts;
            }
        }
        if !is_through {
            continue;
        }
        // The next piece.
        last_corner++;
        while last_corner >= piece_size && lens_number < DEFORMERS {
            clip_to(deformer_at(lens_number), cell, ab, ac);
            lens_number++;
            last_corner = 2u;
        }
        if last_corner >= piece_size {
            return found;
        }
        u = piece[0];
        v = piece[last_corner - 1u];
        w = piece[last_corner];
        phase = 1u;
        stride = 0.0;
    }
    return found;
}

// What a support has of a triangle.
fn clip_to(lens: u32, cell: vec3i, ab: vec3f, ac: vec3f) {
    let p = in_frame(lens, cell, vec3f(0.0));
    let q = in_frame(lens, cell, ab);
    let r = in_frame(lens, cell, ac);
    piece[0] = vec2f(0.0);
    piece[1] = vec2f(1.0, 0.0);
    piece[2] = vec2f(0.0, 1.0);
    piece_size = 3u;
    let low = numbers[lens + SUPPORT_LOW].xyz;
    let high = numbers[lens + SUPPORT_HIGH].xyz;
    for (var k = 0u; k < 6u && piece_size > 0u; k++) {
        let axis = k >> 1u;
        let at = vec3f(p[axis], q[axis], r[axis]);
        clip_piece(select(at - low[axis], high[axis] - at, (k & 1u) == 1u));
    }
}

@compute @workgroup_size(GROUP)
fn look_inside(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = number_of(group, local);
    if number >= refinement.asked {
        return;
    }
    let i = asked_triangles[number];
    let own = triangles[i];
    let at = ANSWER_WORDS * i;
    var weights = vec2f(0.0);
    let edges = vec3u(answers[at], answers[at + 1u], answers[at + 2u]);
    let is_close = all((edges & vec3u(IS_CLOSE)) != vec3u(0u));
    if !is_close && all((edges & vec3u(HALVED)) == vec3u(0u)) {
        let a = corners[own.a].cell;
        let ab = vec3f(corners[own.b].cell - a) * cell_size();
        let ac = vec3f(corners[own.c].cell - a) * cell_size();
        weights = worst_inside(a, ab, ac);
        if any(weights != vec2f(0.0)) {
            let p = ab * weights.x + ac * weights.y;
            let nearest = min(length(p), min(length(p - ab), length(p - ac)));
            if nearest < refinement.shortest || generation_inside(own) > GENERATIONS {
                weights = vec2f(0.0);
                atomicAdd(&coarse, 1u);
            }
        }
    }
    answers[at + 3u] = bitcast<u32>(weights.x);
    answers[at + 4u] = bitcast<u32>(weights.y);
}

// ---- what each becomes

fn squared(a: u32, b: u32) -> f32 {
    let way = vec3f(corners[a].cell - corners[b].cell) * cell_size();
    return dot(way, way);
}

fn longest_of(own: Triangle) -> u32 {
    let lengths = vec3f(squared(own.a, own.b), squared(own.b, own.c), squared(own.c, own.a));
    if lengths.z >= max(lengths.x, lengths.y) {
        return 2u;
    }
    return select(0u, 1u, lengths.y >= lengths.x);
}

// The generation of edges inside a triangle, whose longest edge is not halved.
fn generation_inside(own: Triangle) -> u32 {
    let generations = vec3u(edge_of(own.edges, 0u), edge_of(own.edges, 1u), edge_of(own.edges, 2u)) & vec3u(GENERATION);
    return max(max(generations.x, generations.y), generations.z) + 1u;
}

// Triangles and new corners that a triangle becomes, and how many of these triangles are to be asked.
fn becomes(i: u32) -> vec3u {
    if (triangles[i].edges & IS_DONE) != 0u {
        return vec3u(1u, 0u, 0u);
    }
    let at = ANSWER_WORDS * i;
    let halved = (answers[at] & HALVED) + (answers[at + 1u] & HALVED) + (answers[at + 2u] & HALVED);
    let is_pierced = halved == 0u && (answers[at + 3u] | answers[at + 4u]) != 0u;
    let count = select(1u + halved, 3u, is_pierced);
    return vec3u(count, select(halved, 1u, is_pierced), select(count, 0u, count == 1u));
}

// Sums of what the triangles before each in its group become, and of each group, by one invocation for each group: software adapters are
// slow where invocations wait for each other.
@compute @workgroup_size(GROUP)
fn add_up(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = number_of(group, local);
    let start = number * GROUP;
    if start >= refinement.items {
        return;
    }
    var sum = vec3u(0u);
    for (var i = start; i < min(start + GROUP, refinement.items); i++) {
        sums[i] = sum;
        sum += becomes(i);
    }
    sums[refinement.items + number] = sum;
}

var<workgroup> shared_sums: array<vec3u, GROUP>;

// Sums of the groups before each, and of all; by one group.
@compute @workgroup_size(GROUP)
fn add_groups(@builtin(local_invocation_index) local: u32) {
    let first = refinement.items;
    let count = (refinement.items + GROUP - 1u) / GROUP;
    let each = (count + GROUP - 1u) / GROUP;
    let start = min(local * each, count);
    let to = min(start + each, count);
    var sum = vec3u(0u);
    for (var i = start; i < to; i++) {
        sum += sums[first + i];
    }
    shared_sums[local] = sum;
    workgroupBarrier();
    var before = vec3u(0u);
    for (var i = 0u; i < local; i++) {
        before += shared_sums[i];
    }
    for (var i = start; i < to; i++) {
        let own = sums[first + i];
        sums[first + i] = before;
        before += own;
    }
    if local == GROUP - 1u {
        sums[first + count] = before;
    }
}

fn with_edges(a: u32, b: u32, c: u32, source: u32, ab: u32, bc: u32, ca: u32) -> Triangle {
    return Triangle(a, b, c, source, ab | (bc << EDGE_BITS) | (ca << (2u * EDGE_BITS)));
}

fn add_middle(at: u32, a: u32, b: u32) {
    let p = corners[a];
    let q = corners[b];
    corners[at] = Corner(middle_of(p.cell, q.cell), p.source, 0.5 * (p.weights + q.weights));
}

@compute @workgroup_size(GROUP)
fn split(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = number_of(group, local);
    if i >= refinement.items {
        return;
    }
    let own = triangles[i];
    let sum = sums[i] + sums[refinement.items + i / GROUP];
    let to = sum.x;
    if (own.edges & IS_DONE) != 0u {
        split_triangles[to] = own;
        return;
    }
    let more = becomes(i);
    for (var k = 0u; k < more.z; k++) {
        asked_next[sum.z + k] = to + k;
    }
    var fresh = refinement.corners + sum.y;
    let at = ANSWER_WORDS * i;
    let own_answers = vec3u(answers[at], answers[at + 1u], answers[at + 2u]);
    let halved = (own_answers & vec3u(HALVED)) != vec3u(0u);
    // What is known of edges that stay.
    let kept = (vec3u(edge_of(own.edges, 0u), edge_of(own.edges, 1u), edge_of(own.edges, 2u)) & vec3u(GENERATION)) |
        vec3u(IS_FINE) | (own_answers & vec3u(IS_CLOSE));
    let count = u32(halved.x) + u32(halved.y) + u32(halved.z);
    let longest = longest_of(own);
    if count == 0u {
        let weights = vec2f(bitcast<f32>(answers[at + 3u]), bitcast<f32>(answers[at + 4u]));
        if all(weights == vec2f(0.0)) {
            split_triangles[to] = Triangle(own.a, own.b, own.c, own.source, own.edges | IS_DONE);
            return;
        }
        let a = corners[own.a];
        let b = corners[own.b];
        let c = corners[own.c];
        let way = vec3f(b.cell - a.cell) * weights.x + vec3f(c.cell - a.cell) * weights.y;
        let mixed = a.weights + (b.weights - a.weights) * weights.x + (c.weights - a.weights) * weights.y;
        corners[fresh] = Corner(a.cell + vec3i(round(way)), a.source, mixed);
        let inside = generation_inside(own);
        split_triangles[to] = with_edges(own.a, own.b, fresh, own.source, kept.x, inside, inside);
        split_triangles[to + 1u] = with_edges(own.b, own.c, fresh, own.source, kept.y, inside, inside);
        split_triangles[to + 2u] = with_edges(own.c, own.a, fresh, own.source, kept.z, inside, inside);
        return;
    }
    // Turned so that the edges that are halved come first, of three the longest.
    var first = longest;
    if count == 1u {
        first = select(select(2u, 1u, halved.y), 0u, halved.x);
    } else if count == 2u {
        first = select(select(0u, 2u, !halved.y), 1u, !halved.x);
    }
    var names = array<u32, 3>(own.a, own.b, own.c);
    let a = names[first];
    let b = names[(first + 1u) % 3u];
    let c = names[(first + 2u) % 3u];
    let is_longest_halved = halved[longest];
    let inside = generation_inside(own) - u32(is_longest_halved);
    // Halves have the generation of their edge; what is not halved is fine enough.
    let next = (first + 1u) % 3u;
    let last_edge = (first + 2u) % 3u;
    let ab = edge_of(own.edges, first) & GENERATION;
    let bc = select(kept[next], edge_of(own.edges, next) & GENERATION, count > 1u);
    let ca = select(kept[last_edge], edge_of(own.edges, last_edge) & GENERATION, count > 2u);
    let source = own.source;
    let m = fresh;
    add_middle(m, a, b);
    if count == 1u {
        split_triangles[to] = with_edges(a, m, c, source, ab, inside, ca);
        split_triangles[to + 1u] = with_edges(m, b, c, source, ab, bc, inside);
        return;
    }
    let n = fresh + 1u;
    add_middle(n, b, c);
    split_triangles[to] = with_edges(m, b, n, source, ab, bc, inside);
    if count == 2u {
        // What is left, a m n c, by its shorter diagonal.
        if squared(a, n) <= squared(m, c) {
            split_triangles[to + 1u] = with_edges(a, m, n, source, ab, inside, inside);
            split_triangles[to + 2u] = with_edges(a, n, c, source, inside, bc, ca);
        } else {
            split_triangles[to + 1u] = with_edges(a, m, c, source, ab, inside, ca);
            split_triangles[to + 2u] = with_edges(m, n, c, source, inside, bc, inside);
        }
        return;
    }
    let k = fresh + 2u;
    add_middle(k, c, a);
    split_triangles[to + 1u] = with_edges(a, m, k, source, ab, inside, ca);
    // What is left, m n c k, likewise: of slivers that keeps the number small.
    if squared(m, c) < squared(n, k) {
        split_triangles[to + 2u] = with_edges(m, n, c, source, inside, bc, inside);
        split_triangles[to + 3u] = with_edges(m, c, k, source, inside, ca, inside);
    } else {
        split_triangles[to + 2u] = with_edges(k, n, c, source, inside, bc, ca);
        split_triangles[to + 3u] = with_edges(m, n, k, source, inside, inside, inside);
    }
}

// ---- what is drawn of it

// Whole metres that origins of moved vertices are multiples of, as a power of two: offsets from them are exact.
const ORIGIN_SHIFT: u32 = 5u;
const VERTEX_WORDS: u32 = 8u;

fn weights_of(own: Corner) -> vec3f {
    return vec3f(1.0 - own.weights.x - own.weights.y, own.weights);
}

// A corner as a vertex of the city.
@compute @workgroup_size(GROUP)
fn place(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = number_of(group, local);
    if i >= refinement.corners {
        return;
    }
    let own = corners[i];
    let first = 3u * own.source;
    let bits = rest_bits[own.source];
    let flat_corner = first + (bits & PROVOKING);
    let surface = rest_corners[flat_corner].surface;
    var normal = vec3f(0.0);
    if refinement.is_smooth == 1u {
        let weights = weights_of(own);
        for (var k = 0u; k < 3u; k++) {
            normal += weights[k] * decode_normal(rest_corners[first + k].normal);
        }
    } else {
        normal = decode_normal(rest_corners[flat_corner].normal);
    }
    let shown = shown_at(own.cell, vec3f(0.0), normal);
    let size = length(shown.normal);
    normal = select(vec3f(0.0, 0.0, 1.0), shown.normal / size, size > 0.0);
    var way = shown.way;
    let layer = bits >> LAYER_SHIFT;
    var lift = vec3f(0.0);
    if layer > 0u {
        // Towards the eye, so that it stays where it is in the picture: its neighbours are not lifted.
        let back = towards_eye(own.cell, way);
        lift = back * (f32(layer) * refinement.lift / pixels_per_m(own.cell, way));
    }
    let moved = vec3i(round(way * f32(1u << refinement.shift)));
    let cell = own.cell + moved;
    let shift = refinement.shift + ORIGIN_SHIFT;
    let whole = cell >> vec3u(shift);
    var origin = refinement.anchor + whole * i32(1u << ORIGIN_SHIFT);
    var position = vec3f(cell - whole * i32(1u << shift)) * cell_size() + lift;
    if i < 3u * refinement.met && layer == 0u && all(moved == vec3i(0)) {
        // What is not moved stays to the bit.
        let at = rest_corners[i];
        origin = at.origin;
        position = at.position;
    }
    let to = VERTEX_WORDS * i;
    for (var k = 0u; k < 3u; k++) {
        made[to + k] = bitcast<u32>(origin[k]);
        made[to + 4u + k] = bitcast<u32>(position[k]);
    }
    made[to + 3u] = surface;
    made[to + 7u] = encode_normal(normal);
}

// Its texture coordinates.
@compute @workgroup_size(GROUP)
fn mix_texcoords(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = number_of(group, local);
    if i >= refinement.corners {
        return;
    }
    let own = corners[i];
    let weights = weights_of(own);
    var mixed = vec2f(0.0);
    for (var k = 0u; k < 3u; k++) {
        mixed += weights[k] * rest_texcoords[3u * own.source + k];
    }
    made[2u * i] = bitcast<u32>(mixed.x);
    made[2u * i + 1u] = bitcast<u32>(mixed.y);
}

// From the eye to a corner that was placed, metres. `rest_corners` has what was placed.
fn from_eye(at: RestCorner) -> vec3f {
    let whole = (at.origin - refinement.anchor) * i32(1u << refinement.shift);
    return vec3f(whole - refinement.eye) * cell_size() + (at.position - refinement.eye_offset);
}

fn between(start: RestCorner, end: RestCorner) -> vec3f {
    return vec3f(end.origin - start.origin) + (end.position - start.position);
}

// Whether a triangle is narrower in the picture than rasterisers can tell its slope from: some take it from corners that are not on
// their grid, and what they cover from corners that are. Its depths would be no numbers, or far beside.
fn is_line(a: RestCorner, b: RestCorner, c: RestCorner) -> bool {
    let forward = refinement.forward;
    let first = from_eye(a);
    var places = array<vec3f, 3>(first, first + between(a, b), first + between(a, c));
    var sides = array<vec3f, 3>(between(a, b), between(b, c), between(c, a));
    let turn = cross(sides[0], sides[1]);
    if refinement.orthographic == 1u {
        var longest = 0.0;
        for (var k = 0u; k < 3u; k++) {
            longest = max(longest, length(sides[k] - dot(sides[k], forward) * forward));
        }
        return refinement.pixels * abs(dot(forward, turn)) <= refinement.narrowest * longest;
    }
    // The volume between it and the eye.
    let volume = abs(dot(first, turn));
    var farthest = 0.0;
    var along = vec2f(0.0);     // lengths of the longest side and of its cross product with a way from the eye to it, metres
    var depths = vec3f(0.0);
    for (var k = 0u; k < 3u; k++) {
        farthest = max(farthest, length(places[k]));
        depths[k] = dot(places[k], forward);
        let size = length(sides[k]);
        if size >= along.x {
            along = vec2f(size, length(cross(places[k], sides[k])));
        }
    }
    // Corners of what is cut off at the edges of the picture are this much off.
    if volume <= CUT_NOISE * farthest * along.y {
        return true;
    }
    if any(depths < vec3f(refinement.near)) {
        return false;
    }
    var longest = 0.0;
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        longest = max(longest, length(places[k] / depths[k] - places[next] / depths[next]));
    }
    return refinement.pixels * volume <= refinement.narrowest * longest * depths.x * depths.y * depths.z;
}

// Triangles as indices, turned as their sources were. What is too narrow is none.
@compute @workgroup_size(GROUP)
fn draw(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = number_of(group, local);
    if i >= refinement.items {
        return;
    }
    let own = triangles[i];
    let is_turned = (rest_bits[own.source] & TURNED) != 0u;
    let is_drawn = !is_line(rest_corners[own.a], rest_corners[own.b], rest_corners[own.c]);
    let second = select(own.b, own.c, is_turned);
    let third = select(own.c, own.b, is_turned);
    made[3u * i] = own.a;
    made[3u * i + 1u] = select(own.a, second, is_drawn);
    made[3u * i + 2u] = select(own.a, third, is_drawn);
}

// The triangles of each chunk: where they begin, and the cells that they are between. `made` has words for each: the number of its first
// source, and then this; `rest_corners` has what was placed.
const CHUNK_WORDS: u32 = 8u;

fn first_of(source: u32) -> u32 {
    var low = 0u;
    var high = refinement.items;
    while low < high {
        let middle = (low + high) / 2u;
        if triangles[middle].source < source {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

fn placed_cell(i: u32) -> vec3i {
    let at = rest_corners[i];
    let whole = (at.origin - refinement.anchor) * i32(1u << refinement.shift);
    return whole + vec3i(round(at.position * f32(1u << refinement.shift)));
}

var<workgroup> shared_low: array<vec3i, GROUP>;
var<workgroup> shared_high: array<vec3i, GROUP>;

// By one group for each chunk: software adapters end what an invocation repeats more than 65,535 times.
@compute @workgroup_size(GROUP)
fn find_chunks(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = group.y * ROW + group.x;
    let is_chunk = i < refinement.chunks;
    let at = CHUNK_WORDS * select(0u, i, is_chunk);
    let start = first_of(made[at]);
    let end = select(start, first_of(made[at + 7u]), is_chunk);
    var low = vec3i(0x7fffffff);
    var high = -low;
    for (var t = start + local; t < end; t += GROUP) {
        let own = triangles[t];
        let a = placed_cell(own.a);
        let b = placed_cell(own.b);
        let c = placed_cell(own.c);
        low = min(low, min(a, min(b, c)));
        high = max(high, max(a, max(b, c)));
    }
    shared_low[local] = low;
    shared_high[local] = high;
    workgroupBarrier();
    if local != 0u || !is_chunk {
        return;
    }
    for (var k = 1u; k < GROUP; k++) {
        low = min(low, shared_low[k]);
        high = max(high, shared_high[k]);
    }
    made[at] = start;
    for (var k = 0u; k < 3u; k++) {
        made[at + 1u + k] = bitcast<u32>(low[k]);
        made[at + 4u + k] = bitcast<u32>(high[k]);
    }
}
