//! Scene files (TOML) and back, exactly as `docs/scene.md` has them.
//!
//! `keys` is the one table of keys; `node` reads TOML with line numbers, `check` holds it against the table, `parse`
//! makes a [`Scene`], `write` the file again, `set` applies `PATH=VALUE`, `document` makes the docs and the schema.

pub mod animation;
pub mod best_view;
pub mod check;
mod content;
pub mod deformation;
pub mod document;
mod figure;
mod focus;
pub mod keys;
pub(in crate::figure) mod node;
mod occlusion;
pub mod overlay;
mod parse;
mod paths;
mod rendering;
mod set;
pub mod shape_keys;
pub mod sprite;
pub mod test_keys;
mod trajectory;
mod write;

use std::{fmt, io::Read, path::Path};

pub use check::Problem;
pub(in crate::figure) use figure::text_size;
pub use parse::{lens_color, rotation};
pub use paths::{Options, PathProblem};
pub use set::{rename_lens, set, set_within};

use crate::scene::Scene;

/// Largest scene file, bytes.
const MAX_BYTES: u64 = 16 << 20;
/// Problems that are shown; the rest is counted.
const MAX_SHOWN: usize = 20;

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

/// Reads a scene file (`-`: standard input).
pub fn read(path: &Path, options: &Options) -> Result<Scene, SceneFileError> {
    let name = path.display().to_string();
    parse(&read_text(path, &name, "scene")?, &name, options)
}

/// The text of a file of this kind (`-`: standard input); `name` stands for it in messages.
pub(in crate::figure) fn read_text(path: &Path, name: &str, kind: &str) -> Result<String, SceneFileError> {
    let failed = |e: std::io::Error| SceneFileError::whole(name, 0, format!("cannot be read: {e}"));
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().lock().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    } else {
        let file = std::fs::File::open(path).map_err(failed)?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    }
    if bytes.len() as u64 > MAX_BYTES {
        let message = format!("is larger than 16 MiB; a {kind} file is a page of text");
        return Err(SceneFileError::whole(name, 0, message));
    }
    String::from_utf8(bytes).map_err(|e| {
        let line = e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count() as u32 + 1;
        SceneFileError::whole(name, line, format!("is not UTF-8 text; a {kind} file is TOML"))
    })
}

/// Reads a scene from text; `name` stands for it in messages.
pub fn parse(text: &str, name: &str, options: &Options) -> Result<Scene, SceneFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root =
        node::parse(text).map_err(|(line, message)| SceneFileError::whole(name, line, message.replace('\n', ", ")))?;
    if root.has("veduta_sheet") {
        return Err(SceneFileError::whole(name, 1, "is a sheet and not a scene; `veduta sheet` draws it"));
    }
    let mut reader = parse::SceneReader::new(options);
    let scene = reader.scene(&root);
    let mut problems = reader.checker.problems;
    if problems.is_empty() {
        return Ok(scene);
    }
    problems.sort_by_key(|p| p.line);
    let is_data_absent =
        reader.lacks_data && problems.iter().all(|p| p.message.contains("VEDUTA_DATA, which is not set"));
    Err(SceneFileError { name: name.into(), problems, has_lines: true, is_data_absent })
}

/// The scene as TOML, paths as they are. Reading it with [`Options::for_command_line`] gives the same scene.
pub fn to_toml(scene: &Scene) -> String {
    write::write(scene, &Options::default())
}

/// The scene as the TOML of a file that is read with `options`: paths relative to its folder where they lie in it.
pub fn to_toml_for(scene: &Scene, options: &Options) -> String {
    write::write(scene, options)
}

#[cfg(test)]
mod round_trip;
#[cfg(test)]
mod tests;
