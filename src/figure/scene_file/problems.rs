//! What is told of a file that is not right.

use std::fmt;

use crate::figure::scene_file::check::Problem;

/// Problems that are shown; the rest is counted.
pub(super) const MAX_SHOWN: usize = 20;

/// Everything that is wrong with a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFileError {
    /// The file, or `--set PATH=VALUE`.
    pub name: String,
    /// All problems, in the order of the file.
    pub problems: Vec<Problem>,
    /// Whether lines mean anything to the reader.
    pub has_lines: bool,
    /// Whether the only thing missing is `VEDUTA_DATA`: galleries skip such scenes.
    pub is_data_absent: bool,
}

impl std::error::Error for SceneFileError {}

impl fmt::Display for SceneFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().take(MAX_SHOWN).enumerate() {
            let end = if i == 0 { "" } else { "\n" };
            match (self.has_lines, problem.line) {
                (true, 1..) => write!(f, "{end}{}:{}: {problem}", self.name, problem.line)?,
                _ => write!(f, "{end}{}: {problem}", self.name)?,
            }
        }
        match self.problems.len().saturating_sub(MAX_SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n... and {more} more"),
        }
    }
}

impl SceneFileError {
    pub(in crate::figure) fn whole(name: &str, line: u32, message: impl Into<String>) -> Self {
        let problem = Problem { line, table: String::new(), key: String::new(), message: message.into() };
        Self { name: name.into(), problems: vec![problem], has_lines: true, is_data_absent: false }
    }
}
