//! The dialog that chooses files, and what is asked before something is lost.

use std::path::{Path, PathBuf};

use crate::app::unsaved::LeftBehind;

/// The action that waits until edits may be lost.
#[derive(Clone, Debug, PartialEq)]
pub enum Purpose {
    /// The window closes.
    Quit,
    /// These files are opened.
    OpenThese(Vec<PathBuf>),
}

/// A question.
#[derive(Clone, Debug, PartialEq)]
pub enum Asking {
    /// Edits would be lost.
    Lose(Purpose),
    /// A file would be written over.
    Replace(PathBuf, Writing),
    /// A scene among these files reads what is outside its folder: what was said of it.
    Outside(Vec<PathBuf>, String),
    /// A window before this one left edits behind.
    ComeBack(LeftBehind),
}

impl Asking {
    /// What is asked about, in a few words: the title of the window meanwhile.
    pub fn title(&self) -> &'static str {
        match self {
            Self::Lose(_) => "The scene has edits that are not saved",
            Self::Replace(..) => "The file is there already",
            Self::Outside(..) => "The scene reads files outside its folder",
            Self::ComeBack(_) => "Edits that were not saved are still there",
        }
    }
}

/// The file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Writing {
    /// The scene.
    Scene,
    /// The figure, as the scene says.
    Figure,
    /// The picture that the window shows.
    Shown,
}

/// The purpose of a choice of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Read,
    /// For the city that is shown.
    Add,
    Write(Writing),
}

/// Endings of what can be opened.
pub(super) const READABLE: &[&str] = &["toml", "json", "jsonl", "gz", "gltf", "glb", "obj", "wgsl"];

/// A folder that is looked into, for a file.
#[derive(Clone, Debug)]
pub struct FileDialog {
    pub(super) wanted: Wanted,
    pub(super) folder: PathBuf,
    /// The text that is typed: a name, or a path.
    pub(super) typed: String,
    /// Files that are chosen together.
    pub(super) chosen: Vec<PathBuf>,
    /// The entries of the folder, folders first.
    pub(super) entries: Vec<(PathBuf, bool)>,
    pub(super) problem: Option<String>,
    pub(super) is_fresh: bool,
}

impl FileDialog {
    pub(super) fn new(wanted: Wanted, folder: PathBuf, typed: &str) -> Self {
        let mut dialog = Self {
            wanted,
            folder: PathBuf::new(),
            typed: typed.to_owned(),
            chosen: Vec::new(),
            entries: Vec::new(),
            problem: None,
            is_fresh: true,
        };
        dialog.enter(folder);
        dialog
    }

    /// For files to open.
    pub fn open(folder: PathBuf) -> Self {
        Self::new(Wanted::Read, folder, "")
    }

    /// For city files to add.
    pub fn add(folder: PathBuf) -> Self {
        Self::new(Wanted::Add, folder, "")
    }

    pub(super) fn reads(&self) -> bool {
        matches!(self.wanted, Wanted::Read | Wanted::Add)
    }

    /// For a scene to write.
    pub fn save(folder: PathBuf) -> Self {
        Self::new(Wanted::Write(Writing::Scene), folder, "scene.toml")
    }

    /// For a figure to write.
    pub fn export(folder: PathBuf) -> Self {
        Self::new(Wanted::Write(Writing::Figure), folder, "figure.png")
    }

    /// How names of files that are written end, the usual one first; none: files are read.
    pub(super) fn endings(&self) -> &'static [&'static str] {
        match self.wanted {
            Wanted::Read | Wanted::Add => &[],
            Wanted::Write(Writing::Scene) => &["toml"],
            Wanted::Write(Writing::Figure | Writing::Shown) => &["png", "pdf", "svg"],
        }
    }

    pub(super) fn enter(&mut self, folder: PathBuf) {
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        match std::fs::read_dir(&folder) {
            Ok(entries) => {
                let endings = if self.reads() { READABLE } else { self.endings() };
                let is_meant = |path: &Path| {
                    let own = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
                    endings.contains(&&*own)
                };
                let is_hidden =
                    |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
                let all = entries.filter_map(Result::ok).map(|entry| entry.path()).filter(|path| !is_hidden(path));
                let all = all.map(|path| (path.is_dir(), path)).map(|(is_folder, path)| (path, is_folder));
                self.entries = all.filter(|(path, is_folder)| *is_folder || is_meant(path)).collect();
                self.entries.sort_by(|a, b| (!a.1, &a.0).cmp(&(!b.1, &b.0)));
                (self.folder, self.problem) = (folder, None);
                self.chosen.clear();
                if self.reads() {
                    self.typed.clear();
                }
            }
            Err(error) => self.problem = Some(format!("{}: {error}", folder.display())),
        }
    }

    /// The files that are meant by the text or the choice; empty: none yet.
    pub(super) fn meant(&self) -> Vec<PathBuf> {
        let typed = self.typed.trim();
        if typed.is_empty() {
            return self.chosen.clone();
        }
        if typed.starts_with("builtin:") {
            return vec![typed.into()];
        }
        let mut path = self.folder.join(typed);
        if let (Some(ending), None) = (self.endings().first(), path.extension()) {
            path.set_extension(ending);
        }
        vec![path]
    }

    /// The heading, which says its purpose.
    pub fn title(&self) -> &'static str {
        match self.wanted {
            Wanted::Read => "Open city files, a scene or effects",
            Wanted::Add => "Add files to the city",
            Wanted::Write(Writing::Scene) => "Save the scene",
            Wanted::Write(Writing::Figure | Writing::Shown) => "Export the figure",
        }
    }

    pub(super) fn button(&self) -> &'static str {
        match self.wanted {
            Wanted::Read => "Open",
            Wanted::Add => "Add",
            Wanted::Write(Writing::Scene) => "Save",
            Wanted::Write(Writing::Figure | Writing::Shown) => "Export",
        }
    }
}
