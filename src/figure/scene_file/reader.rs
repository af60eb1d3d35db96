//! What the readers of all tables share: notes of what is wrong, and where paths lead.

use std::{ffi::OsStr, fmt::Write as _, io::ErrorKind, path::Path, path::PathBuf};

use crate::{
    city::builtin,
    figure::scene_file::{
        check::{Checker, Fields, Problem},
        node::Node,
        paths::{Options, PathProblem},
        problems::SceneFileError,
    },
};

/// Takes notes while a scene is read; what is wrong gets its default.
pub struct Reader<'o> {
    /// What is wrong so far.
    pub checker: Checker,
    /// Whether a path needs `${VEDUTA_DATA}` and it is not set.
    pub lacks_data: bool,
    options: &'o Options,
}

impl<'o> Reader<'o> {
    /// A reader of paths by `options`.
    pub fn new(options: &'o Options) -> Self {
        Self { checker: Checker::default(), lacks_data: false, options }
    }

    /// All that is wrong with the file of this name, line by line.
    pub fn error(self, name: &str) -> SceneFileError {
        let mut problems = self.checker.problems;
        problems.sort_by_key(|problem| problem.line);
        let is_data = |problem: &Problem| problem.message.contains("VEDUTA_DATA, which is not set");
        let is_data_absent = self.lacks_data && problems.iter().all(is_data);
        SceneFileError { name: name.into(), problems, has_lines: true, is_data_absent }
    }

    /// How paths are read.
    pub fn options(&self) -> &'o Options {
        self.options
    }

    /// The file that a value of a table names; noted where it may not be read.
    pub fn path(&mut self, fields: &Fields, key: &str, node: &Node) -> Option<PathBuf> {
        let message = match self.options.resolve(node.text().unwrap_or_default()) {
            Ok(path) if is_no_file(&path) => {
                format!("{} is a pipe or a device; a file would be right", node.quoted())
            }
            Ok(path) => return Some(path),
            Err(PathProblem::NoData) => {
                self.lacks_data = true;
                format!("{} needs the environment variable VEDUTA_DATA, which is not set", node.quoted())
            }
            Err(PathProblem::Wrong(message)) => message,
        };
        self.checker.note(&fields.place, key, node.line, message);
        None
    }

    /// The file that a key names.
    pub fn file(&mut self, fields: &Fields, key: &str) -> Option<PathBuf> {
        self.path(fields, key, fields.node(key)?)
    }

    /// The files that a key lists.
    pub fn files(&mut self, fields: &Fields, list: &str, must_exist: bool) -> Vec<PathBuf> {
        let mut files = Vec::new();
        for (i, node) in fields.node(list).and_then(Node::list).unwrap_or_default().iter().enumerate() {
            let key = format!("{list}.{i}");
            match self.path(fields, &key, node) {
                Some(path) if must_exist && is_absent(&path) => {
                    let mut message = format!("there is no file or folder {}", node.quoted());
                    if Some(path.as_os_str()) != node.text().map(OsStr::new) {
                        let _ = write!(message, " ({})", path.display());
                    }
                    self.checker.note(&fields.place, &key, node.line, message);
                }
                path => files.extend(path),
            }
        }
        files
    }
}

/// Whether something is there that is neither a file nor a folder, and would be waited for.
fn is_no_file(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Whether nothing is there. What is there and cannot be read, loading tells.
fn is_absent(path: &Path) -> bool {
    let is_builtin = path.to_string_lossy().starts_with(builtin::PREFIX);
    !is_builtin && std::fs::metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
}
