//! The rules on made-up sources: each is seen to find what it should, and nothing else.

use std::path::PathBuf;

use super::{
    knots,
    sizes::{self, RULES},
    source::{Module, Modules, code, functions},
};

/// Modules of these paths and sources.
fn modules(sources: &[(&str, &str)]) -> Modules {
    let module = |(name, source): &(&str, &str)| {
        let file = PathBuf::from(format!("{}.rs", name.replace("::", "/")));
        ((*name).to_owned(), Module { file, code: code(source) })
    };
    sources.iter().map(module).collect()
}

/// Seven files of a room `hall`, each of which imports the next by this text, in which `#` is the next one's number.
fn ring(import: &str, last: &str) -> Modules {
    let names: Vec<String> = (0..7).map(|at| format!("hall::f{at}")).collect();
    let sources: Vec<String> =
        (0..7).map(|at| if at == 6 { last.to_owned() } else { import.replace('#', &(at + 1).to_string()) }).collect();
    let mut all: Vec<(&str, &str)> = names.iter().map(String::as_str).zip(sources.iter().map(String::as_str)).collect();
    let children: String = (0..7).map(|at| format!("mod f{at}; pub use f{at}::F{at};")).collect();
    all.push(("hall", &children));
    modules(&all)
}

#[test]
fn a_ring_of_seven_files_is_a_knot() {
    for import in ["use crate::hall::f#::F#;", "use super::f#::{self, F#};", "fn f() { super::f#::g() }"] {
        let wrong = knots::complaints(&ring(import, &import.replace('#', "0")));
        assert_eq!(wrong.len(), 1, "{import}");
        assert!(wrong[0].starts_with("hall: 7 files"), "{}", wrong[0]);
        for file in 0..7 {
            let edge = format!("hall/f{file}.rs -> hall/f{}.rs", (file + 1) % 7);
            assert!(wrong[0].contains(&edge), "{edge} in {}", wrong[0]);
        }
    }
}

#[test]
fn a_re_export_is_an_import_of_all_it_names() {
    let wrong = knots::complaints(&ring("use crate::hall::F#;", "use crate::hall::F0;"));
    assert_eq!(wrong.len(), 1);
    assert!(wrong[0].starts_with("hall: 8 files"), "with hall.rs itself: {}", wrong[0]);
}

#[test]
fn no_knot_is_what_does_not_come_back() {
    let import = "use crate::hall::f#::F#;";
    let last = [
        "",
        "pub(super) fn f() {}",
        "pub(in crate::hall) fn f() {}",
        "// use crate::hall::f0::F0;",
        "/* use super::f0; */",
        "const T: &str = \"crate::hall::f0\";",
        "const T: &str = r#\"\" crate::hall::f0\"#;",
        "#[cfg(test)]\nmod tests {\n    use super::super::f0::F0;\n}",
        "#[cfg(test)]\nuse crate::hall::f0::F0;",
        "use crate::attic::f0::F0;",
    ];
    for last in last {
        assert_eq!(knots::complaints(&ring(import, last)), [""; 0], "{last}");
    }
    let six = ring("use crate::hall::f#::F#;", "").into_iter().filter(|(name, _)| name != "hall::f6");
    let mut six: Modules = six.collect();
    six.get_mut("hall::f5").unwrap().code = "use super::f0::F0;".to_owned();
    assert_eq!(knots::complaints(&six), [""; 0], "six may be");
}

/// What the rule of this name finds in a source.
fn found(rule: &str, room: &str, source: &str) -> usize {
    let rule = RULES.iter().find(|r| r.name.contains(rule)).unwrap();
    (rule.find)(room, &Module { file: PathBuf::new(), code: code(source) }).len()
}

#[test]
fn a_long_function_is_found() {
    let body = |lines: usize| format!("fn f(c: char) -> [u8; 2] {{\n{}}}\n", "    g('{', \"{\");\n".repeat(lines));
    assert_eq!(found("100 lines", "hall", &body(98)), 0, "100 with its first and last");
    assert_eq!(found("100 lines", "hall", &body(99)), 1);
    assert_eq!(found("100 lines", "hall", &format!("#[cfg(test)]\nmod tests {{\n{}}}", body(200))), 0);
    assert_eq!(found("100 lines", "hall", "trait T {\n    fn f();\n}\n"), 0);
}

#[test]
fn a_tuple_among_parameters_is_found() {
    let count = |source: &str| found("tuple", "hall", source);
    assert_eq!(count("fn f((a, b): (u32, u32)) {}"), 1, "a pattern");
    assert_eq!(count("fn f<F: Fn(u8) -> u8>(a: u8, ends: &(f64, Vec<(u8, u8)>)) {}"), 1, "behind a reference");
    assert_eq!(count("impl A {\n    fn f(&self, ends: (\n        u8,\n        u8,\n    )) {}\n}"), 1, "in lines");
    assert_eq!(
        count("fn f(a: [(u8, u8); 3], b: &[(u8, u8)], c: impl Fn((u8, u8)) -> (u8, u8), d: ()) {}"),
        0,
        "others"
    );
    assert_eq!(count("impl T for A {\n    fn f((a, b): (u32, u32)) {}\n}"), 0, "a trait's");
    assert_eq!(count("fn g() { h(|(a, b): (u8, u8)| a + b) }"), 0, "a closure");
}

#[test]
fn replaced_text_counts_where_it_is_wgsl() {
    let source = "fn f(t: &str) { t.replace('a', \"b\").replace(\".replace(\", \"\") } // .replace(";
    assert_eq!(found("WGSL", "shader", source), 2);
    assert_eq!(found("WGSL", "hall", source), 0);
}

#[test]
fn a_room_may_have_no_more_than_its_limit() {
    const RULE: sizes::Rule =
        sizes::Rule { name: "words", find: |_, m| vec!["word".to_owned(); m.code.len()], allowed: &[("hall", 2)] };
    let wrong = |source: &str| sizes::complaints(&RULE, &modules(&[("hall::a", source), ("attic", "")])).len();
    assert_eq!((wrong("12"), wrong("123")), (0, 1));
    assert_eq!(sizes::complaints(&RULE, &modules(&[("attic", "1")])).len(), 1, "none is allowed where nothing is said");
}

#[test]
fn fields_of_the_renderer_are_counted() {
    let renderer = |fields: usize| {
        let fields: String =
            (0..fields).map(|at| format!("    /// A, b.\n    pub f{at}: Map<u8, (u8, u8)>,\n")).collect();
        modules(&[("render::renderer", &format!("pub struct Renderer {{\n{fields}}}"))])
    };
    assert_eq!(sizes::renderer_complaint(&renderer(12)), None);
    assert!(sizes::renderer_complaint(&renderer(40)).is_some_and(|text| text.contains("40 fields")));
    assert!(sizes::renderer_complaint(&modules(&[])).is_some(), "there is none");
}

#[test]
fn functions_are_read_as_they_are_formatted() {
    let all = functions(&code(
        "pub fn a<T: Fn(u8) -> u8>(x: T)\nwhere\n    T: Clone,\n{\n    b('\\'', '\"')\n}\nfn b();\nimpl<T> F for B<T> {\n    fn c(&self) {}\n}",
    ));
    let read: Vec<_> = all.iter().map(|f| (f.name.as_str(), f.parameters.as_str(), f.lines, f.is_of_trait)).collect();
    assert_eq!(read, [("a", "x: T", 6, false), ("c", "&self", 1, true)]);
}
