// The glass of the bodies of lenses.

// On the side towards the sun it is lighter; seen at a slant there is more of it.
fn glazed(paint: vec4f, normal: vec3f, ray: Ray, color: vec3f, most: f32) -> vec4f {
    // Without a normal where a sprite alone tells the surface.
    let is_known = dot(normal, normal) > 0.5;
    let facing = select(0.6, abs(dot(normal, normalize(ray.direction))), is_known);
    let slant = (1.0 - facing) * (1.0 - facing);
    let lit = select(0.85, 0.7 + 0.3 * dot(normal, view.view_from_world * light.to_sun), is_known);
    let opacity = most * mix(0.35, 1.0, slant);
    return vec4f(mix(paint.rgb, color * lit, opacity), paint.a + (1.0 - paint.a) * opacity);
}

// A place in view space, seen from itself.
fn sight_near(pixel: vec2i, position: vec3f) -> Sight {
    let along = vec3f(0.0, 0.0, -1.0);
    let is_parallel = view.orthographic == 1u;
    var ray = Ray(vec3f(position.xy, 0.0), along);
    if !is_parallel {
        ray = Ray(vec3f(0.0), vec3f(position.xy / max(-position.z, 1e-20), -1.0));
    }
    return Sight(pixel, 0.0, ray, -position.z, position, is_parallel, NO_OBJECT, 0.0);
}

// The span of both spans, and of what is between.
fn with_span(a: Span, b: Span) -> Span {
    let both = Span(min(a.enter, b.enter), max(a.exit, b.exit));
    if a.enter > a.exit {
        return b;
    }
    if b.enter > b.exit {
        return a;
    }
    return both;
}
