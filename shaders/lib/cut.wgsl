// Taking away what lenses hide of the picture.

// Takes the fragment away if it is hidden.
fn cut(at: vec2f, depth: f32, code: u32) {
    if !visible(fragment_at(at, depth, code)) {
        discard;
    }
}
