// Classes where no lens is in the scene: an invoker runs everywhere, or it is not of this part of the picture.
struct Classes {
    part: u32,
}

fn classes_at(sight: Sight, part: u32) -> Classes {
    return Classes(part);
}

fn tile_of(classes: Classes) -> u32 {
    return 0u;
}

fn runs(by: Invoker, classes: Classes) -> bool {
    return by.scope == 0u;
}
