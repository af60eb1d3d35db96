// An oriented box.

struct Box {
    center: vec3f,              // a.xyz: metres
    x: vec3f,                   // b.xyz: its edges, unit
    y: vec3f,                   // c.xyz
    z: vec3f,                   // d.xyz
    half: vec3f,                // b.w c.w d.w: half of each, metres
}

fn box_holds(s: Box, sight: Sight) -> bool {
    let o = sight.position - s.center;
    let slack = face_slack(s.center, sight);
    return abs(dot(o, s.x)) <= s.half.x + slack && abs(dot(o, s.y)) <= s.half.y + slack && abs(dot(o, s.z)) <= s.half.z + slack;
}

fn span_of_box(ray: Ray, s: Box) -> Span {
    let o = ray.origin - s.center;
    return meet(
        span_of_slab(dot(o, s.x), dot(ray.direction, s.x), s.half.x),
        meet(span_of_slab(dot(o, s.y), dot(ray.direction, s.y), s.half.y),
             span_of_slab(dot(o, s.z), dot(ray.direction, s.z), s.half.z)));
}

fn distance_to_box(s: Box, sight: Sight, border: vec4f) -> f32 {
    let o = sight.position - s.center;
    return distance_to_block(vec3f(dot(o, s.x), dot(o, s.y), dot(o, s.z)), s.half);
}
