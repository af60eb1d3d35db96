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
            if own.enter < own.exit && t > last && t < next {
                let is_in = around(s, ray, t, NO_LEAF, false);
                next = select(next, t, is_in.before == leaves && is_in.after != leaves);
            }
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
