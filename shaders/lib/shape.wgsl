// Lens volumes, in view space: whether they hold a place, and where they are along a ray. The host computes every figure relative to the
// eye in f64 before it rounds to f32; `crate::geom::Shape` is the f64 twin of the functions here.

struct Shape {
    center: vec3f,              // metres; flat: see span_of_flat, as its axes
    kind: u32,                  // SPHERE, BOX, ...
    axis_x: vec3f,              // box: its x edge, unit; ellipsoid: its x axis over the radius there; solid: its x axis
    size_x: f32,                // sphere, cylinder: radius; box: half edge along axis_x; convex: number of its first plane;
                                // frustum: radius at its middle; solid: number of its first entry; flat: a disc's radius, half a
                                // rectangle's edge, number of a polygon's first side
    axis_y: vec3f,              // box, ellipsoid, solid: as axis_x
    size_y: f32,                // box: half edge; convex: how many planes; frustum: what the radius grows by along its axis;
                                // flat: half a rectangle's edge, how many sides a polygon has
    axis_z: vec3f,              // box, ellipsoid, solid: as axis_x; cylinder, frustum: its axis, unit
    size_z: f32,                // box: half edge; cylinder, frustum: half height; solid: how often it goes around the
                                // eye, and a quarter more where that is in doubt; flat: DISC,
                                // RECTANGLE or POLYGON
}

const SPHERE: u32 = 0u;
const BOX: u32 = 1u;
const CYLINDER: u32 = 2u;
const CONVEX: u32 = 3u;
const ELLIPSOID: u32 = 4u;
const FRUSTUM: u32 = 5u;
const SOLID: u32 = 6u;
// Not shapes: a solid whose sides a depth sprite tells; a volume that is tested by its depth sprite.
const SOLID_SPRITE: u32 = 7u;
const SPRITE: u32 = 8u;
// No volume: what belongs to chosen objects; size_x = where their marks begin among the values of objects.
const MEMBERS: u32 = 9u;
// A combination of volumes; one whose sides a depth sprite tells.
const COMBINED: u32 = 10u;
const COMBINED_SPRITE: u32 = 11u;
const FLAT: u32 = 12u;
// A volume that is tested by a depth sprite in any format.
const LAYERED_SPRITE: u32 = 13u;
// One that is tested by a sprite that has its own eye; size_x = number of the first of its rows among the planes.
const OWN_SPRITE: u32 = 14u;
// As MEMBERS, of which some come or go.
const FADING_MEMBERS: u32 = 15u;

// Where a ray is inside: [enter, exit] in D, may start behind the eye; empty when enter > exit.
struct Span {
    enter: f32,
    exit: f32,
}

const EMPTY_SPAN = Span(1.0, -1.0);

// The closest approach to the centre is subtracted as a vector, so the discriminant does not cancel
// however far the sphere is (Hearn & Baker's form, cf. Ray Tracing Gems, ch. 7).
fn span_of_sphere(ray: Ray, center: vec3f, radius: f32) -> Span {
    let to_center = center - ray.origin;
    let inv = 1.0 / dot(ray.direction, ray.direction);
    let middle = dot(to_center, ray.direction) * inv;
    let miss = to_center - middle * ray.direction;
    let discriminant = radius * radius - dot(miss, miss);
    if discriminant < 0.0 {
        return EMPTY_SPAN;
    }
    let half = sqrt(discriminant * inv);
    return Span(middle - half, middle + half);
}

fn sphere_holds(s: Shape, p: vec3f) -> bool {
    let o = p - s.center;
    return dot(o, o) <= s.size_x * s.size_x;
}

// Between two parallel planes at -size and +size from the centre. A direction along the planes is
// replaced by 2^-80, which keeps the answer of the ray's side.
fn span_of_slab(offset: f32, slope: f32, size: f32) -> Span {
    let s = select(slope, select(-8.271806e-25, 8.271806e-25, slope >= 0.0), abs(slope) < 8.271806e-25);
    let a = (-size - offset) / s;
    let b = (size - offset) / s;
    return Span(min(a, b), max(a, b));
}

fn meet(a: Span, b: Span) -> Span {
    return Span(max(a.enter, b.enter), min(a.exit, b.exit));
}

// A place on a flat face is in the volume (closed bodies), and a wall that lies in a face's plane comes with the rounding of
// its depth: so flat faces hold half of the band of analytic tests more (8 * 2^-23 of the larger distance from the eye).
const ON_FACE: f32 = 4.0 * 1.1920929e-7;

// For a volume around `center`, seen at distance D, metres. |x| + |y| + |z| is at most 1.73 of the length.
fn face_slack(center: vec3f, distance: f32) -> f32 {
    return ON_FACE * max(abs(distance), 0.57735 * dot(abs(center), vec3f(1.0)));
}

