// Edges of polygons as lines some pixels wide: one instance per edge, a strip of four vertices.
//
//   left    0 -------------------------- 1
//             (start)==============(end)         `reach` pixels around the edge
//   right   2 -------------------------- 3
//
// Everything is clipped here and handed over with w = 1: a long edge beside the eye has its ends at 10⁷ pixels, where
// floats no longer know the width of a line; and what is interpolated is linear in the picture, as stored depth is too.
//
// Depth. An edge must win against its own faces and lose to whatever hides it. A pixel beside the edge, on a face that
// leans towards the eye, shows that face nearer than the edge: at a grazing angle by metres; and where it leans away, a
// thin wall before it leans away as well, so that a line of one depth would come out of it. No constant bias does both.
// So a pixel of the line takes the depth that the face on its side of the edge has there (`edge_depth`): a line is in front
// of its faces by construction, and in front of another wall only where its own face is. Beside an outline, where there
// is no face, it falls back as the faces do on the other side. What is left to a bias are roundings (EDGE_BIAS: 1 cm at
// 100 m); and the grid of the rasteriser (SNAPPING), by which faces are off across the edge (EDGE_SLACK_PX) and along it. A wall of 5 cm
// hides it all.

struct Edge {
    @location(0) origin: vec3i,     // whole metres
    @location(1) surface: u32,      // bits 0..29: number in the table of surfaces; 30, 31: class
    @location(2) start: vec3f,      // from the origin, metres
    @location(3) normal_a: u32,     // octahedral; its face is left of the edge, seen from its front
    @location(4) end: vec3f,
    @location(5) normal_b: u32,     // right of it; the same as normal_a at a border
    @location(6) inward: vec2f,     // how far its faces go from the edge, metres
    @location(7) along: vec2u,      // and along it before its start and beyond its end, 2 halves each
    @location(8) other: u32,        // surface of its second face; that of the first at a border
}

const EDGE_BORDER: u32 = 0u;
const EDGE_CREASE: u32 = 1u;
const EDGE_FLAT: u32 = 2u;

// Stored depth of a perspective view is near / D with 24 bits, so a share of it is the same share of D. Positions are
// right to 2^-23 of D, but the depth of a triangle that begins at the eye is interpolated from numbers 1000 times larger.
const EDGE_BIAS: f32 = 1e-4;
// In orthographic views: metres.
const EDGE_BIAS_M: f32 = 0.01;
const EDGE_SLACK_PX: f32 = max(0.03125, 2.0 * SNAPPING);
// And by how much rasterisers take a pixel to be on the other side of the edge than it is.
const EDGE_SIDE_PX: f32 = max(0.0078125, 2.0 * SNAPPING);
// Faces that lean away more than this (the tangent of 76°) are not followed that far.
const EDGE_MOST_FALL: f32 = 4.0;
// Pixels around the picture where lines are kept, beyond their width.
const EDGE_MARGIN_PX: f32 = 4.0;

fn edge_surface(edge: Edge) -> u32 {
    return edge.surface & 0x3fffffffu;
}

fn edge_class(edge: Edge) -> u32 {
    return edge.surface >> 30u;
}

struct EdgeVertex {
    clip: vec4f,        // outside of the picture if nothing of the edge is in it; w = 1
    line: vec3f,        // pixels: along the edge from its visible start, across it to the left, length of what is visible
    // The same for all vertices of an edge, as what follows. Lengths are in edge lengths, each times what `edge_weight`
    // says of its place: so they are affine in the picture.
    ends: vec4f,        // stored depth of the visible start and end; where on the edge they are
    face_a: vec4f,      // on the plane of the first face, per pixel across to the left: how stored depth rises, how far one
                        // gets inward and along; and how far the face goes inward (not times anything, nor is what follows)
    face_b: vec4f,      // the same for the second face; the last one negative if there is none
    along: vec4f,       // where the first face begins and ends along the edge, and the second
}

