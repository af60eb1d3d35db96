// A fragment of the city before it is known whether it is seen: what hiding effects decide by.

struct Fragment {
    pixel: vec2i,
    depth: f32,                 // as the depth target stores it
    position: vec3f,            // in the main view's space, metres
    height: f32,                // z in the model's coordinates, metres
    surface: u32,
    object: u32,                // or NO_OBJECT
    part: u32,                  // PART_*
    normal: vec3f,              // unit, of its face
    ray: Ray,                   // of the main view, through it
    is_parallel: bool,          // whether the main view's rays are: it is orthographic
    city: u32,                  // which of the cities that are drawn: 0 the scene's own, else a content of lenses
    threshold: f32,             // what a share must be above to be there, 0..1; of what only the sun sees the half
    off: f32,                   // how far the place may be beside its face, metres
    opacity: f32,               // of its material and texture, 0..1
}

fn sight_of(fragment: Fragment) -> Sight {
    return Sight(fragment.pixel, fragment.depth, fragment.ray, distance_of_depth(fragment.depth), fragment.position, fragment.is_parallel,
                 fragment.object, fragment.off);
}

// The fragment at a place of the target.
fn fragment_at(at: vec2f, depth: f32, code: u32) -> Fragment {
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
