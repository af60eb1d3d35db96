//! What grows unnoticed: long functions, parameters packed into tuples, the renderer's fields, WGSL made by replacing text.

use std::collections::BTreeMap;

use super::source::{Function, Module, Modules, closing, functions, split};

/// The most lines of a function, from `fn` to its closing brace.
const LINES: usize = 100;

/// Rooms with longer functions, and the most of those that they may have.
const LONG: &[(&str, usize)] = &[];

/// Rooms with functions that take a tuple, and the most of those that they may have.
const TUPLES: &[(&str, usize)] = &[];

/// Rooms that replace text in text, and how often they may.
const REPLACED: &[(&str, usize)] = &[("shader", 1)];

/// The rooms whose text is WGSL.
const WGSL_ROOMS: &[&str] = &["shader"];

/// The most fields of `Renderer`.
const RENDERER_FIELDS: usize = 12;

/// A rule: what it finds in a module's code, and how many of them a room may have where it may have any.
pub struct Rule {
    /// What is found, for messages.
    pub name: &'static str,
    /// What it finds, each with its name.
    pub find: fn(&str, &Module) -> Vec<String>,
    /// Rooms that may have some.
    pub allowed: &'static [(&'static str, usize)],
}

/// The rules that count something for each room.
pub const RULES: &[Rule] = &[
    Rule { name: "functions of more than 100 lines", find: long_functions, allowed: LONG },
    Rule { name: "functions that take a tuple", find: functions_with_tuples, allowed: TUPLES },
    Rule { name: "replacements in WGSL text", find: replacements, allowed: REPLACED },
];

/// What is wrong by `rule`: an entry for each room that has more than it may.
pub fn complaints(rule: &Rule, modules: &Modules) -> Vec<String> {
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (name, module) in modules {
        let room = name.split("::").next().unwrap_or("");
        let here = (rule.find)(room, module).into_iter().map(|what| format!("{}: {what}", module.file.display()));
        found.entry(room).or_default().extend(here);
    }
    let most = |room: &str| rule.allowed.iter().find(|(name, _)| *name == room).map_or(0, |(_, most)| *most);
    let too_many = found.into_iter().filter(|(room, found)| found.len() > most(room));
    too_many
        .map(|(room, found)| {
            let list = found.join("\n    ");
            format!("{room}: {} {}, at most {} may be:\n    {list}", found.len(), rule.name, most(room))
        })
        .collect()
}

fn long_functions(_room: &str, module: &Module) -> Vec<String> {
    let long = functions(&module.code).into_iter().filter(|f| f.lines > LINES);
    long.map(|f| format!("{} has {} lines", f.name, f.lines)).collect()
}

fn functions_with_tuples(_room: &str, module: &Module) -> Vec<String> {
    let with = functions(&module.code).into_iter().filter(|f| !f.is_of_trait && takes_tuple(f));
    with.map(|f| f.name).collect()
}

/// Whether the pattern or the type of a parameter is a tuple of two or more.
fn takes_tuple(function: &Function) -> bool {
    let is_tuple = |text: &str| {
        let text = text.trim().trim_start_matches('&').trim_start().trim_start_matches("mut ").trim_start();
        let is_whole = text.starts_with('(') && closing(text, 0) == text.len() - 1;
        is_whole && split(&text[1..text.len() - 1], ',').len() > 1
    };
    split(&function.parameters, ',').iter().any(|parameter| {
        let parts = split(parameter, ':');
        parts.len() > 1 && (is_tuple(parts[0]) || is_tuple(parts[1]))
    })
}

fn replacements(room: &str, module: &Module) -> Vec<String> {
    if !WGSL_ROOMS.contains(&room) {
        return Vec::new();
    }
    let lines = module.code.lines().enumerate();
    lines.flat_map(|(at, line)| vec![format!("line {}", at + 1); line.matches(".replace(").count()]).collect()
}

/// What is wrong with `Renderer`: it has more fields than it may, or is not found.
pub fn renderer_complaint(modules: &Modules) -> Option<String> {
    let in_render = modules.iter().filter(|(name, _)| name.starts_with("render"));
    let Some(fields) = in_render.filter_map(|(_, module)| fields(&module.code, "Renderer")).next() else {
        return Some("render has no struct `Renderer`".to_owned());
    };
    (fields > RENDERER_FIELDS).then(|| format!("`Renderer` has {fields} fields, at most {RENDERER_FIELDS} may be"))
}

/// How many fields the struct of this name has, if `code` defines it.
fn fields(code: &str, name: &str) -> Option<usize> {
    let start = code.find(&format!("struct {name} {{"))?;
    let open = start + code[start..].find('{')?;
    Some(split(&code[open + 1..closing(code, open)], ',').len())
}
