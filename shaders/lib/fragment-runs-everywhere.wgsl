// Whether an invoker runs at a fragment, where no lens is in the scene.
fn runs(by: Invoker, fragment: Fragment) -> bool {
    return by.scope == 0u;
}
