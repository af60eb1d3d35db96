// Classes of a solid in the picture: inside by its faces, the sides of what is not by its sprite, which holds where each ray
// enters first and leaves last.

fn side_by_sprite(place: SpritePlace, sight: Sight, is_in: bool) -> u32 {
    let ends = textureLoad(sprites, sprite_texel(place, sight.pixel), place.page, 0).xy;
    let is_missed = ends.y == 1.0 || !is_in_bounds(place, sight.pixel);
    let side = side_of_solid(is_missed, ends.x > 0.0 && sight.depth > ends.x, sight.depth <= ends.y);
    // Stored depths fall with distance. Of what the eye is inside of there is no front.
    let nearer = select(BEHIND, FRONT, ends.x > 0.0 && ends.x - sight.depth < sight.depth - ends.y);
    return select(side, INSIDE | nearer, is_in);
}

fn class_in_solid(s: Shape, place: SpritePlace, sight: Sight) -> u32 {
    return side_by_sprite(place, sight, inside_solid(s, sight) == INSIDE);
}
