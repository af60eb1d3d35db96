// The surface of a lens along a ray, by the sprite that tells its sides.

fn span_in_sides(place: SpritePlace, pixel: vec2i) -> Span {
    let ends = textureLoad(side_sprites, sprite_texel(place, pixel), place.page, 0).xy;
    if !is_in_bounds(place, pixel) || ends.y == 1.0 {
        return EMPTY_SPAN;
    }
    // No entry: the eye is inside. No exit: it has no end.
    return Span(select(-FAR_AWAY, distance_of_depth(ends.x), ends.x > 0.0),
                select(FAR_AWAY, distance_of_depth(ends.y), ends.y > 0.0));
}
