// Where the depth sprites of the lens volumes in view stand that have one.

struct SpritePlace {
    @align(16) origin: vec2i,   // of its screen bounds, pixels
    size: vec2i,
    texels_per_pixel: vec2f,    // sprite against target
    sprite: vec2f,              // texel that stands for the picture's corner, where the sprite is kept
    page: u32,                  // of the sides of a solid
    first: u32,                 // of a lens' sprite: its first word
    width: u32,                 // and the texels of its rows
    layers: u32,
    kind: u32,                  // its depth code
    near: f32,
    far: f32,
    own: u32,
}

fn is_in_bounds(s: SpritePlace, pixel: vec2i) -> bool {
    return all(pixel >= s.origin) && all(pixel < s.origin + s.size);
}

fn sprite_texel(s: SpritePlace, pixel: vec2i) -> vec2i {
    // Of the whole picture's pixel: the texel is the same in whatever tile it is drawn.
    let at = vec2u(pixel) + vec2u(view.first_pixel & 0xffffu, view.first_pixel >> 16u);
    return vec2i((vec2f(at) + 0.5) * s.texels_per_pixel + s.sprite);
}
