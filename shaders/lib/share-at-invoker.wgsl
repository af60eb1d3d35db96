// Share of an invoker at the place that is shaded, 0 to 1.
fn share_at(by: Invoker, classes: Classes) -> f32 {
    if by.scope == 0u || by.border == 0u {
        return select(0.0, 1.0, runs(by, classes));
    }
    return share_of(by, classes_of(by, classes), classes.sight);
}
