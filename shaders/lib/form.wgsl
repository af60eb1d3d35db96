// Functions that several forms of regions call.

fn meet(a: Span, b: Span) -> Span {
    return Span(max(a.enter, b.enter), min(a.exit, b.exit));
}

// Between two parallel planes at -size and +size from the centre. A direction along the planes is
// replaced by 2^-80, which keeps the answer of the ray's side.
fn span_of_slab(offset: f32, slope: f32, size: f32) -> Span {
    let s = select(slope, select(-8.271806e-25, 8.271806e-25, slope >= 0.0), abs(slope) < 8.271806e-25);
    let a = (-size - offset) / s;
    let b = (size - offset) / s;
    return Span(min(a, b), max(a, b));
}

// The closest approach to the centre is subtracted as a vector, so the discriminant does not cancel
// however far the ball is (Hearn & Baker's form, cf. Ray Tracing Gems, ch. 7).
fn span_of_ball(ray: Ray, center: vec3f, radius: f32) -> Span {
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

// A place on a flat face is in the volume (closed bodies), and a wall that lies in a face's plane comes with the rounding of
// its depth: so flat faces hold half of the band of analytic tests more (S7: 8 * 2^-23 of the larger distance from the eye).
const ON_FACE: f32 = 4.0 * 1.1920929e-7;

// The same for the rasteriser that draws what is seen, metres. For a volume around `center`; |x| + |y| + |z| is at most 1.73 of the length.
fn face_slack(center: vec3f, sight: Sight) -> f32 {
    return ON_FACE * max(abs(sight.distance), 0.57735 * dot(abs(center), vec3f(1.0))) + sight.off;
}

// How far a place is from a box around the origin, metres, negative inside.
fn distance_to_block(p: vec3f, half: vec3f) -> f32 {
    let q = abs(p) - half;
    return length(max(q, vec3f(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

fn distance_to_segment(p: vec2f, a: vec2f, b: vec2f) -> f32 {
    let along = b - a;
    return length(p - a - clamp(dot(p - a, along) / max(dot(along, along), 1e-30), 0.0, 1.0) * along);
}
