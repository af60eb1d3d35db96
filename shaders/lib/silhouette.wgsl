// How much of the pixel a line of `width` pixels along the silhouette of a lens covers: by the nearest pixel of
// the other state.
fn silhouette(lens: u32, pixel: vec2i, width: f32) -> f32 {
    let last = vec2i(view.size) - 1;
    let here = lens_covers(lens, pixel);
    let reach = i32(ceil(0.5 * width + 0.5));
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
