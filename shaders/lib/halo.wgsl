// A glow around the silhouette of a lens: how close its ray comes to it, in pixels, found by going along the ray by what is
// free around each place (Hart 1996). What is told of that is no more than twice the width of the glow where more is free: such steps are
// cheap, and many.

fn halo(lens: u32, paint: vec4f, pixel: vec2i, color: vec4f, width: f32) -> vec4f {
    if lens_covers(lens, pixel) {
        return paint;
    }
    let ray = ray_of_pixel(vec2f(pixel) + 0.5);
    let speed = length(ray.direction);
    let is_parallel = view.orthographic == 1u;
    let per_distance = abs(view.across_from_pixel.y);
    var closest = 1e9;
    var t = view.near;
    // No distance grows by more than one goes: from a place whose distance is known, less is asked of the next one, and less is looked at.
    var most = 1e9;
    for (var i = 0; i < 128; i++) {
        let position = as_is(ray.origin + t * ray.direction);
        let metres_per_pixel = per_distance * select(t, 1.0, is_parallel);
        let sight = Sight(pixel, 0.0, ray, t, position, is_parallel, NO_OBJECT, 0.0);
        let reach = min(2.0 * width * metres_per_pixel, most);
        let free = number_as_is(lens_distance(lens, sight, reach));
        most = select(1e9, 2.01 * max(free, 1e-4 * t), free < reach);
        closest = min(closest, free / metres_per_pixel);
        if free <= 0.0 || free > 1e9 {
            break;
        }
        t += max(free, 1e-4 * t) / speed;
    }
    // On the silhouette itself it is as strong as a line.
    let share = clamp(1.0 - closest / width, 0.0, 1.0);
    let opacity = color.a * share * share;
    return vec4f(mix(paint.rgb, color.rgb, opacity), paint.a + (1.0 - paint.a) * opacity);
}
