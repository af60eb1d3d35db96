//! Changes that the widgets of the properties ask for, and drafts of what is typed.

use std::{collections::BTreeMap, rc::Rc};

use toml::{Table as TomlTable, Value};

use crate::{app::document::Document, figure::scene_file::tree, scene::Scene};

/// What is typed and not done yet, and what was wrong with it, by path.
#[derive(Debug, Default)]
pub struct Drafts {
    of: Option<(Scene, Rc<TomlTable>)>,
    pub(super) texts: BTreeMap<String, String>,
    pub(super) wrong: BTreeMap<String, String>,
}

impl Drafts {
    /// The scene as a table.
    pub fn root(&mut self, document: &Document) -> Rc<TomlTable> {
        let scene = document.scene();
        let is_known = self.of.as_ref().is_some_and(|(of, _)| of == scene);
        if !is_known {
            let table = match Value::from(&tree(scene, &document.options()).data) {
                Value::Table(table) => table,
                _ => TomlTable::new(),
            };
            self.of = Some((scene.clone(), Rc::new(table)));
        }
        self.of.as_ref().map(|(_, table)| table.clone()).unwrap_or_default()
    }
}

/// What a value becomes.
#[derive(Clone, Debug)]
pub enum To {
    /// Another value.
    Value(Value),
    /// What somebody typed.
    Typed(String),
    /// It is taken away.
    Nothing,
}

/// What a widget asks for.
#[derive(Clone, Debug)]
pub struct Change {
    /// The path of the value's key.
    pub path: String,
    /// What it becomes.
    pub to: To,
    /// Whether it goes on.
    pub is_held: bool,
}

/// What the widgets of a frame ask for, in order, and what is typed in them.
pub struct Edits<'a> {
    /// What is typed and not done yet.
    pub drafts: &'a mut Drafts,
    /// Changes that are to be made.
    pub changes: Vec<Change>,
}

impl Edits<'_> {
    /// Asks for a change that does not go on.
    pub fn push(&mut self, path: String, to: To) {
        self.changes.push(Change { path, to, is_held: false });
    }
}
