//! Why a field could not be loaded.

use std::path::{Path, PathBuf};

use crate::text::one_line;

/// Why a field could not be loaded: file, place in it, what would be right.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}{place}: {message}", file.display(), if place.is_empty() { "" } else { ", " })]
pub struct FieldError {
    /// The file, as the user named it, or one beside it.
    pub file: PathBuf,
    /// Line or byte; may be empty.
    pub place: String,
    /// The fault, and what would be right.
    pub message: String,
}

impl FieldError {
    /// An error about a file as a whole.
    pub fn new(file: &Path, message: impl Into<String>) -> Self {
        Self::at(file, "", message)
    }

    /// An error at a place in a file.
    pub fn at(file: &Path, place: impl Into<String>, message: impl Into<String>) -> Self {
        // A path can have what steers a terminal, too.
        let shown = plain_line(&file.display().to_string());
        Self { file: PathBuf::from(shown), place: plain_line(&place.into()), message: plain_line(&message.into()) }
    }
}

/// One line, without tabs.
pub(super) fn plain_line(text: &str) -> String {
    one_line(text).replace('\t', " ")
}
