// Membership by object, of thematic lenses: what belongs to chosen objects is inside, wherever it is; the rest is *rest*.

struct Members {
    first: u32,                 // b.x: where their marks begin among the values of objects
}

fn inside_members(s: Members, sight: Sight) -> u32 {
    return select(MISSED, INSIDE, sight.distance < FAR_AWAY && is_chosen(s.first, sight.object));
}