fn box_holds(s: Shape, p: vec3f, distance: f32) -> bool {
    let o = p - s.center;
    let slack = face_slack(s.center, distance);
    return abs(dot(o, s.axis_x)) <= s.size_x + slack && abs(dot(o, s.axis_y)) <= s.size_y + slack
        && abs(dot(o, s.axis_z)) <= s.size_z + slack;
}

fn span_of_box(ray: Ray, s: Shape) -> Span {
    let o = ray.origin - s.center;
    return meet(
        span_of_slab(dot(o, s.axis_x), dot(ray.direction, s.axis_x), s.size_x),
        meet(span_of_slab(dot(o, s.axis_y), dot(ray.direction, s.axis_y), s.size_y),
             span_of_slab(dot(o, s.axis_z), dot(ray.direction, s.axis_z), s.size_z)));
}

fn cylinder_holds(s: Shape, p: vec3f, distance: f32) -> bool {
    let o = p - s.center;
    let along = dot(o, s.axis_z);
    let across = o - along * s.axis_z;
    return abs(along) <= s.size_z + face_slack(s.center, distance) && dot(across, across) <= s.size_x * s.size_x;
}

fn span_of_cylinder(ray: Ray, s: Shape) -> Span {
    let o = ray.origin - s.center;
    let ends = span_of_slab(dot(o, s.axis_z), dot(ray.direction, s.axis_z), s.size_z);
    let across = ray.direction - dot(ray.direction, s.axis_z) * s.axis_z;
    let o_across = o - dot(o, s.axis_z) * s.axis_z;
    let steepness = dot(across, across);
    if steepness < 1e-14 * dot(ray.direction, ray.direction) {
        // Along the axis: inside for the whole way or not at all.
        if dot(o_across, o_across) > s.size_x * s.size_x {
            return EMPTY_SPAN;
        }
        return ends;
    }
    let middle = -dot(o_across, across) / steepness;
    let miss = o_across + middle * across;
    let discriminant = s.size_x * s.size_x - dot(miss, miss);
    if discriminant < 0.0 {
        return EMPTY_SPAN;
    }
    let half = sqrt(discriminant / steepness);
    return meet(ends, Span(middle - half, middle + half));
}

// From the shape's middle, in the measure in which an ellipsoid is a ball of radius 1.
fn in_ellipsoid(s: Shape, v: vec3f) -> vec3f {
    return vec3f(dot(v, s.axis_x), dot(v, s.axis_y), dot(v, s.axis_z));
}

fn ellipsoid_holds(s: Shape, p: vec3f) -> bool {
    let o = in_ellipsoid(s, p - s.center);
    return dot(o, o) <= 1.0;
}

fn span_of_ellipsoid(ray: Ray, s: Shape) -> Span {
    let own = Ray(in_ellipsoid(s, ray.origin - s.center), in_ellipsoid(s, ray.direction));
    return span_of_sphere(own, vec3f(0.0), 1.0);
}

fn frustum_holds(s: Shape, p: vec3f, distance: f32) -> bool {
    let o = p - s.center;
    let along = dot(o, s.axis_z);
    let across = o - along * s.axis_z;
    let radius = s.size_x + s.size_y * along;
    return abs(along) <= s.size_z + face_slack(s.center, distance) && dot(across, across) <= radius * radius;
}

// |across| <= radius along the ray is a quadratic, set up around the point of the ray nearest the middle: two cones that meet
// in the tip, of which the ends leave one.
fn span_of_frustum(ray: Ray, s: Shape) -> Span {
    let nearest = -dot(ray.origin - s.center, ray.direction) / dot(ray.direction, ray.direction);
    let o = ray.origin - s.center + nearest * ray.direction;
    let rise = dot(ray.direction, s.axis_z);
    let height = dot(o, s.axis_z);
    let across = ray.direction - rise * s.axis_z;
    let o_across = o - height * s.axis_z;
    let radius = s.size_x + s.size_y * height;
    let growth = s.size_y * rise;
    let a = dot(across, across) - growth * growth;
    let b = dot(o_across, across) - radius * growth;
    let c = dot(o_across, o_across) - radius * radius;
    let ends = span_of_slab(height, rise, s.size_z);
    var side = Span(-FAR_AWAY, FAR_AWAY);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        // Only where it is steeper than the side does it stay within one of the cones.
        side = Span(select(FAR_AWAY, -FAR_AWAY, a < 0.0), FAR_AWAY);
    } else {
        let q = -(b + select(-sqrt(discriminant), sqrt(discriminant), b >= 0.0));
        let first = select(q / a, select(-FAR_AWAY, FAR_AWAY, growth > 0.0), abs(a) < 1e-30);
        let second = select(c / q, 0.0, abs(q) < 1e-30);
        let low = min(first, second);
        let high = max(first, second);
        side = Span(low, high);
        if a < 0.0 {
            // In one cone up to the first, in the other from the second on.
            side = Span(select(-FAR_AWAY, high, growth > 0.0), select(low, FAR_AWAY, growth > 0.0));
        }
    }
    let span = meet(ends, side);
    return Span(span.enter + nearest, span.exit + nearest);
}

