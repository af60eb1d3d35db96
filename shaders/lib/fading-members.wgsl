// Membership by object where members come or go over time: the values are two per object, 0 to 1. What belongs to an object is
// inside where the threshold of the pixel is at least the first and below the second, so that whatever the lens does or shows comes in by
// a pattern, and what is inside in one pass is outside in none. Twin of the thresholds: `veduta::lens::dither`.

struct FadingMembers {
    first: u32,                 // b.x: where their thresholds begin among the values of objects
}

fn is_fading_member(first: u32, object: u32, pixel: vec2i) -> bool {
    let at = first + 2u * (object + 1u);
    let threshold = dither(pixel, view.sample_index);
    return bitcast<f32>(object_values[at]) <= threshold && bitcast<f32>(object_values[at + 1u]) > threshold;
}

fn inside_fading_members(s: FadingMembers, sight: Sight) -> u32 {
    let is_in = sight.distance < FAR_AWAY && is_fading_member(s.first, sight.object, sight.pixel);
    return select(MISSED, INSIDE, is_in);
}
