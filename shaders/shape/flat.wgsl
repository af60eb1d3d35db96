// What is seen through a figure in a plane, from the plane to infinity. Where a sight line crosses the plane is a projective
// map of where it crosses the picture, a = (x, y, -1): D = depth.a / weight.a, and in the figure's own coordinates
// (x.a, y.a) / weight.a. The host makes it in f64, so that weight.a > 0 where the plane is seen; 0: edge on.

struct Flat {
    depth: vec3f,               // a.xyz
    x: vec3f,                   // b.xyz
    y: vec3f,                   // c.xyz
    weight: vec3f,              // d.xyz
    figure: f32,                // d.w: DISC, RECTANGLE or POLYGON
    size: vec2f,                // b.w c.w: a disc's radius (x), half a rectangle's edges, metres
    first: u32,                 // b.w: number of a polygon's first side among the planes
    count: u32,                 // c.w: how many it has
}

const DISC: f32 = 0.0;
const RECTANGLE: f32 = 1.0;
const POLYGON: f32 = 2.0;

// The place of the picture, (x, y, -1), at which the place is seen where a ray crosses the plane of a figure.
fn place_on_figure(ray: Ray, s: Flat) -> vec3f {
    let a = picture_place(ray);
    return picture_place_at(dot(s.depth, a) / dot(s.weight, a), a);
}

fn span_of_flat(ray: Ray, s: Flat) -> Span {
    return span_at(place_on_figure(ray, s), s);
}

fn span_at(a: vec3f, s: Flat) -> Span {
    let w = dot(s.weight, a);
    let at = clamp(vec2f(dot(s.x, a), dot(s.y, a)) / w, vec2f(-1e15), vec2f(1e15));
    let enter = clamp(dot(s.depth, a) / w, -FAR_AWAY, FAR_AWAY);
    let is_met = w > 1e-20 && is_in_figure(s, at);
    return Span(select(EMPTY_SPAN.enter, enter, is_met), select(EMPTY_SPAN.exit, NO_END, is_met));
}

fn is_in_figure(s: Flat, at: vec2f) -> bool {
    if s.figure == POLYGON {
        return is_in_polygon(s.first, s.count, at);
    }
    if s.figure == RECTANGLE {
        return abs(at.x) <= s.size.x && abs(at.y) <= s.size.y;
    }
    return dot(at, at) <= s.size.x * s.size.x;
}

// Whether a polygon goes around a point; the sides stand in `planes`. Twin: `winding` in `geom::shape::flat`.
fn is_in_polygon(first: u32, count: u32, p: vec2f) -> bool {
    var around = 0;
    for (var i = first; i < first + count; i++) {
        let a = planes[i].xy;
        let along = planes[i].zw - a;
        let from_a = p - a;
        let side = along.x * from_a.y - along.y * from_a.x;
        let is_up = a.y <= p.y && planes[i].w > p.y;
        let is_down = a.y > p.y && planes[i].w <= p.y;
        around += select(0, 1, is_up && side > 0.0) - select(0, 1, is_down && side < 0.0);
    }
    return around != 0;
}

// Whether a place is behind a figure's plane, which its ray crosses at `enter` with the weight `w`, or in it: w is how fast a ray comes
// away from the plane, and what is in the plane comes with the rounding of its depth.
fn is_behind_plane(sight: Sight, enter: f32, w: f32) -> bool {
    let is_before_eye = sight.is_parallel || (enter > 0.0 && sight.distance > 0.0);
    return w > 1e-20 && is_before_eye && (sight.distance - enter) * w >= -(ON_FACE * abs(sight.distance) + sight.off);
}

// Whether a place at D of the main view's ray is behind a figure, or in its plane; also where nothing is.
fn flat_holds(s: Flat, sight: Sight) -> bool {
    let a = place_on_figure(sight.ray, s);
    let span = span_at(a, s);
    let w = dot(s.weight, a);
    return span.enter <= span.exit && is_behind_plane(sight, span.enter, w);
}

fn distance_to_sides(first: u32, count: u32, p: vec2f) -> f32 {
    var least = FAR_AWAY;
    for (var i = first; i < first + count; i++) {
        least = min(least, distance_to_segment(p, planes[i].xy, planes[i].zw));
    }
    return select(least, -least, is_in_polygon(first, count, p));
}

// The map to the figure moves no place of the picture farther than this; where the plane is not met, none within the turn meets it.
fn flat_is_clear(ray: Ray, s: Flat, turn: f32) -> bool {
    let a = place_on_figure(ray, s);
    let w = dot(s.weight, a);
    let slack = turn * length(s.weight.xy);
    let at = vec2f(dot(s.x, a), dot(s.y, a)) / w;
    let moves = (turn * length(vec2f(length(s.x.xy), length(s.y.xy))) + slack * length(at)) / (w - slack);
    var across = length(at) - s.size.x;
    if s.figure == POLYGON {
        across = distance_to_sides(s.first, s.count, at);
    } else if s.figure == RECTANGLE {
        let beyond = abs(at) - s.size;
        across = length(max(beyond, vec2f(0.0))) + min(max(beyond.x, beyond.y), 0.0);
    }
    // And what is lost to rounding.
    let is_met = w > slack && abs(across) > moves + 4e-6 * length(at);
    return is_met || w < -slack;
}

// In the figure's plane, across its outline; what is before the plane is outside altogether. In pixels: those of the plane.
fn distance_to_flat(s: Flat, sight: Sight, border: vec4f) -> f32 {
    let a = place_on_figure(sight.ray, s);
    let w = dot(s.weight, a);
    let at = clamp(vec2f(dot(s.x, a), dot(s.y, a)) / w, vec2f(-1e15), vec2f(1e15));
    let enter = clamp(dot(s.depth, a) / w, -FAR_AWAY, FAR_AWAY);
    var across = length(at) - s.size.x;
    if s.figure == POLYGON {
        across = distance_to_sides(s.first, s.count, at);
    } else if s.figure == RECTANGLE {
        across = distance_to_block(vec3f(at, 0.0), vec3f(s.size, 1e30));
    }
    let further = select(sight.distance / enter, 1.0, border.y < 0.5 || sight.is_parallel);
    return select(FAR_AWAY, across * further, is_behind_plane(sight, enter, w));
}
