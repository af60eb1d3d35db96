// Membership by object, of thematic lenses: what belongs to chosen objects is inside, wherever it is; the rest is *rest*.

fn inside_members(s: Shape, sight: Sight) -> u32 {
    return select(MISSED, INSIDE, sight.distance < FAR_AWAY && is_chosen(u32(s.size_x), sight.object));
}
