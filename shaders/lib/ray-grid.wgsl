// Grids over lenses that bend rays: lines that are straight and equally far apart without the lens, on what it shows; in a fisheye of equal angles.

// Angle between the lines of a fisheye, radians: 15 degrees.
const GRID_ANGLE: f32 = 0.2617994;
const GRID_OPACITY: f32 = 0.55;

// Where a pixel is in a grid, in steps of it.
fn grid_place(lens: u32, pixel: vec2f) -> vec2f {
    let distance = min(seen_distance, 1e9);
    let ray = bent_ray(across_of_pixel(pixel), distance);
    let at = ray.origin.xy + distance * ray.direction.xy;
    let flat = (select(at / distance, at, view.orthographic == 1u) - ray_lens(lens).center) / ray_lens(lens).grid;
    let d = ray.direction;
    let round = vec2f(atan2(d.x, -d.z), atan2(d.y, length(d.xz))) / GRID_ANGLE;
    let kind = ray_lens(lens).kind;
    return select(flat, round, (kind >= RAY_ANGULAR) & ((kind != RAY_OWN) | (d.z != -1.0)));
}

// How much of a pixel lines cover, along one axis; `turn`: how far the next pixels are in it.
fn line_share(at: f32, turn: vec2f) -> f32 {
    let width = length(turn);
    let away = abs(fract(at + 0.5) - 0.5);
    let share = clamp(1.0 - away / max(width, 1e-9), 0.0, 1.0);
    // Lines that are nearer to each other than a few pixels are none.
    return share * clamp(2.0 - 6.0 * width, 0.0, 1.0);
}

// With the grid of the topmost lens that has one there.
fn gridded(paint: vec4f, pixel: vec2i) -> vec4f {
    let at = vec2f(pixel) + 0.5;
    let across = across_of_pixel(at);
    var seen = paint;
    for (var lens = 0u; lens < RAY_IMAGES + RAY_PLANES; lens++) {
        let own = ray_lens(lens);
        if rim_share(lens, across) < 1.0 && own.grid > 0.0 {
            let here = grid_place(lens, at);
            let right = grid_place(lens, at + vec2f(1.0, 0.0)) - here;
            let below = grid_place(lens, at + vec2f(0.0, 1.0)) - here;
            let share = max(line_share(here.x, vec2f(right.x, below.x)), line_share(here.y, vec2f(right.y, below.y)));
            seen = over_grid(seen, share, vec4f(own.color, GRID_OPACITY));
        }
    }
    return seen;
}

fn over_grid(paint: vec4f, share: f32, color: vec4f) -> vec4f {
    let opacity = color.a * share;
    return vec4f(mix(paint.rgb, color.rgb, opacity), paint.a + (1.0 - paint.a) * opacity);
}
