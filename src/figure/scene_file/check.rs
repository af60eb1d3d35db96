//! Holds a table of a file against the table of keys; gathers everything that is wrong.

use std::{collections::BTreeMap, fmt};

use glam::DVec3;

use crate::{
    city::Lod,
    figure::scene_file::{
        epoch::moment,
        forms::{color, numbers, parameter},
        keys::{FAR_M, Key, Kind, Table},
        node::{Data, Node},
    },
    lens::{Rendering, effect::problem_with, nearest::did_you_mean},
    shader::effect::ParameterKind,
    text::one_line,
};

/// One thing that is wrong: `[lens.0] shape.radius: must be ...`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Line in the file, from 1.
    pub line: u32,
    /// The table, `lens.0`; empty at the top.
    pub table: String,
    /// The way from the table to the key, `shape.radius`; may be empty.
    pub key: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match (self.table.is_empty(), self.key.is_empty()) {
            (true, true) => self.message.clone(),
            (true, false) => format!("{}: {}", self.key, self.message),
            (false, true) => format!("[{}] {}", self.table, self.message),
            (false, false) => format!("[{}] {}: {}", self.table, self.key, self.message),
        };
        // Names of the file are in it: a problem is one line all the same.
        f.write_str(&one_line(&text))
    }
}

/// Where in the file a table is.
#[derive(Clone, Debug)]
pub struct Place {
    /// `lens.0`.
    pub table: String,
    /// `shape.`, or empty.
    pub prefix: String,
    /// Its line.
    pub line: u32,
}

impl Place {
    /// A table within this one, `key` being its name or `shapes.1`.
    pub fn within(&self, key: &str, line: u32) -> Self {
        Self { table: self.table.clone(), prefix: format!("{}{key}.", self.prefix), line }
    }
}

/// Gathers problems.
#[derive(Debug, Default)]
pub struct Checker {
    /// So far.
    pub problems: Vec<Problem>,
}

/// A table whose values have been checked: only good ones are left.
#[derive(Debug)]
pub struct Fields<'a> {
    /// Where it is.
    pub place: Place,
    good: BTreeMap<&'static str, &'a Node>,
    bad: Vec<&'static str>,
}

impl Checker {
    /// Notes a problem with a key of a table.
    pub fn note(&mut self, place: &Place, key: &str, line: u32, message: impl Into<String>) {
        let key = format!("{}{key}", place.prefix).trim_end_matches('.').to_owned();
        self.problems.push(Problem { line, table: place.table.clone(), key, message: message.into() });
    }

    /// Of what was noted after the first `count` problems, keeps what is said of this key, and of all of the table.
    pub fn keep_after(&mut self, count: usize, key: &str) {
        let later = self.problems.split_off(count);
        self.problems.extend(later.into_iter().filter(|problem| problem.key == key || problem.key.is_empty()));
    }

    /// Checks all keys of a table; `later` are keys of later versions.
    pub fn fields<'a>(&mut self, node: &'a Node, table: &Table, later: &[&str], place: Place) -> Fields<'a> {
        let mut fields = Fields { place, good: BTreeMap::new(), bad: Vec::new() };
        let Data::Table(entries) = &node.data else {
            self.note(&fields.place, "", node.line, format!("must be a table, is {}", node.quoted()));
            fields.bad = table.keys.iter().map(|k| k.name).collect();
            return fields;
        };
        for (name, line, value) in entries {
            let Some(key) = table.keys.iter().find(|k| k.name == name) else {
                let message = if later.contains(&name.as_str()) {
                    "is not available yet".to_owned()
                } else {
                    format!("unknown key{}", did_you_mean(name, table.keys.iter().map(|k| k.name)))
                };
                self.note(&fields.place, name, *line, message);
                continue;
            };
            match wrong(&key.kind, value) {
                None => {
                    fields.good.insert(key.name, value);
                }
                Some(message) => {
                    self.note(&fields.place, name, *line, message);
                    fields.bad.push(key.name);
                }
            }
        }
        for key in table.keys.iter().filter(|k| k.default.is_empty() && k.name != "shape") {
            if !fields.given(key.name) {
                self.note(&fields.place, key.name, fields.place.line, missing(key));
            }
        }
        fields
    }
}

fn missing(key: &Key) -> String {
    format!("is missing: {} For example {} = {}", key.doc, key.name, key.example)
}

impl<'a> Fields<'a> {
    /// Whether the key stands in the file, good or bad.
    pub fn given(&self, key: &str) -> bool {
        self.good.contains_key(key) || self.bad.contains(&key)
    }

    /// Whether the key stands in the file with a value that it does not take.
    pub fn is_bad(&self, key: &str) -> bool {
        self.bad.contains(&key)
    }

