//! Tables of rows: CSV (RFC 4180), and the properties of GeoJSON (RFC 7946).

use std::{borrow::Cow, path::Path};

use csv::StringRecord;
use serde_json::{Map, Value};

use crate::city::load::error::LoadError;

/// A cell that says something.
pub enum Cell<'a> {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// Any other finite number.
    Number(f64),
    /// Any other text.
    Text(&'a str),
    /// A list, as JSON.
    Array(Cow<'a, str>),
    /// A table, as JSON.
    Object(Cow<'a, str>),
}

/// A table whose head was read.
pub struct Table<'a> {
    file: &'a Path,
    rows: Rows<'a>,
    key: String,
    columns: Vec<String>,
}

enum Rows<'a> {
    Csv { bytes: &'a [u8], delimiter: u8, key: usize },
    Features(Vec<Feature>),
}

/// A row of GeoJSON.
#[derive(serde::Deserialize)]
struct Feature {
    #[serde(default)]
    id: Option<Value>,
    #[serde(default)]
    properties: Option<Map<String, Value>>,
}

#[derive(serde::Deserialize)]
struct Collection {
    features: Vec<Feature>,
}

/// The cells of a row.
pub enum Cells<'a> {
    /// The record, and the column that is the key.
    Csv(&'a StringRecord, usize),
    /// Properties, the names of columns, and that of the key.
    Properties(&'a Map<String, Value>, &'a [String]),
}

impl<'a> Table<'a> {
    /// Reads the head of a table and finds the column `key`; empty: the first, of GeoJSON `id`.
    pub fn new(file: &'a Path, bytes: &'a [u8], key: &str) -> Result<Self, LoadError> {
        let begins = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
        match begins {
            Some(b'{') => Self::of_geojson(file, bytes, key),
            Some(_) => Self::of_csv(file, bytes, key),
            None => Err(LoadError::new(file, "is empty; a table, CSV or GeoJSON, would be right")),
        }
    }

    /// The column that says of which object a row is.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The other columns, in their order.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    fn of_csv(file: &'a Path, bytes: &'a [u8], key: &str) -> Result<Self, LoadError> {
        let head = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let count = |delimiter: u8| head.iter().filter(|byte| **byte == delimiter).count();
        // What stands in the head most often; with none there is one column.
        let delimiter = [b',', b';', b'\t', b'|'].into_iter().rev().max_by_key(|d| count(*d)).unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new().delimiter(delimiter).from_reader(bytes);
        let head = reader.headers().map_err(|error| of_csv(file, &error))?;
        let mut columns: Vec<String> = head.iter().map(|name| name.trim().to_owned()).collect();
        let at = match key {
            "" => Some(0),
            key => columns.iter().position(|name| name == key),
        };
        let at = at.ok_or_else(|| no_column(file, key, &columns))?;
        let key = columns.remove(at);
        Ok(Self { file, rows: Rows::Csv { bytes, delimiter, key: at }, key, columns })
    }

    fn of_geojson(file: &'a Path, bytes: &[u8], key: &str) -> Result<Self, LoadError> {
        let read: Result<Collection, _> = serde_json::from_slice(bytes);
        let features = read.map_err(|error| {
            let place = format!("line {}, column {}", error.line(), error.column());
            LoadError::at(file, place, format!("{error}; a FeatureCollection of GeoJSON would be right"))
        })?;
        let features = features.features;
        let mut columns: Vec<String> = Vec::new();
        let mut known = rustc_hash::FxHashSet::default();
        for name in features.iter().filter_map(|f| f.properties.as_ref()).flat_map(Map::keys) {
            if known.insert(name.as_str()) {
                columns.push(name.clone());
            }
        }
        let key = if key.is_empty() { "id" } else { key };
        let has_ids = key == "id" && features.iter().any(|feature| feature.id.is_some());
        if !has_ids && !known.contains(key) {
            return Err(no_column(file, key, &columns));
        }
        columns.retain(|name| name != key);
        Ok(Self { file, rows: Rows::Features(features), key: key.to_owned(), columns })
    }

    /// Rows, at most.
    pub fn most_rows(&self) -> usize {
        match &self.rows {
            Rows::Csv { bytes, .. } => bytes.iter().filter(|byte| **byte == b'\n').count() + 1,
            Rows::Features(features) => features.len(),
        }
    }

    /// Hands over each row that has a key.
    pub fn each_row(&self, mut row: impl FnMut(&str, Cells)) -> Result<(), LoadError> {
        match &self.rows {
            Rows::Csv { bytes, delimiter, key } => {
                let mut reader = csv::ReaderBuilder::new().delimiter(*delimiter).from_reader(*bytes);
                let mut record = StringRecord::new();
                // Rows count from the one behind it.
                reader.headers().map_err(|error| of_csv(self.file, &error))?;
                while reader.read_record(&mut record).map_err(|error| of_csv(self.file, &error))? {
                    let own = record.get(*key).unwrap_or_default().trim();
                    if !own.is_empty() {
                        row(own, Cells::Csv(&record, *key));
                    }
                }
            }
            Rows::Features(features) => {
                for feature in features {
                    let none = Map::new();
                    let properties = feature.properties.as_ref().unwrap_or(&none);
                    let own = properties.get(&self.key).or(feature.id.as_ref().filter(|_| self.key == "id"));
                    let own = match own {
                        Some(Value::String(text)) => text.clone(),
                        Some(Value::Number(number)) => number.to_string(),
                        _ => continue,
                    };
                    row(&own, Cells::Properties(properties, &self.columns));
                }
            }
        }
        Ok(())
    }
}

