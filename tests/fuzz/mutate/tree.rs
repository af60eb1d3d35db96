//! Trees of JSON and TOML, changed node by node.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{change_number, words::NUMBERS, words_of};
use crate::studio::random_scene::Random;

/// What the files of a kind say: the values that their keys have, and whole files in pieces.
#[derive(Default)]
pub struct Pool {
    /// By key: what stands under it, somewhere.
    values: BTreeMap<String, Vec<Value>>,
    keys: Vec<String>,
    /// Functions and declarations of effect files.
    pub declarations: Vec<String>,
}

/// Values of a key that are kept: the first, small ones.
const MOST_VALUES: usize = 64;
const MOST_NODES: usize = 400;

impl Pool {
    /// Adds what a file says, if it is one of JSON or TOML.
    pub fn add(&mut self, name: &str, bytes: &[u8]) {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let tree = match name.rsplit('.').next() {
            Some("toml") => toml_tree(text),
            Some("wgsl") => {
                self.declarations.extend(super::wgsl::declarations(text));
                toml_tree(&super::wgsl::header(text))
            }
            _ => serde_json::from_str(text).ok(),
        };
        if let Some(tree) = tree {
            self.take(&tree);
        }
        self.values.retain(|_, known| !known.is_empty());
        self.keys = self.values.keys().cloned().collect();
    }

    fn take(&mut self, tree: &Value) {
        match tree {
            Value::Array(list) => list.iter().for_each(|node| self.take(node)),
            Value::Object(map) => {
                for (key, node) in map {
                    let known = self.values.entry(key.clone()).or_default();
                    if known.len() < MOST_VALUES && !known.contains(node) && count(node) < MOST_NODES {
                        known.push(node.clone());
                    }
                    self.take(node);
                }
            }
            _ => {}
        }
    }

    /// A key, and a value that it has somewhere.
    fn entry(&self, random: &mut Random) -> Option<(String, Value)> {
        let key = (!self.keys.is_empty()).then(|| random.pick(&self.keys).clone())?;
        let value = random.pick(&self.values[&key]).clone();
        Some((key, value))
    }

    /// Another value of a key.
    fn value(&self, key: &str, random: &mut Random) -> Option<Value> {
        self.values.get(key).map(|values| random.pick(values).clone())
    }
}

fn toml_tree(text: &str) -> Option<Value> {
    let table: toml::Table = text.parse().ok()?;
    serde_json::to_value(table).ok()
}

/// Changes the JSON tree, where there is one; in a sequence, of one line.
pub fn change_json(bytes: Vec<u8>, pool: &Pool, random: &mut Random) -> Vec<u8> {
    let mut lines: Vec<Vec<u8>> = match serde_json::from_slice::<Value>(&bytes) {
        Ok(_) => vec![bytes.clone()],
        Err(_) => bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect(),
    };
    let at = random.below(lines.len());
    let Ok(mut tree) = serde_json::from_slice::<Value>(&lines[at]) else { return change_number(bytes, random) };
    change_node(&mut tree, words_of("json"), pool, random);
    lines[at] = tree.to_string().into_bytes();
    lines.join(&b'\n')
}

/// Changes the TOML tree, where there is one; comments are lost.
pub fn change_toml(bytes: Vec<u8>, pool: &Pool, random: &mut Random) -> Vec<u8> {
    let Some(mut tree) = std::str::from_utf8(&bytes).ok().and_then(toml_tree) else {
        return change_number(bytes, random);
    };
    change_node(&mut tree, words_of("toml"), pool, random);
    match to_toml(&tree) {
        Some(toml::Value::Table(table)) => table.to_string().into_bytes(),
        _ => bytes,
    }
}

/// The same in TOML, which has no `null`: what is one is left out.
fn to_toml(tree: &Value) -> Option<toml::Value> {
    Some(match tree {
        Value::Null => return None,
        Value::Bool(is) => toml::Value::Boolean(*is),
        Value::String(text) => toml::Value::String(text.clone()),
        Value::Number(number) => number
            .as_i64()
            .map_or_else(|| number.as_f64().map(toml::Value::Float), |n| Some(toml::Value::Integer(n)))?,
        Value::Array(list) => toml::Value::Array(list.iter().filter_map(to_toml).collect()),
        Value::Object(map) => {
            toml::Value::Table(map.iter().filter_map(|(key, node)| Some((key.clone(), to_toml(node)?))).collect())
        }
    })
}