    /// The value of a key, if good.
    pub fn node(&self, key: &str) -> Option<&'a Node> {
        self.good.get(key).copied()
    }

    /// The line of a key's value, else the table's.
    pub fn line(&self, key: &str) -> u32 {
        self.node(key).map_or(self.place.line, |n| n.line)
    }

    /// A number.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.node(key)?.number()
    }

    /// A whole number that passed its range.
    pub fn integer(&self, key: &str) -> Option<u32> {
        match self.node(key)?.data {
            Data::Integer(i) => u32::try_from(i).ok(),
            _ => None,
        }
    }

    /// Yes or no.
    pub fn boolean(&self, key: &str) -> Option<bool> {
        match self.node(key)?.data {
            Data::Boolean(b) => Some(b),
            _ => None,
        }
    }

    /// A text or word.
    pub fn text(&self, key: &str) -> Option<&'a str> {
        self.node(key)?.text()
    }

    /// A point or direction.
    pub fn point(&self, key: &str) -> Option<DVec3> {
        self.node(key)?.numbers::<3>().map(DVec3::from)
    }

    /// A colour.
    pub fn color(&self, key: &str) -> Option<[f32; 3]> {
        color(self.node(key)?)
    }
}

/// How many of a kind a list may have; told before any of them is looked into.
fn most_of(kind: &Kind) -> usize {
    match kind {
        Kind::Shapes | Kind::Effects | Kind::Tests | Kind::Steps => 1024,
        Kind::Operators => 64,
        Kind::Tables(_) => 4096,
        _ => usize::MAX,
    }
}

/// What is wrong with a value, if anything. Tables, shapes and effects are looked into later.
fn wrong(kind: &Kind, node: &Node) -> Option<String> {
    let (count, most) = (node.list().map_or(0, <[Node]>::len), most_of(kind));
    if count > most {
        return Some(format!("has {count} entries; at most {most} are read"));
    }
    let each =
        |range: std::ops::RangeInclusive<f64>| node.numbers::<3>().is_some_and(|v| v.iter().all(|c| range.contains(c)));
    let ok = match kind {
        Kind::Integer { min, max } => matches!(node.data, Data::Integer(i) if (*min..=*max).contains(&i)),
        Kind::Number { min, max } => node.number().is_some_and(|n| (*min..=*max).contains(&n)),
        Kind::Boolean => matches!(node.data, Data::Boolean(_)),
        Kind::Text => node.text().is_some_and(|t| !t.is_empty()),
        Kind::Texts => node.list().is_some_and(|l| l.iter().all(|n| n.text().is_some_and(|t| !t.is_empty()))),
        Kind::Word { now, later } => return wrong_word(kind, now, later, node),
        Kind::Point => each(-FAR_M..=FAR_M),
        Kind::Lengths => each(0.0..=FAR_M),
        Kind::Direction => {
            each(-FAR_M..=FAR_M) && node.numbers::<3>().and_then(|v| DVec3::from(v).try_normalize()).is_some()
        }
        Kind::Angles => each(-360.0..=360.0),
        Kind::Points(least) => return wrong_rows::<3>(kind, node, *least, "point", &Kind::Point.describe(), FAR_M),
        Kind::PlanPoint => node.numbers::<2>().is_some_and(|v| v.iter().all(|c| c.abs() <= FAR_M)),
        Kind::PlanLengths => node.numbers::<2>().is_some_and(|v| v.iter().all(|c| (0.0..=FAR_M).contains(c))),
        Kind::PicturePlace => node.numbers::<2>().is_some_and(|v| v.iter().all(|c| (0.0..=1.0).contains(c))),
        Kind::PlanPoints(least) => {
            return wrong_rows::<2>(kind, node, *least, "point", &Kind::PlanPoint.describe(), FAR_M);
        }
        Kind::Rings => match node.list() {
            Some(rings) => {
                return rings
                    .iter()
                    .find_map(|ring| wrong_rows::<2>(kind, ring, 0, "point", &Kind::PlanPoint.describe(), FAR_M));
            }
            None => false,
        },
        Kind::Planes(least) => {
            return wrong_rows::<4>(kind, node, *least, "plane", "[x, y, z, d], four finite numbers", f64::MAX);
        }
        Kind::Times(least) => {
            let list = node.list().unwrap_or_default();
            let times: Vec<f64> = list.iter().filter_map(Node::number).filter(|t| (0.0..=1e6).contains(t)).collect();
            if let Some(i) = times.windows(2).position(|pair| pair[1] <= pair[0]).filter(|_| times.len() == list.len())
            {
                let [before, own] = [times[i], times[i + 1]];
                return Some(format!("time {}, {own}, must be later than the one before, {before}", i + 1));
            }
            list.len() >= *least && times.len() == list.len()
        }
        Kind::Color => color(node).is_some(),
        Kind::Background => node.text() == Some("sky") || color(node).is_some(),
        Kind::Lod => lod(node).is_some(),
        Kind::Numbers => numbers(node).is_some(),
        Kind::Size => {
            node.list().is_some_and(|l| l.len() == 2 && l.iter().all(|n| matches!(n.data, Data::Integer(1..=16_384))))
        }
        Kind::PaperSize => node.numbers::<2>().is_some_and(|v| v.iter().all(|mm| (0.1..=1e4).contains(mm))),
        Kind::Table(_) | Kind::Shape | Kind::Handler => matches!(node.data, Data::Table(_)),
        Kind::Shapes => node.list().is_some_and(|l| !l.is_empty()),
        Kind::Names => match node.list() {
            Some(list) => !list.is_empty() && list.iter().all(|n| n.text().is_some_and(|t| !t.is_empty())),
            None => node.text().is_some_and(|t| !t.is_empty()),
        },
        Kind::Test | Kind::View => matches!(node.data, Data::Table(_)),
        Kind::Shares | Kind::Colors => {
            let of = if matches!(kind, Kind::Shares) { ParameterKind::Shares } else { ParameterKind::Colors };
            parameter(node).is_some_and(|value| problem_with(&of, &value).is_none())
        }
        Kind::Moment => return moment(node).err(),
        Kind::Tests | Kind::Steps | Kind::Operators => node.list().is_some_and(|l| !l.is_empty()),
        Kind::Rendering => return wrong_rendering(kind, node),
        Kind::WordOrPlace(words) => match &node.data {
            Data::List(_) => node.numbers::<2>().is_some_and(|v| v.iter().all(|c| (0.0..=1.0).contains(c))),
            _ => return wrong_word(kind, words, &[], node),
        },
        Kind::WordOrTable(words, _) => match &node.data {
            Data::Table(_) => true,
            _ => return wrong_word(kind, words, &[], node),
        },
        Kind::Tables(_) | Kind::Effects => node.list().is_some(),
    };
    let is_far = |n: f64| n.is_finite() && n.abs() > FAR_M;
    let most = match (kind, node.number()) {
        (Kind::Number { max, .. }, Some(n)) if is_far(n) && *max == FAR_M => format!(" and at most {max:e}"),
        _ => String::new(),
    };
    (!ok).then(|| format!("must be {}{most}, is {}", kind.describe(), node.quoted()))
}

