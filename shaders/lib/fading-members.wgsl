// Membership by object (L3) where members come or go over time (O6): the values are weights, 0 to 1. What belongs to an object is
// inside where its weight is above the threshold of the pixel, so that whatever the lens does or shows comes in by a pattern, and
// what is inside in one pass is outside in none. Twin of the thresholds: `veduta::lens::dither`.

fn is_fading_member(first: u32, object: u32, pixel: vec2i) -> bool {
    return bitcast<f32>(object_values[first + (object + 1u)]) > dither(pixel, view.sample_index);
}

fn inside_fading_members(s: Shape, sight: Sight) -> u32 {
    let is_in = sight.distance < FAR_AWAY && is_fading_member(u32(s.size_x), sight.object, sight.pixel);
    return select(MISSED, INSIDE, is_in);
}
