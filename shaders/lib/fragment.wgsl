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