// What part of a segment (view space) may be seen: from x to y, 0..1 along it; nothing if x >= y. `guard`: half size of
// the region that is kept, 1 = the picture.
fn edge_part(p: vec3f, q: vec3f, guard: vec2f) -> vec2f {
    let is_flat = view.orthographic == 1u;
    let w = select(vec2f(-p.z, -q.z), vec2f(1.0), is_flat);
    let x = vec2f(p.x, q.x) * view.projection.x + view.projection.z * w;
    let y = vec2f(p.y, q.y) * view.projection.y + view.projection.w * w;
    // Signed distances of both ends from the near plane and the four sides, inside positive.
    var inside = array<vec2f, 5>(vec2f(-p.z, -q.z) - view.near, guard.x * w - x, guard.x * w + x,
                                 guard.y * w - y, guard.y * w + y);
    var part = vec2f(0.0, 1.0);
    for (var i = 0; i < 5; i++) {
        let a = inside[i].x;
        let b = inside[i].y;
        if a < 0.0 && b < 0.0 {
            return vec2f(1.0, 0.0);
        }
        if a < 0.0 {
            part.x = max(part.x, a / (a - b));
        } else if b < 0.0 {
            part.y = min(part.y, a / (a - b));
        }
    }
    return part;
}

// Pixels from the middle of the target, y up, and stored depth. In front of the near plane nothing is asked.
fn edge_in_picture(p: vec3f) -> vec3f {
    let distance = max(-p.z, view.near);
    let w = select(distance, 1.0, view.orthographic == 1u);
    let ndc = p.xy * view.projection.xy / w + view.projection.zw;
    return vec3f(ndc * 0.5 * view.size, depth_of_distance(distance));
}

// How stored depth changes per pixel (y up) on the plane across `normal` through `p`, view space.
fn depth_slope(normal: vec3f, p: vec3f) -> vec2f {
    let per_ndc = 1.0 / view.projection.xy;
    let per_px = 2.0 / view.size * per_ndc;
    let is_flat = view.orthographic == 1u;
    let lean = select(dot(normal, p), normal.z, is_flat);
    let per_room = normal.xy / select(min(lean, -1e-6), max(lean, 1e-6), lean >= 0.0);
    return per_room * select(view.near, -1.0 / (view.far - view.near), is_flat) * per_px;
}

// What a length in a plane is multiplied with to become affine in the picture: stored depth, in perspective.
fn edge_weight(depth: f32) -> f32 {
    return select(depth, 1.0, view.orthographic == 1u);
}

