// Classes of a combination in the picture: inside by its leaves, the sides of what is not by its sprite.

fn class_in_combined(s: Combination, place: SpritePlace, sight: Sight) -> u32 {
    return side_by_sprite(place, sight, inside_combined(s, sight) == INSIDE);
}
