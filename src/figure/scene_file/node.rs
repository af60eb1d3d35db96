//! TOML as a tree that remembers lines.

use glam::{DVec2, DVec3};
use toml::{
    Spanned, Value,
    de::{DeTable, DeValue},
};

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Line, from 1.
    pub line: u32,
    /// What it is.
    pub data: Data,
}

/// A TOML value. What is made of numbers, texts and lists stands in no line: its lines are 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// `true`.
    Boolean(bool),
    /// `1`.
    Integer(i64),
    /// `1.0`, `nan`, `inf`.
    Number(f64),
    /// `"a"`.
    Text(String),
    /// `[...]` or `[[...]]`.
    List(Vec<Node>),
    /// `{...}` or `[...]`, each key with its line.
    Table(Vec<(String, u32, Node)>),
    /// A date or time, as written.
    Date(String),
}

impl Data {
    /// A text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A list.
    pub fn list(items: impl IntoIterator<Item = impl Into<Data>>) -> Self {
        Self::List(items.into_iter().map(|item| Node::of(item.into())).collect())
    }

    /// A table of these keys, in this order.
    pub fn table<K: Into<String>>(entries: impl IntoIterator<Item = (K, Data)>) -> Self {
        Self::Table(entries.into_iter().map(|(key, data)| (key.into(), 0, Node::of(data))).collect())
    }
}

impl Data {
    /// Adds a key to a table.
    pub fn push(&mut self, key: &str, data: impl Into<Data>) {
        if let Self::Table(entries) = self {
            entries.push((key.to_owned(), 0, Node::of(data.into())));
        }
    }

    /// Whether it is a table without keys.
    pub fn is_empty_table(&self) -> bool {
        matches!(self, Self::Table(entries) if entries.is_empty())
    }
}

impl From<f64> for Data {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u32> for Data {
    fn from(number: u32) -> Self {
        Self::Integer(number.into())
    }
}

impl From<bool> for Data {
    fn from(is: bool) -> Self {
        Self::Boolean(is)
    }
}

impl From<&str> for Data {
    fn from(text: &str) -> Self {
        Self::text(text)
    }
}

impl From<&String> for Data {
    fn from(text: &String) -> Self {
        Self::text(text)
    }
}

impl From<DVec3> for Data {
    fn from(point: DVec3) -> Self {
        Self::list(point.to_array())
    }
}

impl From<DVec2> for Data {
    fn from(point: DVec2) -> Self {
        Self::list(point.to_array())
    }
}

impl<const N: usize> From<[f64; N]> for Data {
    fn from(numbers: [f64; N]) -> Self {
        Self::list(numbers)
    }
}

impl From<&Value> for Data {
    fn from(value: &Value) -> Self {
        match value {
            Value::Boolean(is) => Self::Boolean(*is),
            Value::Integer(number) => Self::Integer(*number),
            Value::Float(number) => Self::Number(*number),
            Value::String(text) => Self::text(text),
            Value::Datetime(date) => Self::Date(date.to_string()),
            Value::Array(list) => Self::list(list),
            Value::Table(table) => Self::table(table.iter().map(|(key, value)| (key, value.into()))),
        }
    }
}

impl From<&Data> for Value {
    fn from(data: &Data) -> Self {
        match data {
            Data::Boolean(is) => Self::Boolean(*is),
            Data::Integer(number) => Self::Integer(*number),
            Data::Number(number) => Self::Float(*number),
            Data::Text(text) => Self::String(text.clone()),
            Data::Date(date) => date.parse().map_or_else(|_| Self::String(date.clone()), Self::Datetime),
            Data::List(list) => Self::Array(list.iter().map(|node| Self::from(&node.data)).collect()),
            Data::Table(table) => {
                Self::Table(table.iter().map(|(key, _, node)| (key.clone(), Self::from(&node.data))).collect())
            }
        }
    }
}

/// Why a text is no TOML: line and message.
pub type SyntaxError = (u32, String);

/// Reads TOML.
pub fn parse(text: &str) -> Result<Node, SyntaxError> {
    let lines = Lines(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i).collect());
    let table = DeTable::parse(text).map_err(|e| (lines.at(e.span().map_or(0, |s| s.start)), message_of(&e)))?;
    lines.table(table.get_ref(), 1)
}

fn message_of(error: &toml::de::Error) -> String {
    match error.message() {
        // The parser's limit is 80 tables and lists; a shape in a shape takes two.
        message if message.contains("recursion") => {
            "shapes, lists and tables are nested too deep; shapes within shapes may go 30 deep".into()
        }
        message => message.to_owned(),
    }
}

/// Ends of lines, byte offsets.
struct Lines(Vec<usize>);

impl Lines {
    fn at(&self, byte: usize) -> u32 {
        self.0.partition_point(|end| *end < byte) as u32 + 1
    }

