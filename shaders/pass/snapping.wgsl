// How far a rasteriser moves the corners of triangles: cells of 4 x 4 pixels, each with a triangle of one and the same sloped plane, whose
// corners stand a little further each time. Where they are moved, the depth in the middle is that of another plane.

// Cells in a row, and rows.
const CELLS: u32 = 64u;

// The rows and columns of cells as the picture has them.
fn in_picture(cell: u32, at: vec2f, depth: f32) -> vec4f {
    let pixel = 4.0 * vec2f(f32(cell % CELLS), f32(cell / CELLS)) + at;
    let half = 2.0 * f32(CELLS);
    return vec4f(pixel.x / half - 1.0, 1.0 - pixel.y / half, depth, 1.0);
}

// A triangle that is 1/1024 pixel wide, which stands about the middle of pixel (1, 1): its depths are 0.5 on the left and 0.25 on the right.
@vertex
fn sliver(@builtin(vertex_index) corner: u32, @builtin(instance_index) cell: u32) -> @builtin(position) @invariant vec4f {
    var corners = array<vec2f, 3>(vec2f(0.0, 0.25), vec2f(1.0, 1.5), vec2f(0.0, 3.0));
    let left = 1.375 + f32(cell) / 16384.0;
    let at = vec2f(left + corners[corner].x / 1024.0, corners[corner].y);
    return in_picture(cell, at, 0.5 - 0.25 * corners[corner].x);
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) cell: u32) -> @builtin(position) @invariant vec4f {
    var corners = array<vec2f, 3>(vec2f(0.25, 0.25), vec2f(3.5, 0.5), vec2f(0.5, 3.5));
    // Steps of 2^-14 pixels, a fourth of a pixel in all: exact in f32, as all that follows is.
    let at = corners[corner] + f32(cell) / 16384.0;
    let is_along_y = cell % 2u == 1u;
    let depth = 0.125 + select(at.x, at.y, is_along_y) / 16.0;
    return in_picture(cell, at, depth);
}