@group(1) @binding(1) var<storage, read> planes: array<vec4f>; // n, d: inside where n.p <= d; of a flat lens' polygon: its sides

fn convex_holds(s: Shape, p: vec3f, distance: f32) -> bool {
    var is_below = true;
    let first = u32(s.size_x);
    for (var i = first; i < first + u32(s.size_y); i++) {
        is_below = is_below && dot(planes[i].xyz, p) <= planes[i].w + ON_FACE * max(abs(distance), abs(planes[i].w));
        // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
        if i + 1u == first + u32(s.size_y) {
            break;
        }
    }
    return is_below;
}

fn span_of_convex(ray: Ray, s: Shape) -> Span {
    var span = Span(-FAR_AWAY, FAR_AWAY);
    let first = u32(s.size_x);
    for (var i = first; i < first + u32(s.size_y); i++) {
        let plane = planes[i];
        let slope = dot(plane.xyz, ray.direction);
        let room = plane.w - dot(plane.xyz, ray.origin);
        if abs(slope) < 8.271806e-25 {
            if room < 0.0 {
                return EMPTY_SPAN;
            }
        } else if slope > 0.0 {
            span.exit = min(span.exit, room / slope);
        } else {
            span.enter = max(span.enter, room / slope);
        }
    }
    return span;
}

// Figures of flat lenses, in size_z.
const DISC: f32 = 0.0;
const RECTANGLE: f32 = 1.0;
const POLYGON: f32 = 2.0;

// Where a flat lens is never left.
const NO_END: f32 = FAR_AWAY;

// What is seen through a figure in a plane, from the plane to infinity. Where a sight line crosses the plane is a projective
// map of where it crosses the picture, a = (x, y, -1): D = center.a / axis_z.a, and in the figure's own coordinates
// (axis_x.a, axis_y.a) / axis_z.a. The host makes it in f64, so that axis_z.a > 0 where the plane is seen; 0: edge on.
fn span_of_flat(ray: Ray, s: Shape) -> Span {
    // (x, y, -1) for parallel rays, too.
    let a = ray.origin + ray.direction;
    let w = dot(s.axis_z, a);
    let at = clamp(vec2f(dot(s.axis_x, a), dot(s.axis_y, a)) / w, vec2f(-1e15), vec2f(1e15));
    let enter = clamp(dot(s.center, a) / w, -FAR_AWAY, FAR_AWAY);
    let is_met = w > 1e-20 && is_in_figure(s, at);
    return Span(select(EMPTY_SPAN.enter, enter, is_met), select(EMPTY_SPAN.exit, NO_END, is_met));
}

fn is_in_figure(s: Shape, at: vec2f) -> bool {
    if s.size_z == POLYGON {
        return is_in_polygon(u32(s.size_x), u32(s.size_y), at);
    }
    if s.size_z == RECTANGLE {
        return abs(at.x) <= s.size_x && abs(at.y) <= s.size_y;
    }
    return dot(at, at) <= s.size_x * s.size_x;
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

// `kind`: the shape's own, or a constant where all shapes of a pipeline are of one: a software adapter runs all cases of a
// switch that it cannot decide before.
fn span_of_shape(ray: Ray, s: Shape, kind: u32) -> Span {
    switch kind {
        case SPHERE: { return span_of_sphere(ray, s.center, s.size_x); }
        case BOX: { return span_of_box(ray, s); }
        case CYLINDER: { return span_of_cylinder(ray, s); }
        case ELLIPSOID: { return span_of_ellipsoid(ray, s); }
        case FRUSTUM: { return span_of_frustum(ray, s); }
        case FLAT: { return span_of_flat(ray, s); }
        default: { return span_of_convex(ray, s); }
    }
}

// Whether a place at D of the main view's ray is behind a figure, or in its plane.
fn flat_holds(s: Shape, ray: Ray, distance: f32, is_parallel: bool) -> bool {
    let span = span_of_flat(ray, s);
    let is_before_eye = is_parallel || (span.enter > 0.0 && distance > 0.0);
    return is_before_eye && span.enter <= span.exit && distance >= span.enter;
}

// `kind`: as above, not FLAT, which asks by the ray; `distance`: D of the place.
fn holds(s: Shape, kind: u32, p: vec3f, distance: f32) -> bool {
    switch kind {
        case SPHERE: { return sphere_holds(s, p); }
        case BOX: { return box_holds(s, p, distance); }
        case CYLINDER: { return cylinder_holds(s, p, distance); }
        case ELLIPSOID: { return ellipsoid_holds(s, p); }
        case FRUSTUM: { return frustum_holds(s, p, distance); }
        default: { return convex_holds(s, p, distance); }
    }
}
