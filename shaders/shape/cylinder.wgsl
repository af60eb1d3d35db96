// A cylinder.

struct Cylinder {
    center: vec3f,              // a.xyz: the middle of its axis, metres
    radius: f32,                // b.x: metres
    axis: vec3f,                // d.xyz: unit
    half: f32,                  // d.w: of its height, metres
}

fn cylinder_holds(s: Cylinder, sight: Sight) -> bool {
    let o = sight.position - s.center;
    let along = dot(o, s.axis);
    let across = o - along * s.axis;
    return abs(along) <= s.half + face_slack(s.center, sight) && dot(across, across) <= s.radius * s.radius;
}

fn span_of_cylinder(ray: Ray, s: Cylinder) -> Span {
    let o = ray.origin - s.center;
    let ends = span_of_slab(dot(o, s.axis), dot(ray.direction, s.axis), s.half);
    let across = ray.direction - dot(ray.direction, s.axis) * s.axis;
    let o_across = o - dot(o, s.axis) * s.axis;
    let steepness = dot(across, across);
    if steepness < 1e-14 * dot(ray.direction, ray.direction) {
        // Along the axis: inside for the whole way or not at all.
        if dot(o_across, o_across) > s.radius * s.radius {
            return EMPTY_SPAN;
        }
        return ends;
    }
    let middle = -dot(o_across, across) / steepness;
    let miss = o_across + middle * across;
    let discriminant = s.radius * s.radius - dot(miss, miss);
    if discriminant < 0.0 {
        return EMPTY_SPAN;
    }
    let half = sqrt(discriminant / steepness);
    return meet(ends, Span(middle - half, middle + half));
}

fn distance_to_cylinder(s: Cylinder, sight: Sight, border: vec4f) -> f32 {
    let o = sight.position - s.center;
    let along = dot(o, s.axis);
    let q = vec2f(length(o - along * s.axis) - s.radius, abs(along) - s.half);
    return length(max(q, vec2f(0.0))) + min(max(q.x, q.y), 0.0);
}
