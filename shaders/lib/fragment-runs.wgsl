// Whether an invoker runs at a fragment, by the fragment's own depth.
fn runs(by: Invoker, fragment: Fragment) -> bool {
    if by.scope == 0u {
        return true;
    }
    var all = MISSED;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        all |= class_of(v, sight_of(fragment));
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    switch by.scope {
        case 1u: { return is_inside(all); }
        case 2u: { return is_in_front(all); }
        case 3u: { return is_behind(all); }
        default: { return is_rest(all); }
    }
}
