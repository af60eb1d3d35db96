// The same of members that come or go: an outline has no pattern, it is there while an object is more in than out.

fn covers_fading_members(s: FadingMembers, pixel: vec2i) -> bool {
    let code = textureLoad(codes, pixel, 0).x;
    if code == 0u {
        return false;
    }
    let at = s.first + 2u * (surface_shown(code - 1u).object + 1u);
    return bitcast<f32>(object_values[at + 1u]) - bitcast<f32>(object_values[at]) > 0.5;
}
