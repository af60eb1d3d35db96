// The volumetric depth test (S5), on the sprites of the lens volumes in view.
//
// A point has one bit per class and lens; the bits of several volumes of one lens are ORed: inside any of
// them is inside the lens, in front only before the first, behind only after the last.

struct LensVolume {
    @align(16) origin: vec2i,   // of its screen bounds, pixels
    size: vec2i,
    texels_per_pixel: vec2f,    // sprite against target
    sprite: vec2f,              // texel that stands for the picture's corner, in the page
    page: u32,
}

@group(2) @binding(0) var sprite_entries: texture_depth_2d_array;
@group(2) @binding(1) var sprite_exits: texture_depth_2d_array;

const MISSED: u32 = 0u;
const INSIDE: u32 = 1u;
const FRONT: u32 = 2u;
const BEHIND: u32 = 4u;

// Twin: `veduta::lens::classify`. Distances in metres; `has_entry` false: the eye is inside.
fn classify(distance: f32, has_entry: bool, enter: f32, exit: f32) -> u32 {
    if has_entry && distance < enter {
        return FRONT;
    }
    if distance < exit {
        return INSIDE;
    }
    return BEHIND;
}

fn is_in_bounds(v: LensVolume, pixel: vec2i) -> bool {
    return all(pixel >= v.origin) && all(pixel < v.origin + v.size);
}

fn sprite_texel(v: LensVolume, pixel: vec2i) -> vec2i {
    return vec2i((vec2f(pixel) + 0.5) * v.texels_per_pixel + v.sprite);
}

// Exits hold 1, their clear value, where the ray misses the volume.
fn covers(v: LensVolume, pixel: vec2i) -> bool {
    return is_in_bounds(v, pixel) && textureLoad(sprite_exits, sprite_texel(v, pixel), v.page, 0) != 1.0;
}

fn class_in(v: LensVolume, pixel: vec2i, distance: f32) -> u32 {
    let texel = sprite_texel(v, pixel);
    let exit = textureLoad(sprite_exits, texel, v.page, 0);
    let entry = textureLoad(sprite_entries, texel, v.page, 0);
    let class_ = classify(distance, entry > 0.0, distance_of_depth(entry), distance_of_depth(exit));
    return select(MISSED, class_, is_in_bounds(v, pixel) && exit != 1.0);
}

fn is_inside(classes: u32) -> bool {
    return (classes & INSIDE) != 0u;
}

fn is_in_front(classes: u32) -> bool {
    return classes == FRONT;
}

fn is_behind(classes: u32) -> bool {
    return classes == BEHIND;
}

// Missed, or between two volumes.
fn is_rest(classes: u32) -> bool {
    return classes == MISSED || classes == (FRONT | BEHIND);
}
