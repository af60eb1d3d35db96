// Whether a pixel is clear of the silhouettes of a lens of the invoker table.
fn lens_is_clear(lens: u32, pixel: vec2i, reach: i32) -> bool {
    let by = invoker(lens);
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        if !volume_is_clear(v, pixel, reach) {
            return false;
        }
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return true;
}
