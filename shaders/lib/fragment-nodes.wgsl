// Fragment nodes of translucent layers (an A-buffer), as words: of as many nodes as there is `room` for, first the depth and
// the number of each, side by side; then of each the next in its list; then, where the picture has them, a normal of each, and
// last a colour of each. A software adapter fetches words for one pixel after the other, two side by side as fast as one.

// A node, and what it is sorted by: depth, number, and of those that are alike in both what tells them apart.
alias FragmentNode = vec4u;     // bits of the stored depth: the larger, the nearer, 0: none; surface + 1; normal; colour

fn key_place(node: u32) -> u32 {
    return 2u * node;
}

fn link_place(room: u32, node: u32) -> u32 {
    return 2u * room + node;
}

fn normal_place(room: u32, node: u32) -> u32 {
    return 3u * room + node;
}

// `words`: of a node.
fn color_place(room: u32, node: u32, words: u32) -> u32 {
    return (words - 1u) * room + node;
}
