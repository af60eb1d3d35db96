// The width of a soft border where it is asked for, metres.

// The parameters of a border: x the width, y 1 where that is in pixels, z 1 where what cannot be had by halves is dithered, w 1 where
// distances are along the ray.
fn border_width(border: vec4f, sight: Sight) -> f32 {
    let metres_per_pixel = abs(view.across_from_pixel.y) * select(max(sight.distance, 0.0), 1.0, sight.is_parallel);
    return border.x * select(1.0, metres_per_pixel, border.y > 0.5);
}
