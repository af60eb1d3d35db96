//! Values of scene files as TOML text, read back to the bit.

use std::fmt::Write;

use crate::figure::scene_file::node::{Data, Node};

/// A whole file: single values, then `[tables]` and `[[lists of tables]]`, each after an empty line.
pub fn file(root: &Node) -> String {
    let mut out = String::new();
    let Data::Table(entries) = &root.data else { return out };
    let (sections, single): (Vec<_>, Vec<_>) = entries.iter().partition(|(.., node)| has_head(node));
    single.into_iter().for_each(|(key, _, node)| line(&mut out, key, &node.data));
    for (key, _, node) in sections {
        match &node.data {
            Data::List(tables) => tables.iter().for_each(|table| section(&mut out, &format!("[[{key}]]"), table)),
            _ => section(&mut out, &format!("[{key}]"), node),
        }
    }
    out
}

fn has_head(node: &Node) -> bool {
    match &node.data {
        Data::List(tables) => !tables.is_empty() && tables.iter().all(Node::is_table),
        data => matches!(data, Data::Table(_)),
    }
}

fn section(out: &mut String, head: &str, table: &Node) {
    let _ = write!(out, "\n{head}\n");
    if let Data::Table(entries) = &table.data {
        entries.iter().for_each(|(key, _, node)| line(out, key, &node.data));
    }
}

fn line(out: &mut String, key: &str, data: &Data) {
    let _ = writeln!(out, "{} = {}", key_text(key), value(data));
}

/// A value, on one line.
pub fn value(data: &Data) -> String {
    match data {
        Data::Boolean(is) => is.to_string(),
        Data::Integer(integer) => integer.to_string(),
        Data::Number(n) => number(*n),
        Data::Text(text) => quoted(text),
        Data::Date(date) => date.clone(),
        Data::List(items) => {
            let items: Vec<String> = items.iter().map(|item| value(&item.data)).collect();
            format!("[{}]", items.join(", "))
        }
        Data::Table(entries) if entries.is_empty() => "{}".to_owned(),
        Data::Table(entries) => {
            let keys: Vec<String> =
                entries.iter().map(|(key, _, node)| format!("{} = {}", key_text(key), value(&node.data))).collect();
            format!("{{ {} }}", keys.join(", "))
        }
    }
}

/// A key, in quotes where it needs them.
fn key_text(key: &str) -> String {
    let is_bare = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    if is_bare { key.to_owned() } else { quoted(key) }
}

/// The shortest text that reads back as the same f64.
pub fn number(n: f64) -> String {
    format!("{n:?}")
}

/// A TOML basic string.
pub fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\U{:08X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
