// Distance of a place from a lens of the invoker table, metres, negative inside; where it is more than `reach`, that or more.
fn lens_distance(lens: u32, sight: Sight, reach: f32) -> f32 {
    let by = invoker(lens);
    var distance = FAR_AWAY;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        distance = min(distance, distance_to(v, sight, vec4f(2.0 * reach, 0.0, 0.0, 0.0)));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return distance;
}
