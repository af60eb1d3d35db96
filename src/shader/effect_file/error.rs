//! Mistakes in effect files, with their places.

use crate::{shader::wgsl::token::line_and_column, text::one_line};

/// A mistake in an effect file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}:{line}:{column}: {message}")]
pub struct FileError {
    /// The file.
    pub path: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// The mistake, and what was expected.
    pub message: String,
}

/// A file while it is read.
pub(super) struct File<'a> {
    /// Its path.
    pub(super) path: &'a str,
    /// Its text.
    pub(super) text: &'a str,
}

impl File<'_> {
    pub(super) fn error(&self, at: usize, message: impl Into<String>) -> FileError {
        let (line, column) = line_and_column(self.text, at);
        FileError { path: self.path.to_owned(), line, column, message: one_line(&message.into()) }
    }

    /// The TOML of the header, and where each of its lines begins: in itself and in the file.
    pub(super) fn header(&self) -> (String, Vec<(usize, usize)>) {
        let (mut toml, mut starts, mut at) = (String::new(), Vec::new(), 0);
        for line in self.text.split_inclusive('\n') {
            let Some(rest) = line.strip_prefix("//!") else { break };
            let rest = rest.strip_prefix(' ').unwrap_or(rest);
            starts.push((toml.len(), at + line.len() - rest.len()));
            toml.push_str(rest);
            at += line.len();
        }
        (toml, starts)
    }
}

/// Where a place of the header stands in the file.
pub(super) fn in_file(starts: &[(usize, usize)], at: usize) -> usize {
    let line = starts.partition_point(|&(toml, _)| toml <= at).saturating_sub(1);
    starts.get(line).map_or(0, |&(toml, file)| file + (at - toml))
}
