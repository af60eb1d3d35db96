// How a place is seen from the main eye, in its view space: what lens tests look at.

struct Sight {
    pixel: vec2i,
    depth: f32,                 // as the depth target stores it; 0 = nothing there
    ray: Ray,                   // through it
    distance: f32,              // D, metres; FAR_AWAY where nothing is; 0 or less behind the eye
    position: vec3f,            // metres
    is_parallel: bool,          // whether all rays are: the view is orthographic
    object: u32,                // that it belongs to, or NO_OBJECT
    off: f32,                   // how far the place may be beside its face for the rasteriser's grid, metres
}

// What is drawn of corners that have been moved by some part of a pixel is off by as much along the normal of its face, metres.
fn off_face(distance: f32) -> f32 {
    if SNAPPING == 0.0 {
        return 0.0;
    }
    return SNAPPING * abs(view.across_from_pixel.y) * select(distance, 1.0, view.orthographic == 1u);
}

// With a number for a place, where nothing is shown.
fn with_place(sight: Sight) -> Sight {
    var own = sight;
    own.position = select(sight.position, vec3f(0.0), sight.distance >= FAR_AWAY);
    return own;
}

// The place that a pixel shows.
fn sight_at(pixel: vec2i, ray: Ray, depth: f32, object: u32) -> Sight {
    let distance = select(FAR_AWAY, distance_of_depth(depth), depth > 0.0);
    return Sight(pixel, depth, ray, distance, ray.origin + distance * ray.direction, view.orthographic == 1u, object,
                 off_face(distance));
}

// A value as it is, and no compiler looks through: else the sums and products of handlers that follow each other are put together in one
// program and not in another, and the last bit differs from back end to back end.
fn as_is(color: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(color) ^ vec3u(zero_when_run()));
}

fn paint_as_is(paint: vec4f) -> vec4f {
    return vec4f(as_is(paint.rgb), number_as_is(paint.a));
}

fn number_as_is(number: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(number) ^ zero_when_run());
}

// 0, which is known only where it runs.
fn zero_when_run() -> u32 {
    return view.orthographic >> 1u;
}
