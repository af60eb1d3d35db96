// Storeys and windows of walls (`render::facades`): the first coordinate has 256 for each storey of the wall, and from 16 on one for each window; the
// second counts storeys from the ground.

const STOREY_STEP: f32 = 256.0;
const FIRST_BAY: f32 = 16.0;
// From where to where a window goes, along the wall and up its storey; and the line between two storeys, around where the lower one ends.
const WINDOW_ACROSS = vec2f(0.27, 0.73);
const WINDOW_UP = vec2f(0.3, 0.78);
const STOREY_LINE = vec2f(0.97, 1.03);
// What they leave of the wall's colour.
const WINDOW_SHARE: f32 = 0.6;
const LINE_SHARE: f32 = 0.86;

// The mean over a width around x of what is 1 between two places of each unit, and else 0; wide means are all the same.
fn repeated(x: f32, width: f32, ends: vec2f) -> f32 {
    let share = ends.y - ends.x;
    let wide = max(width, 1e-4);
    let low = x - 0.5 * wide - ends.x;
    let high = low + wide;
    let until_low = floor(low) * share + min(fract(low), share);
    let until_high = floor(high) * share + min(fract(high), share);
    // From half a unit on a mean still goes up and down, though nothing is to be made out any more.
    return mix((until_high - until_low) / wide, share, smoothstep(0.3, 0.6, width));
}

// What they leave of the colour at a place; `width`: how far its coordinates go within a pixel.
fn facade_at(texcoord: vec2f, width: vec2f) -> f32 {
    let storeys = floor(texcoord.x / STOREY_STEP);
    let at = vec2f(texcoord.x - STOREY_STEP * storeys - FIRST_BAY, texcoord.y);
    let soft = max(width.y, 1e-4);
    // No windows above the last storey, nor below the first.
    let within = clamp((storeys - at.y) / soft + 0.5, 0.0, 1.0) * clamp(at.y / soft + 0.5, 0.0, 1.0);
    let window = repeated(at.x, width.x, WINDOW_ACROSS) * repeated(at.y, width.y, WINDOW_UP);
    // No line on the ground.
    let lines = clamp((at.y - 0.5) / soft + 0.5, 0.0, 1.0) * clamp((storeys + 0.5 - at.y) / soft + 0.5, 0.0, 1.0);
    let line = repeated(at.y, width.y, STOREY_LINE);
    return mix(1.0, WINDOW_SHARE, window * within) * mix(1.0, LINE_SHARE, line * lines);
}
