// The volumetric depth test, on the sprites of lenses. A texel has layers, each an entry and an exit, ascending along the
// ray; an exit at the nearest code says that there are no more.

@group(2) @binding(10) var<storage, read> sprites: array<u32>;

// ---- one layer, stored as the depth target stores depth: no distance is worked out

// Twin: `veduta::lens::classify`. Stored depths fall with distance: every comparison of distances is turned round. An entry of 1 says
// that the eye is inside; a depth of 0, that nothing is there; an exit of 0, that there is none.
fn classify(depth: f32, entry: f32, exit: f32) -> u32 {
    return select(select(BEHIND, INSIDE, depth > exit || exit == 0.0), FRONT, depth > entry);
}

fn ends_in_sprite(s: SpritePlace, pixel: vec2i) -> vec2f {
    let at = vec2u(sprite_texel(s, pixel));
    let word = s.first + 2u * (at.y * s.width + at.x);
    return bitcast<vec2f>(vec2u(sprites[word], sprites[word + 1u]));
}

// Exits hold 1 where the ray misses the volume.
fn covers_sprite(s: SpritePlace, pixel: vec2i) -> bool {
    return is_in_bounds(s, pixel) && ends_in_sprite(s, pixel).y != 1.0;
}

fn class_in_sprite(s: SpritePlace, sight: Sight) -> u32 {
    let ends = ends_in_sprite(s, sight.pixel);
    let class_here = select(MISSED, classify(sight.depth, ends.x, ends.y), ends.y != 1.0);
    return select(MISSED, class_here, is_in_bounds(s, sight.pixel));
}

// ---- any format, mapping and number of layers: codes become metres again

fn sprite_code(s: SpritePlace, number: u32, format: u32) -> u32 {
    switch format {
        case UNORM8: { return sprites[s.first + number / 4u] >> (8u * (number % 4u)) & 0xffu; }
        case UNORM16, FLOAT16: { return sprites[s.first + number / 2u] >> (16u * (number % 2u)) & 0xffffu; }
        default: { return sprites[s.first + number]; }
    }
}

fn class_at_texel(s: SpritePlace, at: vec2u, distance: f32) -> u32 {
    let code = DepthCode(s.kind, s.near, s.far);
    let nearest = nearest_code(code);
    let farthest = farthest_code(code);
    let format = format_of(code);
    var classes = MISSED;
    for (var layer = 0u; layer < s.layers; layer++) {
        let number = 2u * ((at.y * s.width + at.x) * s.layers + layer);
        let entry = sprite_code(s, number, format);
        let exit = sprite_code(s, number + 1u, format);
        if exit == nearest {
            break;
        }
        if entry != nearest && distance < distance_of(code, entry) {
            return classes | FRONT;
        }
        if exit == farthest || distance < distance_of(code, exit) {
            return INSIDE;
        }
        classes = BEHIND;
    }
    return classes;
}

fn class_in_layers(s: SpritePlace, sight: Sight) -> u32 {
    if !is_in_bounds(s, sight.pixel) {
        return MISSED;
    }
    return class_at_texel(s, vec2u(sprite_texel(s, sight.pixel)), sight.distance);
}

fn covers_layers(s: SpritePlace, pixel: vec2i) -> bool {
    let code = DepthCode(s.kind, s.near, s.far);
    let at = vec2u(sprite_texel(s, pixel));
    let number = 2u * (at.y * s.width + at.x) * s.layers + 1u;
    return is_in_bounds(s, pixel) && sprite_code(s, number, format_of(code)) != nearest_code(code);
}
