// The eye. View space: x right, y up, -z forward; D = -z is the distance along the view axis, metres.
//
// Positions reach the shader as whole metres (i32, exact) plus an f32 offset; the eye likewise, so a
// position relative to the eye is right to 2^-23 of (distance + tile), however far the city is from
// the origin of its coordinates.

struct View {
    view_from_world: mat3x3f,   // rotation only
    projection: vec4f,          // scale x, y; offset x, y (sub-pixel jitter and picture tiles included)
    across_from_pixel: vec4f,   // the inverse, from pixels: scale x, y; offset x, y of the picture plane at distance 1
    near: f32,                  // metres
    far: f32,                   // metres; used by orthographic views only
    orthographic: u32,          // 0 perspective, 1 orthographic
    sample_index: u32,          // which sample of the picture this is, from 0
    eye_whole: vec3i,           // metres
    first_pixel: u32,           // of the picture, that is the target's first: x, and y in the upper 16 bits
    eye_fraction: vec3f,        // metres, -0.5..0.5
    size: vec2f,                // of the target, pixels
    haze: f32,                  // 1 / metres; 0 = none
}

// A world position relative to the eye, world axes.
fn relative_to_eye(whole: vec3i, offset: vec3f) -> vec3f {
    return (vec3f(whole - view.eye_whole) - view.eye_fraction) + offset;
}

fn clip_from_relative(relative: vec3f) -> vec4f {
    let p = view.view_from_world * relative;
    let distance = -p.z;
    let is_flat = view.orthographic == 1u;
    let w = select(distance, 1.0, is_flat);
    let z = select(view.near, (view.far - distance) / (view.far - view.near), is_flat);
    return vec4f(p.xy * view.projection.xy + view.projection.zw * w, z, w);
}

// How far from their places corners are drawn at most, pixels: it says what adapter this is for.
//@snapping

// "For ever": beyond any city, far below f32's overflow.
const FAR_AWAY: f32 = 1e30;

// A pixel's ray: the points origin + D * direction, in view space.
struct Ray {
    origin: vec3f,
    direction: vec3f,           // z = -1
}

// Along which ray a pixel looks: handlers say so (shaders/effect).
//@ray

// Stored depth of distance D: reversed, 1 at the near plane, 0 at the far end.
fn depth_of_distance(distance: f32) -> f32 {
    return clamp(select(view.near / distance, (view.far - distance) / (view.far - view.near), view.orthographic == 1u), 0.0, 1.0);
}

// Distance of a stored depth, which must not be 0 (nothing there).
fn distance_of_depth(depth: f32) -> f32 {
    return select(view.near / depth, view.far - depth * (view.far - view.near), view.orthographic == 1u);
}
