// Classes of a place with regard to the lens of an invoker, and whether the invoker runs there; `class_of` is of the scene.
struct Classes {
    part: u32,
    sight: Sight,
}

fn classes_at(sight: Sight, part: u32) -> Classes {
    return Classes(part, sight);
}

fn tile_of(classes: Classes) -> u32 {
    let at = vec2u(classes.sight.pixel) / TILE_PX;
    return select(1u + at.y * table.tiles.x + at.x, 0u, classes.part == 0u);
}

fn classes_of(by: Invoker, classes: Classes) -> u32 {
    var all = MISSED;
    for (var v = by.first_volume; v < by.first_volume + by.volumes; v++) {
        all |= class_of(v, classes.sight);
        if v + 1u == by.first_volume + by.volumes {
            break;
        }
    }
    return all;
}

fn runs(by: Invoker, classes: Classes) -> bool {
    if by.scope == 0u {
        return true;
    }
    let all = classes_of(by, classes);
    switch by.scope {
        case 1u: { return is_inside(all); }
        case 2u: { return is_in_front(all); }
        case 3u: { return is_behind(all); }
        default: { return is_rest(all); }
    }
}
