// Soft borders of lenses: the degree of interest by how far a place is from a lens. Twin: `veduta::lens::border`.

fn degree_of_interest(distance: f32, border: vec4f, sight: Sight) -> f32 {
    if border.w > 0.5 {
        return select(0.0, 1.0, distance <= 0.5 * border.x);
    }
    let width = max(border_width(border, sight), 1e-30);
    let t = clamp(0.5 - number_as_is(distance) / width, 0.0, 1.0);
    return number_as_is(t * t * (3.0 - 2.0 * t));
}

// How far a place is along its ray from where that enters or leaves a volume. A perspective ray starts at the eye: in a
// volume that holds the eye it begins there.
fn distance_to_ends(ends: Span, sight: Sight) -> f32 {
    let is_met = ends.enter <= ends.exit && (sight.is_parallel || ends.exit > 0.0);
    let enter = select(max(ends.enter, 0.0), ends.enter, sight.is_parallel);
    let away = min(abs(sight.distance - enter), abs(sight.distance - ends.exit));
    return select(FAR_AWAY, away, is_met && sight.distance < FAR_AWAY);
}

// The share of a class that a place has. Inside of a volume one of the sides is named, too: so that inside and outside share what
// there is.
fn share_inside(classes: u32, interest: f32) -> f32 {
    return interest;
}

fn share_front(classes: u32, interest: f32) -> f32 {
    return select(0.0, 1.0 - interest, (classes & (FRONT | BEHIND)) == FRONT);
}

fn share_behind(classes: u32, interest: f32) -> f32 {
    return select(0.0, 1.0 - interest, (classes & (FRONT | BEHIND)) == BEHIND);
}

fn share_rest(classes: u32, interest: f32) -> f32 {
    let sides = classes & (FRONT | BEHIND);
    return select(0.0, 1.0 - interest, sides == 0u || sides == (FRONT | BEHIND));
}

// Whether something that is there or not is there, of a share.
fn is_dithered(share: f32, pixel: vec2i) -> bool {
    return share > dither(pixel, view.sample_index);
}
