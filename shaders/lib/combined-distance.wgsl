// How far a place is from a combination: what it is from its leaves, joined as they are. It is exact where only one of them
// is near, and never more than it is. `distance_to_leaf` knows the kinds of leaves that a module needs.

var<private> distances: array<f32, 33>;

fn distance_to_combined(s: Combination, sight: Sight, border: vec4f) -> f32 {
    var top = 0u;
    for (var i = 0u; i < s.count; i++) {
        let leaf = leaf_at(s, i);
        distances[top] = distance_to_leaf(leaf, sight, border);
        top += 1u;
        for (var left = leaf.operations; left != 0u; left >>= 2u) {
            let above = distances[top - 1u];
            let below = distances[top - 2u];
            let operation = left & 3u;
            let joined = select(select(max(below, -above), max(below, above), operation == INTERSECTION), min(below, above),
                                operation == UNION);
            top -= 1u;
            distances[top - 1u] = joined;
        }
    }
    return distances[0];
}
