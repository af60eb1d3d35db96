//! The state of the window: the document, the city, the last picture, and what panels keep between frames. What is done with it stands in
//! the files of the panels and in [`crate::app::window`].

use std::{path::PathBuf, sync::Arc};

use crate::{
    app::{
        canvas_state::Canvas,
        document::Document,
        drawn::Drawing,
        file_dialog::{Asking, FileDialog},
        finder::Finder,
        properties::edits::Drafts,
        render_thread::{Draw, Frame, Opened, RenderThread},
    },
    scene::CitySpec,
};

/// What is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Chosen {
    /// A lens, by its place.
    pub lens: Option<usize>,
    /// A city object, by its index.
    pub object: Option<u32>,
}

/// A line at the bottom.
#[derive(Clone, Debug)]
pub struct Message {
    /// What it says.
    pub text: String,
    /// What it says to who points at it; may be empty.
    pub details: String,
    /// Whether something failed.
    pub is_error: bool,
}

/// Everything that the window has.
pub struct Window {
    pub(super) render_thread: RenderThread,
    /// What is edited.
    pub document: Document,
    /// The city that is shown.
    pub city: Option<Arc<Opened>>,
    /// What is being loaded.
    pub(super) loading: Option<String>,
    /// What of it is shown, or on its way: another one in the scene is loaded.
    pub(super) spec: CitySpec,
    pub(super) shown_spec: CitySpec,
    /// A scene that waits for its city.
    pub(super) waiting: Option<Document>,
    /// The last picture.
    pub frame: Option<Box<Frame>>,
    /// What is chosen.
    pub chosen: Chosen,
    /// What was chosen in the last frame, and whether of what is now the lens was chosen last.
    pub(super) known_chosen: Chosen,
    pub(super) is_lens_last: bool,
    pub(super) canvas: Canvas,
    pub(super) finder: Finder,
    pub(super) dialog: Option<FileDialog>,
    pub(super) asking: Option<Asking>,
    pub(super) message: Option<Message>,
    pub(super) shows_cost: bool,
    pub(super) previews: bool,
    /// What is drawn on the city, point by point.
    pub(super) drawing: Option<Drawing>,
    /// Whether one stays on the ground.
    pub(super) walks: bool,
    pub(super) shows_shortcuts: bool,
    /// Lenses that are not to be changed, by name: a state of the window, not of the scene.
    pub(super) locked: Vec<String>,
    /// What all lenses were called in the last frame.
    pub(super) lens_names: Vec<String>,
    /// The lens that the pointer is on: as the last frame saw it, and as this one does.
    pub(super) rolled_over: Option<usize>,
    pub(super) rolls_over: Option<usize>,
    pub(super) renaming: Option<Renaming>,
    pub(super) recent: Vec<PathBuf>,
    pub(super) memory: Option<PathBuf>,
    /// What the last figure was exported to, with the scene it was made of.
    pub(super) exported: Option<(PathBuf, PathBuf)>,
    pub(super) statistics: Option<Box<crate::render::stats::Statistics>>,
    pub(super) times_ms: Vec<f64>,
    /// The picture that was asked for last.
    pub(super) asked: Option<Draw>,
    pub(super) title: String,
    pub(super) quits: bool,
    pub(super) allow_outside: bool,
    /// Whether what is shown may.
    pub(super) allows_outside: bool,
    /// The field of view of the last perspective, radians.
    pub(super) fov_y: f64,
    pub(super) drafts: Drafts,
}

/// A lens that is given another name in the list.
#[derive(Clone, Debug)]
pub struct Renaming {
    /// Which.
    pub lens: usize,
    /// What is typed so far.
    pub text: String,
    /// Nothing is typed yet.
    pub is_fresh: bool,
}
