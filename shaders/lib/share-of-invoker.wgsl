// Share of an invoker at a place with these classes, 0 to 1, where lenses have soft borders.
fn share_of(by: Invoker, all: u32, sight: Sight) -> f32 {
    if by.border == 0u {
        return 1.0;
    }
    let border = parameters[by.border - 1u];
    var distance = FAR_AWAY;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        distance = min(distance, distance_to(v, sight, border));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    let interest = degree_of_interest(distance, border, sight);
    switch by.scope {
        case 1u: { return share_inside(all, interest); }
        case 2u: { return share_front(all, interest); }
        case 3u: { return share_behind(all, interest); }
        default: { return share_rest(all, interest); }
    }
}
