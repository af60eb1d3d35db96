//! The list of faults that are planted, one at a time, to see whether the tests notice: `list.toml` beside this.

use std::path::Path;

use serde::Deserialize;

/// A small fault.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// What is wrong then, in a few words.
    pub name: String,
    /// The file that it is planted in.
    pub file: String,
    /// What stands there, once.
    pub from: String,
    /// What stands there instead.
    pub to: String,
    /// The tests that are to notice: a target of cargo (`lib`, `features`, `hard`, ...), and filters of names.
    pub tests: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    fault: Vec<Fault>,
}

/// All faults of a tree.
///
/// # Errors
/// What is wrong with the list.
pub fn read(root: &Path) -> Result<Vec<Fault>, String> {
    let path = root.join("tests/faults/list.toml");
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let list: List = toml::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(list.fault)
}

impl Fault {
    /// A file with the fault in it.
    ///
    /// # Errors
    /// The place is not there, or not the only one.
    pub fn planted(&self, text: &str) -> Result<String, String> {
        match text.matches(&self.from).count() {
            1 => Ok(text.replacen(&self.from, &self.to, 1)),
            count => Err(format!("{}: {} has its place {count} times, once would be right", self.name, self.file)),
        }
    }
}
