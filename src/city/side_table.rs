//! Side tables: which are joined to a city, and what was joined.

use std::path::PathBuf;

use serde::Serialize;

/// A side table of a city.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Join {
    /// The file: CSV, or GeoJSON, whose properties count.
    pub file: PathBuf,
    /// Its column, or property, that says of which object a row is; empty: the first, of GeoJSON `id`.
    pub key: String,
    /// The attribute of objects that has the same; `None`: their id.
    pub attribute: Option<String>,
    /// The columns that say since when and until when the values of a row hold: attributes that change over time.
    pub valid: [Option<String>; 2],
}

/// What was joined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JoinFacts {
    /// The file as it was named.
    pub file: PathBuf,
    /// The column that says of which object a row is.
    pub key: String,
    /// The attribute of objects that has the same; `None`: their id.
    pub attribute: Option<String>,
    /// Rows of the table.
    pub rows: u64,
    /// Rows of which some object is.
    pub joined: u64,
    /// Objects that got attributes.
    pub objects: u64,
    /// Rows of no object.
    pub without_object: u64,
    /// The keys of the first of them, at most eight.
    pub first_without_object: Vec<String>,
    /// Rows that repeat the key of one before: they do not count.
    pub repeated: u64,
    /// Names of the attributes that came, in the order of the table.
    pub attributes: Vec<String>,
}
