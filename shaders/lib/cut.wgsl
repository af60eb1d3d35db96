// Taking away what lenses hide of the picture.

// Takes the fragment away if it is hidden.
fn cut(at: vec2f, depth: f32, code: u32) {
    let ray = ray_of_pixel(at);
    let position = ray.origin + distance_of_depth(depth) * ray.direction;
    let up = view.view_from_world[2];       // dot(column, p) = p's share of the world's z
    let height = f32(view.eye_whole.z) + view.eye_fraction.z + dot(up, position);
    let surface = surface_at(code - 1u);
    let fragment = Fragment(vec2i(at), depth, position, height, code - 1u, surface.object, part_of(surface),
                            decode_normal(surface.normal), ray, view.orthographic == 1u, city_number());
    if !visible(fragment) {
        discard;
    }
}
