// Whether a lens of the invoker table covers a pixel.
fn lens_covers(lens: u32, pixel: vec2i) -> bool {
    let by = invoker(lens);
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        if volume_covers(v, pixel) {
            return true;
        }
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return false;
}
