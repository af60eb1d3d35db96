// Whether a pixel is clear of the silhouette of a volume: all pixels within `reach` of it, along both axes, surely meet the volume, or none
// does. False where that is not known. Rays of pixels go through a plane at distance 1, so from one to the next they turn by no more than a
// pixel's width there.
fn is_clear_of_form(s: Region, form: u32, pixel: vec2i, reach: i32) -> bool {
    let width = max(abs(view.across_from_pixel.x), abs(view.across_from_pixel.y));
    let turn = 1.4143 * f32(reach) * width * most_stretch(vec2f(pixel) + 0.5, f32(reach), -s.a.z);
    return form_is_clear(ray_at_distance(vec2f(pixel) + 0.5, -s.a.z), s, form, turn);
}
