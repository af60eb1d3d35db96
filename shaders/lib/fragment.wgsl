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
    is_parallel: bool,          // whether the main view's rays are: it is orthographic
}

@group(2) @binding(1) var<storage, read> object_values: array<u32>;

// Whether an object is one of those that an effect chose by an attribute; `first`: its parameter of this name. The values
// begin with that of no object.
fn is_chosen(first: u32, object: u32) -> bool {
    return object_values[first + (object + 1u)] != 0u;
}

fn part_of(surface: Surface) -> u32 {
    return (surface.flags & SURFACE_PART) >> SURFACE_PART_SHIFT;
}
