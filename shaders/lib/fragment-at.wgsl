// Fragments of the city where they are drawn, or met by a ray.

// The fragment at a place of the target.
fn fragment_at(at: vec2f, depth: f32, code: u32) -> Fragment {
    see_object(surface_at(code - 1u).object);
    see_pixel(at, distance_of_depth(depth));
    return fragment_on(ray_of_pixel(at), at, depth, code);
}

// The same on a ray.
fn fragment_on(ray: Ray, at: vec2f, depth: f32, code: u32) -> Fragment {
    let distance = distance_of_depth(depth);
    let position = ray.origin + distance * ray.direction;
    let up = view.view_from_world[2];       // dot(column, p) = p's share of the world's z
    let height = f32(view.eye_whole.z) + view.eye_fraction.z + dot(up, position);
    let surface = surface_at(code - 1u);
    return Fragment(vec2i(at), depth, position, height, code - 1u, surface.object, part_of(surface),
                    decode_normal(surface.normal), ray, view.orthographic == 1u, city_number(),
                    dither(vec2i(at), view.sample_index), off_face(distance), texel_opacity * opacity_of(surface));
}