fn edge_vertex(edge: Edge, i: u32, width_px: f32) -> EdgeVertex {
    var p = view.view_from_world * city_relative(edge.origin, edge.start);
    var q = view.view_from_world * city_relative(edge.origin, edge.end);
    // Whether it goes on beyond what is drawn of it.
    var goes_on = vec2<bool>(false);
    //@bent
    let reach = 0.5 * width_px + 0.5;
    let part = edge_part(p, q, 1.0 + 2.0 * (reach + EDGE_MARGIN_PX) / view.size);
    if part.x >= part.y {
        return EdgeVertex(vec4f(2.0, 2.0, 0.5, 1.0), vec3f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
    }
    let start = edge_in_picture(mix(p, q, part.x));
    let end = edge_in_picture(mix(p, q, part.y));
    let span = end.xy - start.xy;
    let extent = length(span);
    let along = select(vec2f(1.0, 0.0), span / max(extent, 1e-6), extent > 1e-6);
    let left = vec2f(-along.y, along.x);
    let is_end = (i & 1u) == 1u;
    let onward = select(select(-reach, 0.0, goes_on.x), select(reach, 0.0, goes_on.y), is_end);
    let across = select(reach, -reach, (i & 3u) >= 2u);
    let at = (select(start.xy, end.xy, is_end) + left * across + along * onward) * 2.0 / view.size;
    let line = vec3f(select(0.0, extent, is_end) + onward, across, extent);
    let ends = vec4f(start.z, end.z, part.x * edge_weight(start.z), part.y * edge_weight(end.z));

    let a = view.view_from_world * city_direction(decode_normal(edge.normal_a));
    let b = view.view_from_world * city_direction(decode_normal(edge.normal_b));
    let middle = mix(p, q, 0.5 * (part.x + part.y));
    let face_a = edge_face(a, p, q, middle, left, 1.0, city_length(edge.inward.x));
    let face_b = edge_face(b, p, q, middle, left, -1.0, city_length(edge.inward.y));
    let has_b = edge_class(edge) != EDGE_BORDER;
    let beyond = vec4f(unpack2x16float(edge.along.x), unpack2x16float(edge.along.y)) / max(distance(p, q), 1e-6) * city_length(1.0);
    return EdgeVertex(vec4f(at, select(start.z, end.z, is_end), 1.0), line, ends, face_a,
                      select(vec4f(0.0, 0.0, 0.0, -1.0), face_b, has_b), vec4f(0.0, 1.0, 0.0, 1.0) + beyond * vec4f(-1.0, 1.0, -1.0, 1.0));
}

// `EdgeVertex.face_a` of a face at the edge from p to q; `middle`: of what is visible of it; `left` of it in the picture.
// `turn`: 1 if the face is left of the edge, seen from its front, else -1.
fn edge_face(normal: vec3f, p: vec3f, q: vec3f, middle: vec3f, left: vec2f, turn: f32, extent: f32) -> vec4f {
    let size = max(distance(p, q), 1e-6);
    let forward = (q - p) / size;
    let inward = cross(normal, forward) * turn;
    let rise = dot(depth_slope(normal, middle), left);
    // A ray one pixel to the left, and what it gains on the plane along both axes, from p on.
    let ray = left * 2.0 / view.size / view.projection.xy;
    let is_flat = view.orthographic == 1u;
    let lean = select(-vec2f(dot(p, inward), dot(p, forward)), vec2f(inward.z, forward.z) * (view.far - view.near), is_flat);
    let gain = vec2f(dot(ray, inward.xy), dot(ray, forward.xy)) * select(view.near, 1.0, is_flat) + lean * rise;
    return vec4f(rise, gain / size, extent / size);
}

// How far along the visible part of the edge a pixel of its line is, 0..1.
fn edge_share(line: vec3f) -> f32 {
    return clamp(line.x / max(line.z, 1e-6), 0.0, 1.0);
}

// Stored depth of the edge itself beside a pixel of its line. Its round ends, where it is not, fall back.
fn edge_own_depth(line: vec3f, ends: vec4f) -> f32 {
    let depth = mix(ends.x, ends.y, edge_share(line));
    let beyond = abs(line.x - clamp(line.x, 0.0, line.z));
    return max(depth - edge_most_fall(depth) * beyond, 0.5 * depth);
}

// How stored depth changes per pixel on a face that leans by EDGE_MOST_FALL.
fn edge_most_fall(depth: f32) -> f32 {
    let metres = EDGE_MOST_FALL * 2.0 / (view.size.y * view.projection.y);
    return metres * select(depth, 1.0 / (view.far - view.near), view.orthographic == 1u);
}

// What to take for a face at a pixel of the line (x), and whether the pixel is on its side of the edge (y: 1 or 0).
// `face`, `span`: of an `EdgeVertex`. A face that comes nearer counts no farther than it goes.
fn edge_face_depth(line: vec3f, ends: vec4f, depth: f32, face: vec4f, span: vec2f) -> vec2f {
    let side = select(-1.0, 1.0, face.y >= 0.0);
    let is_beside = face.w >= 0.0 && side * line.y >= -EDGE_SIDE_PX;
    let across = side * (max(side * line.y, 0.0) + EDGE_SLACK_PX);
    let on_plane = depth + face.x * across;
    let inward = face.y * across / edge_weight(on_plane);
    let along = (mix(ends.z, ends.w, edge_share(line)) + face.z * across) / edge_weight(on_plane);
    let is_there = on_plane > depth && inward <= face.w && along >= span.x && along <= span.y;
    let fall = min(abs(face.x), edge_most_fall(depth)) * max(abs(line.y) - EDGE_SLACK_PX, 0.0);
    let is_near = side * face.x > 0.0 && is_beside;
    return vec2f(select(select(max(depth - fall, 0.5 * depth), depth, is_near), on_plane, is_near && is_there),
                 select(0.0, 1.0, is_beside));
}

// The depth to test instead, as told above.
fn edge_depth(line: vec3f, ends: vec4f, face_a: vec4f, face_b: vec4f, along: vec4f) -> f32 {
    let depth = edge_own_depth(line, ends);
    let a = edge_face_depth(line, ends, depth, face_a, along.xy);
    let b = edge_face_depth(line, ends, depth, face_b, along.zw);
    var drawn = min(a.x, b.x);
    if a.y + b.y > 0.0 {
        drawn = max(select(0.0, a.x, a.y > 0.0), select(0.0, b.x, b.y > 0.0));
    }
    let bias = select(EDGE_BIAS * depth, EDGE_BIAS_M / (view.far - view.near), view.orthographic == 1u);
    let off_along = abs(ends.y - ends.x) * min(SNAPPING, line.z) / max(line.z, 1e-6);
    return min(drawn + bias + off_along, 1.0);
}

// How much of a pixel the line covers, 0..1; its ends are round.
fn edge_coverage(line: vec3f, width_px: f32) -> f32 {
    let beyond = max(max(-line.x, line.x - line.z), 0.0);
    return clamp(0.5 * width_px + 0.5 - length(vec2f(beyond, line.y)), 0.0, 1.0);
}
