fn runs(by: Invoker, fragment: Fragment) -> bool {
    return by.scope == 0u;
}
