// A cone, cut or not.

struct Frustum {
    center: vec3f,              // a.xyz: the middle of its axis, metres
    radius: f32,                // b.x: there, metres
    growth: f32,                // c.w: of the radius along the axis
    axis: vec3f,                // d.xyz: unit
    half: f32,                  // d.w: of its height, metres
}

fn frustum_holds(s: Frustum, sight: Sight) -> bool {
    let o = sight.position - s.center;
    let along = dot(o, s.axis);
    let across = o - along * s.axis;
    let radius = s.radius + s.growth * along;
    return abs(along) <= s.half + face_slack(s.center, sight) && dot(across, across) <= radius * radius;
}

// |across| <= radius along the ray is a quadratic, set up around the point of the ray nearest the middle: two cones that meet
// in the tip, of which the ends leave one.
fn span_of_frustum(ray: Ray, s: Frustum) -> Span {
    let nearest = -dot(ray.origin - s.center, ray.direction) / dot(ray.direction, ray.direction);
    let o = ray.origin - s.center + nearest * ray.direction;
    let rise = dot(ray.direction, s.axis);
    let height = dot(o, s.axis);
    let across = ray.direction - rise * s.axis;
    let o_across = o - height * s.axis;
    let radius = s.radius + s.growth * height;
    let growth = s.growth * rise;
    let a = dot(across, across) - growth * growth;
    let b = dot(o_across, across) - radius * growth;
    let c = dot(o_across, o_across) - radius * radius;
    let ends = span_of_slab(height, rise, s.half);
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

// By its section through the axis: away from that, along it.
fn distance_to_frustum(s: Frustum, sight: Sight, border: vec4f) -> f32 {
    let o = sight.position - s.center;
    let along = dot(o, s.axis);
    let p = vec2f(length(o - along * s.axis), along);
    let bottom = vec2f(max(s.radius - s.growth * s.half, 0.0), -s.half);
    let top = vec2f(max(s.radius + s.growth * s.half, 0.0), s.half);
    let side = normalize(top - bottom);
    let up = p - bottom;
    let within = max(up.x * side.y - up.y * side.x, abs(p.y) - s.half);
    let beyond = min(distance_to_segment(p, bottom, top),
                     min(distance_to_segment(p, vec2f(0.0, bottom.y), bottom), distance_to_segment(p, vec2f(0.0, top.y), top)));
    return select(beyond, within, within <= 0.0);
}
