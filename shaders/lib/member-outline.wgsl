// The silhouette of a thematic lens is that of what is seen of its objects.

fn covers_members(s: Members, pixel: vec2i) -> bool {
    let code = textureLoad(codes, pixel, 0).x;
    return code != 0u && is_chosen(s.first, surface_shown(code - 1u).object);
}
