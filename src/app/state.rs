//! The state of the window: the document, the city, the last picture, and what panels keep between frames. What is done with it stands in
//! the files of the panels and in [`crate::app::window`].

use std::{path::PathBuf, sync::Arc};

use crate::{
    app::{
        canvas_state::Canvas,
        document::Document,
        drawn::Drawing,
        file_dialog::{Asking, FileDialog, Purpose},
        finder::Finder,
        properties::edits::Drafts,
        render_thread::{Draw, Frame, Opened, RenderThread},
        timeline::Timeline,
        unsaved::{LeftBehind, Unsaved},
    },
    scene::{CitySpec, Scene},
};

/// The choice of a person.
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
    /// The message.
    pub text: String,
    /// Details, shown where the pointer is on it; may be empty.
    pub details: String,
    /// Whether something failed.
    pub is_error: bool,
}

/// Everything that the window has.
pub struct Window {
    pub(super) render_thread: RenderThread,
    /// The document that is edited.
    pub document: Document,
    /// The city that is shown.
    pub city: Option<Arc<Opened>>,
    /// The stage of loading, while a city is loaded.
    pub(super) loading: Option<String>,
    /// The part of it that is shown, or on its way: another one in the scene is loaded.
    pub(super) spec: CitySpec,
    pub(super) shown_spec: CitySpec,
    /// A scene that waits for its city.
    pub(super) waiting: Option<Document>,
    /// The last picture.
    pub frame: Option<Box<Frame>>,
    /// The choice.
    pub chosen: Chosen,
    /// The choice in the last frame, and whether of what is now the lens was chosen last.
    pub(super) known_chosen: Chosen,
    pub(super) is_lens_last: bool,
    pub(super) canvas: Canvas,
    pub(super) finder: Finder,
    pub(super) dialog: Option<FileDialog>,
    pub(super) asking: Option<Asking>,
    pub(super) message: Option<Message>,
    pub(super) shows_cost: bool,
    pub(super) previews: bool,
    /// The figure that is being drawn on the city, point by point.
    pub(super) drawing: Option<Drawing>,
    /// Whether one stays on the ground.
    pub(super) walks: bool,
    pub(super) shows_shortcuts: bool,
    /// Lenses that are not to be changed, by name: a state of the window, not of the scene.
    pub(super) locked: Vec<String>,
    /// The names of all lenses in the last frame.
    pub(super) lens_names: Vec<String>,
    /// The lens that the pointer is on: as the last frame saw it, and as this one does.
    pub(super) rolled_over: Option<usize>,
    pub(super) rolls_over: Option<usize>,
    pub(super) renaming: Option<Renaming>,
    pub(super) recent: Vec<PathBuf>,
    pub(super) memory: Option<PathBuf>,
    /// The file that the last figure was exported to, with the scene it was made of.
    pub(super) exported: Option<(PathBuf, PathBuf)>,
    pub(super) statistics: Option<Box<crate::render::stats::Statistics>>,
    pub(super) times_ms: Vec<f64>,
    /// The picture that was asked for last.
    pub(super) asked: Option<Draw>,
    pub(super) title: String,
    pub(super) quits: bool,
    /// Keeps edits that are not saved.
    pub(super) unsaved: Option<Unsaved>,
    /// What windows before left behind and nobody has been asked about yet; and what comes back now, once its city is there.
    pub(super) left_behind: Vec<LeftBehind>,
    pub(super) coming_back: Option<LeftBehind>,
    /// The scene that was last held against the city: what it names and the city does not have has been told.
    pub(super) held_against: Option<Arc<Scene>>,
    /// What is done once the scene is saved.
    pub(super) after_saving: Option<Purpose>,
    pub(super) allow_outside: bool,
    /// Whether what is shown may.
    pub(super) allows_outside: bool,
    /// The field of view of the last perspective, radians.
    pub(super) fov_y: f64,
    pub(super) drafts: Drafts,
    /// The timeline.
    pub timeline: Timeline,
}

/// A lens that is given another name in the list.
#[derive(Clone, Debug)]
pub struct Renaming {
    /// Which.
    pub lens: usize,
    /// The text that is typed so far.
    pub text: String,
    /// Nothing is typed yet.
    pub is_fresh: bool,
}
