// A ball that is stretched along its own axes.

struct Ellipsoid {
    center: vec3f,              // a.xyz: metres
    x: vec3f,                   // b.xyz: its axes, each over the radius there
    y: vec3f,                   // c.xyz
    z: vec3f,                   // d.xyz
}

// From its middle, in the measure in which it is a ball of radius 1.
fn in_ellipsoid(s: Ellipsoid, v: vec3f) -> vec3f {
    return vec3f(dot(v, s.x), dot(v, s.y), dot(v, s.z));
}

fn ellipsoid_holds(s: Ellipsoid, sight: Sight) -> bool {
    let o = in_ellipsoid(s, sight.position - s.center);
    return dot(o, o) <= 1.0;
}

fn span_of_ellipsoid(ray: Ray, s: Ellipsoid) -> Span {
    let own = Ray(in_ellipsoid(s, ray.origin - s.center), in_ellipsoid(s, ray.direction));
    return span_of_ball(own, vec3f(0.0), 1.0);
}

// The nearest point x has x_i = e_i^2 y_i / (t + e_i^2) with t the largest root of sum (e_i y_i / (t + e_i^2))^2 = 1, counted from
// -min e_i^2 (Eberly). Newton's steps come from the left and never go past it: the sum is convex and falls.
fn distance_to_axes(p: vec3f, radii: vec3f) -> f32 {
    let scale = max(radii.x, max(radii.y, radii.z));
    let e = radii / scale;
    let y = max(abs(p) / scale, vec3f(1e-6) * e);
    let least = min(e.x, min(e.y, e.z));
    let above = (e - least) * (e + least);
    let ey = e * y;
    // Each term alone is at most 1 there.
    var s = max(max(ey.x - above.x, ey.y - above.y), ey.z - above.z);
    s = max(s, 1e-12);
    for (var i = 0; i < 12; i++) {
        let q = ey / (s + above);
        let left = dot(q, q) - 1.0;
        let fall = 2.0 * dot(q * q, 1.0 / (s + above));
        s += max(left, 0.0) / fall;
    }
    let nearest = e * ey / (s + above);
    let apart = length(y - nearest) * scale;
    let inside = p / radii;
    return select(apart, -apart, dot(inside, inside) <= 1.0);
}

fn distance_to_ellipsoid(s: Ellipsoid, sight: Sight, border: vec4f) -> f32 {
    // Its axes are as long as one over its radii.
    let radii = 1.0 / vec3f(length(s.x), length(s.y), length(s.z));
    return distance_to_axes(in_ellipsoid(s, sight.position - s.center) * radii, radii);
}
