// Where a ray meets a lens of the invoker table first and last.
fn lens_ends(lens: u32, pixel: vec2i, ray: Ray) -> Span {
    let by = invoker(lens);
    var ends = EMPTY_SPAN;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        ends = with_span(ends, ends_of_volume(v, pixel, ray));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return ends;
}
