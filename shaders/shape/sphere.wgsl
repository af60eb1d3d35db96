// A ball.

struct Sphere {
    center: vec3f,              // a.xyz: metres
    radius: f32,                // b.x: metres
}

fn span_of_sphere(ray: Ray, s: Sphere) -> Span {
    return span_of_ball(ray, s.center, s.radius);
}

fn sphere_holds(s: Sphere, sight: Sight) -> bool {
    let o = sight.position - s.center;
    return dot(o, o) <= s.radius * s.radius;
}

fn distance_to_sphere(s: Sphere, sight: Sight, border: vec4f) -> f32 {
    return length(sight.position - s.center) - s.radius;
}