/// Changes a node of a tree.
fn change_node(tree: &mut Value, words: &[&str], pool: &Pool, random: &mut Random) {
    let total = count(tree);
    let source = match pool.entry(random) {
        Some((_, value)) if random.once_in(3) => value,
        _ => nth(tree, random.below(total)).clone(),
    };
    let node = nth(tree, random.below(total));
    match random.below(12) {
        0 => *node = serde_json::from_str(random.pick::<&str>(NUMBERS)).unwrap_or(Value::Null),
        1 => *node = source,
        2 => *node = Value::String((*random.pick(words)).to_owned()),
        3 => {
            for _ in 0..1 + random.below(100) {
                *node = Value::Array(vec![node.take()]);
            }
        }
        4 => *node = Value::Object([((*random.pick(words)).to_owned(), node.take())].into_iter().collect()),
        5..=7 => from_pool(node, pool, random),
        _ => change_members(node, source, words, random),
    }
}

/// Gives a table a key that other files have, or one of its own another value that the key has elsewhere; a list one more of those.
fn from_pool(node: &mut Value, pool: &Pool, random: &mut Random) {
    let Some((key, value)) = pool.entry(random) else { return };
    match node {
        Value::Object(map) if map.is_empty() || random.once_in(2) => drop(map.insert(key, value)),
        Value::Object(map) => {
            let own = map.keys().nth(random.below(map.len())).cloned().unwrap_or_default();
            if let Some(value) = pool.value(&own, random) {
                map.insert(own, value);
            }
        }
        Value::Array(list) => list.push(value),
        other => *other = value,
    }
}

/// Takes out, doubles, renames, empties or adds members of a node.
fn change_members(node: &mut Value, source: Value, words: &[&str], random: &mut Random) {
    match node {
        Value::Array(list) if list.is_empty() => list.push(source),
        Value::Array(list) => {
            let at = random.below(list.len());
            match random.below(6) {
                0 => drop(list.remove(at)),
                1 => {
                    let copies = *random.pick(&[1, 2, 100]);
                    let copy = list[at].clone();
                    if count(&copy) * copies < 20_000 {
                        list.extend(std::iter::repeat_n(copy, copies));
                    }
                }
                2 => list.clear(),
                3 => list.reverse(),
                4 => list[at] = source,
                _ => list.insert(at, source),
            }
        }
        Value::Object(map) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            let key = if keys.is_empty() { String::new() } else { random.pick(&keys).clone() };
            match random.below(4) {
                0 => drop(map.remove(&key)),
                1 => {
                    let value = map.remove(&key).unwrap_or(Value::Null);
                    map.insert((*random.pick(words)).to_owned(), value);
                }
                2 => drop(map.insert(key, source)),
                _ => drop(map.insert((*random.pick(words)).to_owned(), source)),
            }
        }
        other => *other = serde_json::from_str(random.pick::<&str>(NUMBERS)).unwrap_or(Value::Null),
    }
}

/// Nodes of a tree, itself included.
fn count(tree: &Value) -> usize {
    match tree {
        Value::Array(list) => 1 + list.iter().map(count).sum::<usize>(),
        Value::Object(map) => 1 + map.values().map(count).sum::<usize>(),
        _ => 1,
    }
}

/// Node `n` in reading order.
fn nth(tree: &mut Value, mut n: usize) -> &mut Value {
    if n == 0 {
        return tree;
    }
    n -= 1;
    let children: Vec<&mut Value> = match tree {
        Value::Array(list) => list.iter_mut().collect(),
        Value::Object(map) => map.values_mut().collect(),
        _ => unreachable!("counted before"),
    };
    for child in children {
        let size = count(child);
        if n < size {
            return nth(child, n);
        }
        n -= size;
    }
    unreachable!("counted before")
}
