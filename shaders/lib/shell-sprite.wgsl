// The surface of a lens along a ray, by its stored depth sprite: the first entry and the last exit.

fn span_in_layers(s: SpritePlace, pixel: vec2i) -> Span {
    let code = DepthCode(s.kind, s.near, s.far);
    let format = format_of(code);
    var span = EMPTY_SPAN;
    if !is_in_bounds(s, pixel) {
        return span;
    }
    let at = vec2u(sprite_texel(s, pixel));
    for (var layer = 0u; layer < s.layers; layer++) {
        let number = 2u * ((at.y * s.width + at.x) * s.layers + layer);
        let entry = sprite_code(s, number, format);
        let exit = sprite_code(s, number + 1u, format);
        if exit == nearest_code(code) {
            break;
        }
        // No entry: the eye is inside. No exit: it has no end.
        if layer == 0u {
            span.enter = select(distance_of(code, entry), -FAR_AWAY, entry == nearest_code(code));
        }
        span.exit = select(distance_of(code, exit), FAR_AWAY, exit == farthest_code(code));
    }
    return span;
}
