//! Knots: files of one room that all import each other, directly or through others, so that none can be read without the rest.
//!
//! A file imports another where a path in it begins with that file's module: `crate::geom::Aabb` is an import of `geom/mod.rs`, whose
//! `pub use aabb::Aabb` is one of `geom/aabb.rs`. So files of a room that name each other through its `mod.rs` make a knot of all it re-exports.

use std::collections::{BTreeMap, BTreeSet};

use super::source::{Modules, children, join, paths};

/// The most files of a room that may import each other.
const MOST: usize = 6;

/// Rooms with larger knots, and no larger ones than these.
const LARGER: &[(&str, usize)] = &[];

/// Which modules each module imports.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// What is wrong with the knots of `modules`: one entry for each that is too large.
pub fn complaints(modules: &Modules) -> Vec<String> {
    let imports = imports(modules);
    let mut wrong = Vec::new();
    for knot in knots(&imports) {
        let room = room(&knot[0]);
        let most = LARGER.iter().find(|(name, _)| *name == room).map_or(MOST, |(_, most)| *most);
        if knot.len() > most && !room.is_empty() {
            wrong.push(complaint(modules, &imports, &knot, most));
        }
    }
    wrong
}

/// The files of a knot, and for each of them one file of the knot that it imports.
fn complaint(modules: &Modules, imports: &Imports, knot: &[String], most: usize) -> String {
    let mut text = format!("{}: {} files import each other, at most {most} may:", room(&knot[0]), knot.len());
    for module in knot {
        let other = imports[module].iter().find(|other| knot.contains(other)).unwrap();
        text += &format!("\n    {} -> {}", modules[module].file.display(), modules[other].file.display());
    }
    text
}

fn room(module: &str) -> &str {
    module.split("::").next().unwrap_or("")
}

/// The imports of each module from its own room.
fn imports(modules: &Modules) -> Imports {
    let of = |name: &String, code: &str| {
        let children = children(code);
        let mut found: BTreeSet<String> =
            paths(&without_visibility(code)).iter().filter_map(|path| target(modules, name, &children, path)).collect();
        found.retain(|other| other != name && room(other) == room(name));
        found
    };
    modules.iter().map(|(name, module)| (name.clone(), of(name, &module.code))).collect()
}

/// `code` without `pub(super)` and the like, which name modules and import nothing.
fn without_visibility(code: &str) -> String {
    let mut parts = code.split("pub(");
    let mut rest = parts.next().unwrap_or("").to_owned();
    for part in parts {
        rest += "pub ";
        rest += part.split_once(')').map_or(part, |(_, after)| after);
    }
    rest
}

/// The module that a path in module `here` leads to.
fn target(modules: &Modules, here: &str, children: &BTreeSet<String>, path: &[String]) -> Option<String> {
    let mut base: Vec<&str> = here.split("::").filter(|segment| !segment.is_empty()).collect();
    let mut rest = path;
    match rest.first()?.as_str() {
        "crate" => {
            base.clear();
            rest = &rest[1..];
        }
        "super" | "self" => {}
        // A declaration alone is no import.
        first if path.len() > 1 && children.contains(first) => {}
        _ => return None,
    }
    while let Some(first @ ("super" | "self")) = rest.first().map(String::as_str) {
        if first == "super" {
            base.pop();
        }
        rest = &rest[1..];
    }
    let mut target = base.join("::");
    for segment in rest {
        let deeper = join(&target, segment);
        if !modules.contains_key(&deeper) {
            break;
        }
        target = deeper;
    }
    Some(target)
}

/// The strongly connected components of more than one module, by Tarjan's algorithm.
fn knots(imports: &Imports) -> Vec<Vec<String>> {
    let mut search = Search::new(imports);
    for module in imports.keys() {
        if !search.order.contains_key(module.as_str()) {
            search.visit(module);
        }
    }
    search.found
}

struct Search<'a> {
    imports: &'a Imports,
    /// In which order modules were reached, and the earliest on the stack that each leads back to.
    order: BTreeMap<&'a str, usize>,
    lowest: BTreeMap<&'a str, usize>,
    stack: Vec<&'a str>,
    found: Vec<Vec<String>>,
}

impl<'a> Search<'a> {
    fn new(imports: &'a Imports) -> Self {
        Self { imports, order: BTreeMap::new(), lowest: BTreeMap::new(), stack: Vec::new(), found: Vec::new() }
    }

    fn visit(&mut self, module: &'a str) {
        let number = self.order.len();
        self.order.insert(module, number);
        self.lowest.insert(module, number);
        self.stack.push(module);
        let imports = self.imports;
        for other in &imports[module] {
            let Some((other, _)) = imports.get_key_value(other) else { continue };
            let back = match self.order.get(other.as_str()) {
                None => {
                    self.visit(other);
                    self.lowest[other.as_str()]
                }
                Some(reached) if self.stack.contains(&other.as_str()) => *reached,
                Some(_) => continue,
            };
            let lowest = self.lowest[module].min(back);
            self.lowest.insert(module, lowest);
        }
        if self.lowest[module] == number {
            let start = self.stack.iter().position(|m| *m == module).unwrap();
            let mut knot: Vec<String> = self.stack.split_off(start).into_iter().map(str::to_owned).collect();
            knot.sort();
            if knot.len() > 1 {
                self.found.push(knot);
            }
        }
    }
}
