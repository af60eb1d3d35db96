//! The house rules that the compiler does not know (ARCHITECTURE.md): a room imports rooms of lower floors only, its files make no large
//! knots, what grows unnoticed stays below limits, and shader entry points live in `shaders/pass` only.
//!
//! Nothing here needs the crate: `./dev lint` compiles this file alone.

#[path = "floors/knots.rs"]
mod knots;
#[path = "floors/made_up.rs"]
mod made_up;
#[path = "floors/sizes.rs"]
mod sizes;
#[path = "floors/source.rs"]
mod source;

use std::{
    fs,
    path::{Path, PathBuf},
};

use source::{Modules, modules};

/// The rooms, ground floor first; rooms of one floor do not import each other.
const FLOORS: &[&[&str]] = &[
    &["geom", "text", "time"],
    &["city", "field", "view", "overlay", "shader", "gpu"],
    &["query", "visibility"],
    &["lens"],
    &["scene"],
    &["render"],
    &["figure"],
    &["measure"],
    &["app"],
    &["cli"],
];

/// What tests of all rooms import: the seed of property tests (`tests/seeds`).
const OF_TESTS: &str = "seeds";

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

/// All files below `folder` with this extension, sorted.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return found };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// `source` without line comments, so that links in docs may point anywhere.
fn code(source: &str) -> String {
    source.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

fn first_word(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The first path segment after every `crate::`; `crate::{a::…, b}` names a and b.
fn imported_rooms(source: &str) -> Vec<String> {
    let code = code(source);
    let mut rooms = Vec::new();
    for after in code.split("crate::").skip(1) {
        let Some(group) = after.strip_prefix('{') else {
            rooms.push(first_word(after));
            continue;
        };
        let mut depth = 0;
        let mut start = 0;
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    rooms.push(first_word(&group[start..at]));
                    start = at + 1;
                    if c == '}' {
                        break;
                    }
                }
                _ => {}
            }
        }
    }
    rooms.retain(|room| !room.is_empty() && room.starts_with(char::is_lowercase));
    rooms
}

/// What is wrong with the imports of one file of `room`.
fn wrong_imports(room: &str, file: &str, source: &str) -> Vec<String> {
    let Some(here) = floor(room) else { return vec![format!("{file}: the room `{room}` is on no floor")] };
    let complaint = |other: String| match floor(&other) {
        _ if other == room || other == OF_TESTS => None,
        Some(there) if there < here => None,
        Some(there) => Some(format!("{file}: {room} (floor {here}) imports {other} (floor {there})")),
        None => Some(format!("{file}: imports `{other}`, which is on no floor")),
    };
    imported_rooms(source).into_iter().filter_map(complaint).collect()
}

fn has_entry_point(wgsl: &str) -> bool {
    let code = code(wgsl);
    ["@vertex", "@fragment", "@compute"].iter().any(|stage| code.contains(stage))
}

#[test]
fn imports_go_down_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    let mut seen = 0;
    for path in files(&src, "rs") {
        let inside = path.strip_prefix(&src).unwrap();
        let first = inside.iter().next().unwrap().to_str().unwrap();
        let room = first.trim_end_matches(".rs");
        if ["lib", "main"].contains(&room) {
            continue;
        }
        seen += 1;
        wrong.extend(wrong_imports(room, &inside.display().to_string(), &fs::read_to_string(&path).unwrap()));
    }
    assert!(seen > 0, "no source files found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The modules of the library.
fn library() -> Modules {
    let modules = modules(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(modules.len() > FLOORS.len(), "no source files found");
    modules
}

/// Whether all property tests of `source` take their seed from `tests/seeds`.
fn are_seeded(source: &str) -> bool {
    source.split("proptest! {\n").skip(1).all(|block| {
        let first = block.lines().next().unwrap_or("").trim();
        first.starts_with("#![proptest_config(") && first.contains("seeds::")
    })
}

#[test]
fn property_tests_are_the_same_each_time() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let all = ["src", "tests"].into_iter().flat_map(|folder| files(&root.join(folder), "rs"));
    let wrong: Vec<PathBuf> = all.filter(|path| !are_seeded(&fs::read_to_string(path).unwrap())).collect();
    assert!(wrong.is_empty(), "these need #![proptest_config(crate::seeds::config())]: {wrong:?}");
    assert!(!are_seeded(&["proptest! {", "    #[test]", "}"].join("\n")));
    assert!(!are_seeded(&["proptest! {", "    #![proptest_config(ProptestConfig::with_cases(9))]", "}"].join("\n")));
    assert!(are_seeded(&["proptest! {", "    #![proptest_config(crate::seeds::cases(9))]", "}"].join("\n")));
}

#[test]
fn rooms_have_no_large_knots() {
    let wrong = knots::complaints(&library());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_grows_stays_below_limits() {
    let modules = library();
    let mut wrong: Vec<String> = sizes::RULES.iter().flat_map(|rule| sizes::complaints(rule, &modules)).collect();
    wrong.extend(sizes::renderer_complaint(&modules));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn entry_points_live_in_the_pass_folder() {
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut wrong = Vec::new();
    for path in files(&shaders, "wgsl") {
        let is_pass = path.starts_with(shaders.join("pass"));
        match (is_pass, has_entry_point(&fs::read_to_string(&path).unwrap())) {
            (true, false) => wrong.push(format!("{}: a pass without an entry point", path.display())),
            (false, true) => wrong.push(format!("{}: entry points belong to shaders/pass", path.display())),
            _ => {}
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whether corners are given places that a compiler may round in one program and not in another: passes that look at the same faces
/// would see them at other depths.
fn has_variant_places(wgsl: &str) -> bool {
    code(wgsl).contains("@builtin(position) clip")
}

#[test]
fn corners_have_the_same_places_in_all_passes() {
    let passes = files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/pass"), "wgsl");
    let is_wrong = |path: &&PathBuf| has_variant_places(&fs::read_to_string(path).unwrap());
    let wrong: Vec<&PathBuf> = passes.iter().filter(is_wrong).collect();
    assert!(wrong.is_empty(), "`@invariant` is missing: {wrong:?}");
}

#[test]
fn the_rules_catch_what_they_should() {
    let wrong = |room: &str, source: &str| wrong_imports(room, "x.rs", source).len();
    assert_eq!(wrong("city", "use crate::geom::Aabb;"), 0);
    assert_eq!(wrong("city", "use crate::{city::model::A, geom::{Aabb, Ray}};"), 0);
    assert_eq!(wrong("city", "// see crate::render"), 0);
    assert_eq!(wrong("city", "use crate::view::Camera;"), 1, "neighbours");
    assert_eq!(wrong("geom", "fn f() { crate::city::load() }"), 1, "upwards");
    assert_eq!(wrong("lens", "use crate::{city::{A, B}, render::{C, D}, nowhere};"), 2, "a group");
    assert_eq!(wrong("attic", ""), 1, "no floor");
    assert!(has_entry_point("@vertex fn main() {}"));
    assert!(!has_entry_point("// @vertex\nfn shade() {}"));
    assert!(has_variant_places("struct Face { @builtin(position) clip: vec4f }"));
    assert!(!has_variant_places("struct Face { @builtin(position) @invariant clip: vec4f }"));
}
