//! Changes that the widgets of the properties ask for, and drafts of what is typed.

use std::{collections::BTreeMap, rc::Rc};

use toml::{Table as TomlTable, Value};

use crate::{app::document::Document, figure::scene_file::tree, scene::Scene};

/// Texts that are typed and not done yet, and what was wrong with them, by path.
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

/// The value that a key gets.
#[derive(Clone, Debug)]
pub enum To {
    /// Another value.
    Value(Value),
    /// A text that a person typed.
    Typed(String),
    /// It is taken away.
    Nothing,
}

/// A change that a widget asks for.
#[derive(Clone, Debug)]
pub struct Change {
    /// The path of the value's key.
    pub path: String,
    /// The new value.
    pub to: To,
    /// Whether it goes on.
    pub is_held: bool,
}

/// The changes that the widgets of a frame ask for, in order, and the texts that are typed in them.
pub struct Edits<'a> {
    /// The scene that they are of.
    pub scene: &'a Scene,
    /// Texts that are typed and not done yet.
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
