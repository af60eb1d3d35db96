// Where rays leave a combination, or enter it, for its sections: at an end of one of its leaves, where they all have closed forms.

fn end_by_leaves(s: Combination, ray: Ray) -> f32 {
    find_spans(s, ray);
    let leaves = stage.leaves == 1u;
    var last = 0.0;
    for (var turn = 0u; turn <= stage.turn; turn += 1u) {
        var next = FAR_AWAY;
        for (var end = 0u; end < 2u * s.count; end += 1u) {
            let own = spans[end / 2u];
            let t = select(own.enter, own.exit, end % 2u == 1u);
            let before = is_within(s, ray, t, false, NO_LEAF, false);
            let after = is_within(s, ray, t, true, NO_LEAF, false);
            let is_next = own.enter < own.exit && t > last && before == leaves && after != leaves;
            next = select(next, min(next, t), is_next);
        }
        last = next;
    }
    return select(0.0, last, last < FAR_AWAY);
}

fn end_of_combined(s: Combination, ray: Ray, pixel: vec2i, whole: Span) -> f32 {
    if stage.has_forms == 1u {
        return end_by_leaves(s, ray);
    }
    return end_by_steps(ray, pixel, whole);
}
