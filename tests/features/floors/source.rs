//! Rust source text as these rules read it: no comments, no contents of literals, nothing that only tests see; paths, and items with bodies.
//! This is no parser: it knows as much of the language as the sources need that it reads, and all of them are formatted.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

/// Modules by their path below the crate (`city::load`; the crate itself is the empty path).
pub type Modules = BTreeMap<String, Module>;

/// A module that is a file.
pub struct Module {
    /// Below `src`.
    pub file: PathBuf,
    /// Its code, as [`code`] leaves it.
    pub code: String,
}

/// The modules of the library, from its root down: files that only tests declare are not among them.
pub fn modules(src: &Path) -> Modules {
    let mut found = Modules::new();
    let mut waiting = vec![(String::new(), PathBuf::from("lib.rs"))];
    while let Some((name, file)) = waiting.pop() {
        let code = code(&fs::read_to_string(src.join(&file)).unwrap_or_else(|e| panic!("{}: {e}", file.display())));
        let is_root = ["lib.rs", "mod.rs"].iter().any(|root| file.ends_with(root));
        let folder = if is_root { file.parent().unwrap().to_owned() } else { file.with_extension("") };
        for child in children(&code) {
            let flat = folder.join(format!("{child}.rs"));
            let path = if src.join(&flat).exists() { flat } else { folder.join(&child).join("mod.rs") };
            waiting.push((join(&name, &child), path));
        }
        found.insert(name, Module { file, code });
    }
    found
}

/// A module's path with one more segment.
pub fn join(module: &str, child: &str) -> String {
    if module.is_empty() { child.to_owned() } else { format!("{module}::{child}") }
}

/// Names of the modules that `code` declares in files of their own.
pub fn children(code: &str) -> BTreeSet<String> {
    let is_file = |at: &usize| code[at + 3..].trim_start().trim_start_matches(is_word).starts_with(';');
    words(code, "mod").into_iter().filter(is_file).map(|at| first_word(&code[at + 3..])).collect()
}

/// `source` of which comments and contents of literals are blanks, and which has no items under `#[cfg(test)]`. Lines keep their numbers.
pub fn code(source: &str) -> String {
    let mut code = blank(source);
    while let Some(start) = code.find("#[cfg(test)]") {
        let end = end_of_item(&code, start);
        let lines = code[start..end].matches('\n').count();
        code.replace_range(start..end, &"\n".repeat(lines));
    }
    code
}

/// Where the item ends that begins at `start`, with its attributes.
fn end_of_item(code: &str, start: usize) -> usize {
    let mut at = start;
    while let Some(next) = code[at..].find(['(', '[', '{', ';']) {
        at += next;
        match code.as_bytes()[at] {
            b';' => return at + 1,
            b'{' => return closing(code, at) + 1,
            _ => at = closing(code, at) + 1,
        }
    }
    code.len()
}

/// `source` with blanks for comments and for what stands in literals.
fn blank(source: &str) -> String {
    let mut out = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let previous = out.chars().next_back().unwrap_or(' ');
        let hidden = hidden_length(rest, previous);
        let (taken, is_hidden) = if hidden == 0 { (c.len_utf8(), false) } else { (hidden, true) };
        match is_hidden {
            true => out.extend(rest[..taken].chars().map(|c| if c == '\n' { '\n' } else { ' ' })),
            false => out.push(c),
        }
        rest = &rest[taken..];
    }
    out
}

/// Length of the comment or literal with which `rest` begins, or 0.
fn hidden_length(rest: &str, previous: char) -> usize {
    let until = |from: usize, end: &str| rest[from..].find(end).map_or(rest.len(), |at| from + at + end.len());
    if rest.starts_with("//") {
        return rest.find('\n').unwrap_or(rest.len());
    }
    if rest.starts_with("/*") {
        return until(2, "*/");
    }
    if rest.starts_with('r') && !is_word(previous) {
        let hashes = rest[1..].chars().take_while(|c| *c == '#').count();
        if rest[1 + hashes..].starts_with('"') {
            return until(hashes + 2, &format!("\"{}", "#".repeat(hashes)));
        }
    }
    match rest.as_bytes()[0] {
        b'"' => quoted(rest, '"'),
        b'\'' if rest[1..].starts_with('\\') => quoted(rest, '\''),
        b'\'' if rest[1..].chars().nth(1) == Some('\'') => 2 + rest[1..].chars().next().unwrap().len_utf8(),
        _ => 0,
    }
}

/// Length of a literal that begins and ends with `quote`, with what is escaped in it.
fn quoted(rest: &str, quote: char) -> usize {
    let mut is_escaped = true;
    for (at, c) in rest.char_indices() {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            c if c == quote => return at + 1,
            _ => {}
        }
    }
    rest.len()
}

