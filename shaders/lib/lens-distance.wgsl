// Distance of a place from a lens of the invoker table, metres, negative inside.
fn lens_distance(lens: u32, sight: Sight) -> f32 {
    let by = invoker(lens);
    var distance = FAR_AWAY;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        distance = min(distance, distance_to(v, sight, vec4f(0.0)));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return distance;
}
