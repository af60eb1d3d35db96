// Whether an invoker runs at a fragment. A lens whose border dithers takes fragments away one by one.
fn runs(by: Invoker, fragment: Fragment) -> bool {
    if by.scope == 0u {
        return true;
    }
    let sight = sight_of(fragment);
    var all = MISSED;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        all |= class_of(v, sight);
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    let share = share_of(by, all, sight);
    if by.border != 0u && by.kind == 2u {
        return share > 0.0;
    }
    if by.border != 0u && parameters[by.border - 1u].z > 0.5 {
        return is_dithered(share, fragment.pixel);
    }
    switch by.scope {
        case 1u: { return is_inside(all); }
        case 2u: { return is_in_front(all); }
        case 3u: { return is_behind(all); }
        default: { return is_rest(all); }
    }
}