/// Whether a name may hold `c`.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The name with which `text` begins, after blanks.
pub fn first_word(text: &str) -> String {
    text.trim_start().chars().take_while(|c| is_word(*c)).collect()
}

/// Where `word` stands in `code` as a word of its own.
pub fn words(code: &str, word: &str) -> Vec<usize> {
    let is_alone = |at: usize| {
        let after = code[at + word.len()..].chars().next();
        !code[..at].chars().next_back().is_some_and(is_word) && !after.is_some_and(is_word)
    };
    code.match_indices(word).map(|(at, _)| at).filter(|at| is_alone(*at)).collect()
}

/// Where the bracket closes that opens at `open`; the end of `code`, if it never does.
pub fn closing(code: &str, open: usize) -> usize {
    let mut depth = 0;
    for (at, c) in code[open..].char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return open + at;
        }
    }
    code.len()
}

/// `text` cut at `separator` where no bracket is open.
pub fn split(text: &str, separator: char) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut depth, mut start, mut previous) = (0, 0, ' ');
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' | '{' | '<' => depth += 1,
            '>' if previous == '-' || previous == '=' => {}
            ')' | ']' | '}' | '>' => depth -= 1,
            c if c == separator && depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
        previous = c;
    }
    parts.push(&text[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

/// All paths in `code`, those of a group one by one: `a::{b, c::d}` is `a::b` and `a::c::d`.
pub fn paths(code: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(next) = code[at..].find(is_word) {
        at = path(code, at + next, &mut Vec::new(), &mut found);
    }
    found
}

/// Reads one path, from a name or an opening brace on; where it ends.
fn path(code: &str, start: usize, before: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> usize {
    let depth = before.len();
    let mut at = start;
    loop {
        if code[at..].starts_with('{') {
            let end = closing(code, at);
            for part in split(&code[at + 1..end], ',') {
                let part = part.trim_start();
                path(part, 0, before, found);
            }
            at = (end + 1).min(code.len());
            break;
        }
        let word: String = code[at..].chars().take_while(|c| is_word(*c)).collect();
        at += word.len();
        let is_empty = word.is_empty();
        if !is_empty {
            before.push(word);
        }
        if is_empty || !code[at..].starts_with("::") {
            found.push(before.clone());
            break;
        }
        at += 2;
    }
    before.truncate(depth);
    at
}

/// A function with a body.
pub struct Function {
    /// Its name.
    pub name: String,
    /// Its parameters, without their parentheses.
    pub parameters: String,
    /// From `fn` to the closing brace.
    pub lines: usize,
    /// Whether a trait says what its parameters are.
    pub is_of_trait: bool,
}

/// All functions of `code` that have bodies.
pub fn functions(code: &str) -> Vec<Function> {
    let traits = trait_impls(code);
    words(code, "fn").into_iter().filter_map(|at| function(code, at, &traits)).collect()
}

fn function(code: &str, at: usize, traits: &[Range<usize>]) -> Option<Function> {
    let name = first_word(&code[at + 2..]);
    if name.is_empty() {
        return None;
    }
    let after_name = at + 2 + code[at + 2..].find(&name)? + name.len();
    let open = after_name + parenthesis_after_generics(&code[after_name..])?;
    let close = closing(code, open);
    let end = end_of_item(code, close + 1);
    code[..end].ends_with('}').then(|| Function {
        name,
        parameters: code[open + 1..close].to_owned(),
        lines: code[at..end].matches('\n').count() + 1,
        is_of_trait: traits.iter().any(|range| range.contains(&at)),
    })
}

/// Where the parameters open: behind generics, which may hold parentheses of their own.
fn parenthesis_after_generics(text: &str) -> Option<usize> {
    let mut depth = 0;
    let mut previous = ' ';
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if previous != '-' => depth -= 1,
            '(' if depth == 0 => return Some(at),
            _ => {}
        }
        previous = c;
    }
    None
}

/// Bodies of `impl Trait for Type`.
fn trait_impls(code: &str) -> Vec<Range<usize>> {
    let body = |at: usize| {
        let line_start = code[..at].rfind('\n').map_or(0, |n| n + 1);
        let is_item = code[line_start..at].trim().is_empty() || code[line_start..at].trim() == "unsafe";
        let open = at + code[at..].find('{')?;
        let is_of_trait = !words(&code[at..open], "for").is_empty();
        (is_item && is_of_trait).then(|| open..closing(code, open))
    };
    words(code, "impl").into_iter().filter_map(body).collect()
}
