//! The list of faults that `./dev faults` plants fits the tree that it is in.

use std::path::Path;

#[path = "../faults/list.rs"]
mod list;

#[test]
fn each_fault_has_one_place() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let all = list::read(root).unwrap_or_else(|error| panic!("{error}"));
    assert!(all.len() > 10, "{} faults", all.len());
    for fault in &all {
        let text =
            std::fs::read_to_string(root.join(&fault.file)).unwrap_or_else(|error| panic!("{}: {error}", fault.name));
        let planted = fault.planted(&text).unwrap_or_else(|error| panic!("{error}"));
        assert_ne!(planted, text, "{}", fault.name);
        assert!(fault.tests.len() > 1, "{} names a target and tests", fault.name);
    }
}