impl Cells<'_> {
    /// Hands over each cell that says something, with the number of its column.
    pub fn each(&self, mut cell: impl FnMut(usize, Cell)) {
        match self {
            Self::Csv(record, key) => {
                let others = record.iter().enumerate().filter(|(column, _)| column != key);
                for (column, (_, text)) in others.enumerate() {
                    if let Some(value) = cell_of(text.trim()) {
                        cell(column, value);
                    }
                }
            }
            Self::Properties(properties, columns) => {
                for (column, name) in columns.iter().enumerate() {
                    let value = match properties.get(name) {
                        None | Some(Value::Null) => continue,
                        Some(Value::Bool(is)) => Cell::Boolean(*is),
                        Some(Value::Number(number)) => match (number.as_i64(), number.as_f64()) {
                            (Some(whole), _) => Cell::Integer(whole),
                            (None, Some(number)) if number.is_finite() => Cell::Number(number),
                            _ => continue,
                        },
                        Some(Value::String(text)) if text.trim().is_empty() => continue,
                        Some(Value::String(text)) => Cell::Text(text),
                        Some(list @ Value::Array(_)) => Cell::Array(list.to_string().into()),
                        Some(table) => Cell::Object(table.to_string().into()),
                    };
                    cell(column, value);
                }
            }
        }
    }
}

/// What a text of CSV says. Digits that begin with 0 are a number of a register, not one to count with.
fn cell_of(text: &str) -> Option<Cell<'_>> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let is_code = digits.len() > 1 && digits.starts_with('0') && !digits.starts_with("0.");
    let is_number = digits.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    Some(match text {
        "" => return None,
        "true" | "True" | "TRUE" => Cell::Boolean(true),
        "false" | "False" | "FALSE" => Cell::Boolean(false),
        _ if is_code || !is_number => Cell::Text(text),
        _ => match text.parse::<i64>() {
            Ok(whole) => Cell::Integer(whole),
            Err(_) => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Cell::Number(number),
                _ => Cell::Text(text),
            },
        },
    })
}

fn no_column(file: &Path, key: &str, columns: &[String]) -> LoadError {
    let names: Vec<&str> = columns.iter().map(String::as_str).take(12).collect();
    let more = if columns.len() > names.len() { ", ..." } else { "" };
    LoadError::new(file, format!("has no column \"{key}\"; it has {}{more}", names.join(", ")))
}

/// What is wrong with a table of CSV.
fn of_csv(file: &Path, error: &csv::Error) -> LoadError {
    let place = error.position().map_or_else(String::new, |at| format!("line {}", at.line()));
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("has {len} cells; {expected_len}, as the head has, would be right")
        }
        csv::ErrorKind::Utf8 { .. } => "is no UTF-8; a table saved as UTF-8 would be right".to_owned(),
        _ => error.to_string(),
    };
    LoadError::at(file, place, message)
}
