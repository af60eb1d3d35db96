// How much of the pixel a line of `width` pixels along the silhouette of a lens covers: by the nearest pixel of
// the other state. `is_convex`: the lens is one convex body, and so is what it covers: where four corners are covered, all between
// them is. Questions are asked in loops: software adapters leave out nothing but rounds of these.
fn silhouette(lens: u32, pixel: vec2i, width: f32, is_convex: bool) -> f32 {
    // What is farther away adds nothing.
    let reach = i32(ceil(0.5 * width + 1.0)) - 1;
    if lens_is_clear(lens, pixel, reach) {
        return 0.0;
    }
    let last = vec2i(view.size) - 1;
    var here = false;
    var nearest = 1e9;
    // The pixel itself and the corners around it.
    for (var k = 0u; ; k++) {
        let corner = 2 * vec2i(vec2u(k - 1u) >> vec2u(0u, 1u) & vec2u(1u)) - 1;
        let away = select(reach * corner, vec2i(0), k == 0u);
        let is_covered = lens_covers(lens, clamp(pixel + away, vec2i(0), last));
        here = select(here, is_covered, k == 0u);
        nearest = select(nearest, min(nearest, length(vec2f(away))), is_covered != here);
        if k == 4u {
            break;
        }
    }
    if is_convex && here && nearest == 1e9 {
        return 0.0;
    }
    for (var j = -reach; j <= reach; j++) {
        for (var i = -reach; i <= reach; i++) {
            let is_asked = (i == 0 && j == 0) || (abs(i) == reach && abs(j) == reach);
            let other = clamp(pixel + vec2i(i, j), vec2i(0), last);
            if !is_asked && lens_covers(lens, other) != here {
                nearest = min(nearest, length(vec2f(f32(i), f32(j))));
            }
        }
    }
    return clamp(0.5 * width + 1.0 - nearest, 0.0, 1.0);
}
