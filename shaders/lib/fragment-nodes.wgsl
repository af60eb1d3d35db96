// Fragment nodes of translucent layers (an A-buffer), as words: of as many nodes as there is `room` for, first the depth and
// the number of each, side by side; then of each the next in its list; then, where the picture has them, a normal of each, a colour of
// each, a share of its own light of each. A software adapter fetches words for one pixel after the other, two side by side as fast as one.

// A node, and what it is sorted by: depth, number, and of those that are alike in both what tells them apart.
struct FragmentNode {
    key: vec4u,                 // bits of the stored depth: the larger, the nearer, 0: none; surface + 1; normal; colour
    light: u32,                 // share of its own light
}

fn key_place(node: u32) -> u32 {
    return 2u * node;
}

fn link_place(room: u32, node: u32) -> u32 {
    return 2u * room + node;
}

// What a node has behind three words, by the word that it is.
fn rest_place(room: u32, node: u32, word: u32) -> u32 {
    return word * room + node;
}
