// Classes of a solid in the picture: inside by its faces, the sides of what is not by a sprite as coarse as V's: where each ray
// enters first and leaves last.

@group(2) @binding(0) var side_sprites: texture_2d_array<f32>;    // stored depth of the entry, and of the exit

// Exits hold 1, their clear value, where the ray misses the volume.
fn covers_sides(place: SpritePlace, pixel: vec2i) -> bool {
    return is_in_bounds(place, pixel) && textureLoad(side_sprites, sprite_texel(place, pixel), place.page, 0).y != 1.0;
}

fn side_by_sprite(place: SpritePlace, sight: Sight, is_in: bool) -> u32 {
    let ends = textureLoad(side_sprites, sprite_texel(place, sight.pixel), place.page, 0).xy;
    let is_missed = ends.y == 1.0 || !is_in_bounds(place, sight.pixel);
    let side = side_of_solid(is_missed, ends.x > 0.0 && sight.depth > ends.x, sight.depth <= ends.y);
    // Stored depths fall with distance. Of what the eye is inside of there is no front.
    let nearer = select(BEHIND, FRONT, ends.x > 0.0 && ends.x - sight.depth < sight.depth - ends.y);
    return select(side, INSIDE | nearer, is_in);
}

fn class_in_solid(s: Solid, place: SpritePlace, sight: Sight) -> u32 {
    return side_by_sprite(place, sight, inside_solid(s, sight) == INSIDE);
}