fn wrong_rendering(kind: &Kind, node: &Node) -> Option<String> {
    match (node.text(), node.list()) {
        (Some(word), _) if Rendering::of_word(word).is_some() => None,
        (None, Some(_)) => None,
        _ if matches!(node.data, Data::Table(_)) => None,
        (text, _) => {
            let hint = text.map_or_else(String::new, |word| did_you_mean(word, Rendering::words()));
            Some(format!("must be {}, is {}{hint}", kind.describe(), node.quoted()))
        }
    }
}

fn wrong_word(kind: &Kind, now: &[&str], later: &[&str], node: &Node) -> Option<String> {
    match node.text() {
        Some(word) if now.contains(&word) => None,
        Some(word) if later.contains(&word) => {
            Some(format!("\"{word}\" is not available yet; available: {}", now.join(", ")))
        }
        Some(word) => {
            let hint = did_you_mean(word, now.iter().chain(later).copied());
            Some(format!("must be {}, is \"{word}\"{hint}", kind.describe()))
        }
        None => Some(format!("must be {}, is {}", kind.describe(), node.quoted())),
    }
}

fn wrong_rows<const N: usize>(
    kind: &Kind,
    node: &Node,
    least: usize,
    name: &str,
    right: &str,
    most: f64,
) -> Option<String> {
    let Some(list) = node.list() else { return Some(format!("must be {}, is {}", kind.describe(), node.quoted())) };
    let bad = |n: &Node| !n.numbers::<N>().is_some_and(|v| v.iter().all(|c| c.abs() <= most));
    if let Some(at) = list.iter().position(bad) {
        return Some(format!("{name} {at} must be {right}, is {}", list[at].quoted()));
    }
    let has = if list.is_empty() { "none".to_owned() } else { list.len().to_string() };
    (list.len() < least).then(|| format!("must be {}, has {has}", kind.describe()))
}

/// A level of detail, as a text or a number.
pub fn lod(node: &Node) -> Option<Lod> {
    match &node.data {
        Data::Text(text) => Lod::parse(text),
        Data::Integer(i) => Lod::parse(&i.to_string()),
        Data::Number(n) => Lod::parse(&n.to_string()),
        _ => None,
    }
}
