// The body of a lens as tinted glass: of its surface what each ray meets first and last, as far as nothing stands before.

// Which way the surface of a lens looks at a place: how its distance grows, from four places around (a tetrahedron).
fn lens_normal(lens: u32, pixel: vec2i, ray: Ray, t: f32) -> vec3f {
    let step = number_as_is(1e-3 * max(t, 1.0));
    var normal = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let aside = select(vec3f(-0.57735), vec3f(0.57735), vec3<bool>((i & 1u) == 1u, (i & 2u) == 2u, i == 0u || i == 3u));
        let position = as_is(ray.origin + t * ray.direction + step * aside);
        normal += aside * clamp(number_as_is(lens_distance(lens, sight_near(pixel, position), 4.0 * step)), -1e3 * step, 1e3 * step);
    }
    // It grows by 4/3 of the step; by nothing but roundings where a sprite alone tells the surface.
    let growth = length(normal);
    return select(vec3f(0.0), normal / max(growth, 1e-20), growth > 0.1 * step);
}

fn shell(lens: u32, paint: vec4f, pixel: vec2i, color: vec4f) -> vec4f {
    let ray = ray_of_pixel(vec2f(pixel) + 0.5);
    let ends = lens_ends(lens, pixel, ray);
    let depth = textureLoad(scene_depth, pixel, 0);
    // A wall or the ground in a lens' face hides it, however its depth is rounded.
    let shown = select(FAR_AWAY, distance_of_depth(depth), depth > 0.0) * (1.0 - 2e-5);
    var seen = paint;
    if ends.enter > ends.exit {
        return seen;
    }
    let nearest = select(0.0, -FAR_AWAY, view.orthographic == 1u);
    // The far side first; it is not seen where it has no end.
    for (var side = 0; side < 2; side++) {
        let is_far = side == 0;
        let t = number_as_is(select(ends.enter, ends.exit, is_far));
        if t > nearest && t < shown && t < 0.5 * FAR_AWAY {
            let outwards = as_is(lens_normal(lens, pixel, ray, t));
            let most = number_as_is(select(1.0, 0.5, is_far) * color.a);
            seen = paint_as_is(glazed(seen, select(outwards, -outwards, is_far), ray, color.rgb, most));
        }
    }
    return seen;
}
