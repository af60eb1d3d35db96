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

// |miss - radius| is |centre| |sin a - sin b|, which is at most |centre| |a - b|: no smaller turn changes what is met.
fn sphere_is_clear(ray: Ray, s: Sphere, turn: f32) -> bool {
    let to_center = s.center - ray.origin;
    let away = length(to_center);
    let middle = dot(to_center, ray.direction) / dot(ray.direction, ray.direction);
    let miss = length(to_center - middle * ray.direction);
    // And what is lost to rounding.
    return abs(miss - s.radius) > turn * select(away, 1.0, view.orthographic == 1u) + 4e-6 * away;
}

fn distance_to_sphere(s: Sphere, sight: Sight, border: vec4f) -> f32 {
    return length(sight.position - s.center) - s.radius;
}