    fn table(&self, table: &DeTable, line: u32) -> Result<Node, SyntaxError> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            entries.push((key.get_ref().to_string(), self.at(key.span().start), self.value(value)?));
        }
        // In the order of the file, so that messages come in that order.
        entries.sort_by_key(|(_, line, _)| *line);
        Ok(Node { line, data: Data::Table(entries) })
    }

    fn value(&self, value: &Spanned<DeValue>) -> Result<Node, SyntaxError> {
        let line = self.at(value.span().start);
        let data = match value.get_ref() {
            DeValue::Boolean(b) => Data::Boolean(*b),
            DeValue::String(s) => Data::Text(s.to_string()),
            DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
                Ok(i) => Data::Integer(i),
                Err(_) => return Err((line, format!("{} does not fit 64 bits", i.as_str()))),
            },
            DeValue::Float(f) => match f.as_str().parse() {
                Ok(f) => Data::Number(f),
                Err(_) => return Err((line, format!("{} is not a number", f.as_str()))),
            },
            DeValue::Datetime(d) => Data::Date(d.to_string()),
            DeValue::Array(list) => Data::List(list.iter().map(|v| self.value(v)).collect::<Result<_, _>>()?),
            DeValue::Table(table) => return self.table(table, line),
        };
        Ok(Node { line, data })
    }
}

impl Node {
    /// A value that stands in no line.
    pub fn of(data: Data) -> Self {
        Self { line: 0, data }
    }

    /// A table without entries.
    pub fn empty_table(line: u32) -> Self {
        Self { line, data: Data::Table(Vec::new()) }
    }

    /// What a table has under this key.
    pub fn entry(&self, key: &str) -> Option<&Self> {
        match &self.data {
            Data::Table(entries) => entries.iter().find(|(name, ..)| name == key).map(|(.., node)| node),
            _ => None,
        }
    }

    /// What a table has under this key, to be changed.
    pub fn entry_mut(&mut self, key: &str) -> Option<&mut Self> {
        match &mut self.data {
            Data::Table(entries) => entries.iter_mut().find(|(name, ..)| name == key).map(|(.., node)| node),
            _ => None,
        }
    }

    /// Takes a key out of a table.
    pub fn remove(&mut self, key: &str) -> Option<Self> {
        let Data::Table(entries) = &mut self.data else { return None };
        let at = entries.iter().position(|(name, ..)| name == key)?;
        Some(entries.remove(at).2)
    }

    /// Gives a key of a table another value.
    pub fn insert(&mut self, key: &str, data: Data) {
        match self.entry_mut(key) {
            Some(node) => *node = Self::of(data),
            None => self.data.push(key, data),
        }
    }

    /// What a table has under this key, `data` where it has nothing; `None` where it is no table.
    pub fn entry_or(&mut self, key: &str, data: Data) -> Option<&mut Self> {
        if !self.has(key) {
            self.data.push(key, data);
        }
        self.entry_mut(key)
    }

    /// Whether it is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.data, Data::Table(_))
    }

    /// Whether it is a table with this key.
    pub fn has(&self, key: &str) -> bool {
        matches!(&self.data, Data::Table(entries) if entries.iter().any(|(name, ..)| name == key))
    }

    /// A number, whole or not.
    pub fn number(&self) -> Option<f64> {
        match self.data {
            Data::Integer(i) => Some(i as f64),
            Data::Number(n) => Some(n),
            _ => None,
        }
    }

    /// A text.
    pub fn text(&self) -> Option<&str> {
        match &self.data {
            Data::Text(t) => Some(t),
            _ => None,
        }
    }

    /// A list.
    pub fn list(&self) -> Option<&[Node]> {
        match &self.data {
            Data::List(l) => Some(l),
            _ => None,
        }
    }

    /// The texts of a list.
    pub fn texts(&self) -> Vec<String> {
        self.list().into_iter().flatten().filter_map(|node| node.text().map(str::to_owned)).collect()
    }

    /// The texts of a list, or the one that stands for a list of itself.
    pub fn names(&self) -> Vec<String> {
        self.text().map_or_else(|| self.texts(), |one| vec![one.to_owned()])
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let list = self.list()?;
        let numbers: Vec<f64> =
            if list.len() == N { list.iter().filter_map(Node::number).collect() } else { return None };
        numbers.try_into().ok()
    }

    /// The value as a message quotes it, shortened.
    pub fn quoted(&self) -> String {
        let text = match &self.data {
            Data::Boolean(b) => b.to_string(),
            Data::Integer(i) => i.to_string(),
            Data::Number(n) => n.to_string(),
            Data::Text(t) => format!("{t:?}"),
            Data::Date(d) => d.clone(),
            Data::List(l) => {
                let some: Vec<String> = l.iter().take(4).map(Node::quoted).collect();
                format!("[{}{}]", some.join(", "), if l.len() > 4 { ", ..." } else { "" })
            }
            Data::Table(t) => {
                let keys: Vec<&str> = t.iter().take(3).map(|(k, ..)| k.as_str()).collect();
                format!("a table ({})", keys.join(", "))
            }
        };
        if text.chars().count() <= 80 { text } else { text.chars().take(77).collect::<String>() + "..." }
    }
}
