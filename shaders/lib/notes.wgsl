// Where what is noted of translucent fragments is kept, as words: of as many notes as there is `room` for, first the depth and
// the number of each, side by side; then of each the next in its list; then, where the picture has them, a normal of each, and
// last a colour of each. A software adapter fetches words for one pixel after the other, two side by side as fast as one.

// A note, and what it is sorted by: depth, number, and of those that are alike in both what tells them apart.
alias Note = vec4u;             // bits of the stored depth: the larger, the nearer, 0: none; surface + 1; normal; colour

fn key_place(note: u32) -> u32 {
    return 2u * note;
}

fn link_place(room: u32, note: u32) -> u32 {
    return 2u * room + note;
}

fn normal_place(room: u32, note: u32) -> u32 {
    return 3u * room + note;
}

// `words`: of a note.
fn color_place(room: u32, note: u32, words: u32) -> u32 {
    return (words - 1u) * room + note;
}
