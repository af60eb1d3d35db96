// The volumetric depth test (S5), on the sprites of the lens volumes in view that have one.

struct SpritePlace {
    @align(16) origin: vec2i,   // of its screen bounds, pixels
    size: vec2i,
    texels_per_pixel: vec2f,    // sprite against target
    sprite: vec2f,              // texel that stands for the picture's corner, in the page
    page: u32,
}

@group(2) @binding(0) var sprites: texture_2d_array<f32>;    // stored depth of the entry, and of the exit

// Twin: `veduta::lens::classify`. On stored depths, which fall with distance: every comparison of S5 is turned
// round, and none needs a division. An entry of 0 says that the eye is inside; a depth of 0, that nothing is there; an exit
// below 0, that there is none.
fn classify(depth: f32, entry: f32, exit: f32) -> u32 {
    return select(select(BEHIND, INSIDE, depth > exit), FRONT, entry > 0.0 && depth > entry);
}

fn is_in_bounds(s: SpritePlace, pixel: vec2i) -> bool {
    return all(pixel >= s.origin) && all(pixel < s.origin + s.size);
}

fn sprite_texel(s: SpritePlace, pixel: vec2i) -> vec2i {
    return vec2i((vec2f(pixel) + 0.5) * s.texels_per_pixel + s.sprite);
}

// Exits hold 1, their clear value, where the ray misses the volume.
fn covers_sprite(s: SpritePlace, pixel: vec2i) -> bool {
    return is_in_bounds(s, pixel) && textureLoad(sprites, sprite_texel(s, pixel), s.page, 0).y != 1.0;
}

fn class_in_sprite(s: SpritePlace, sight: Sight) -> u32 {
    let ends = textureLoad(sprites, sprite_texel(s, sight.pixel), s.page, 0).xy;
    let class_here = select(MISSED, classify(sight.depth, ends.x, ends.y), ends.y != 1.0);
    return select(MISSED, class_here, is_in_bounds(s, sight.pixel));
}
