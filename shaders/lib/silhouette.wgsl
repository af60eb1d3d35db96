// How much of the pixel a line of `width` pixels along the silhouette of a lens covers: by the nearest pixel of
// the other state. `is_convex`: the lens is one convex body, and so is what it covers: where four corners are covered, all between
// them is.
fn silhouette(lens: u32, pixel: vec2i, width: f32, is_convex: bool) -> f32 {
    // What is farther away adds nothing.
    let reach = i32(ceil(0.5 * width + 1.0)) - 1;
    if lens_is_sure(lens, pixel, reach) {
        return 0.0;
    }
    let last = vec2i(view.size) - 1;
    let here = lens_covers(lens, pixel);
    if is_convex && here {
        let low = max(pixel - reach, vec2i(0));
        let high = min(pixel + reach, last);
        if lens_covers(lens, low) && lens_covers(lens, high) && lens_covers(lens, vec2i(low.x, high.y))
            && lens_covers(lens, vec2i(high.x, low.y)) {
            return 0.0;
        }
    }
    var nearest = 1e9;
    for (var j = -reach; j <= reach; j++) {
        for (var i = -reach; i <= reach; i++) {
            let other = clamp(pixel + vec2i(i, j), vec2i(0), last);
            if (i != 0 || j != 0) && lens_covers(lens, other) != here {
                nearest = min(nearest, length(vec2f(f32(i), f32(j))));
            }
        }
    }
    return clamp(0.5 * width + 1.0 - nearest, 0.0, 1.0);
}
