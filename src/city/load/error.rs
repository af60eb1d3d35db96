//! Why a file could not be loaded.

use std::path::{Path, PathBuf};

use crate::text::one_line;

/// Why a file could not be loaded: file, place in it, what would be right.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}{place}: {message}", file.display(), if place.is_empty() { "" } else { ", " })]
pub struct LoadError {
    /// The file, as the user named it.
    pub file: PathBuf,
    /// Line and column, object id or JSON path; may be empty.
    pub place: String,
    /// The fault, and what would be right.
    pub message: String,
}

impl LoadError {
    /// An error about a file as a whole.
    pub fn new(file: &Path, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), place: String::new(), message: one_line(&message.into()) }
    }

    /// An error at a place in a file.
    pub fn at(file: &Path, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), place: one_line(&place.into()), message: one_line(&message.into()) }
    }
}
