//! What a kind of lens says of itself.

use crate::lens::{
    best_view::{BestView, Depiction},
    body::LensBody,
    content::Content,
    deform::Deform,
    ray::RayLens,
    rendering::Rendering,
};

/// What is said of a kind as such.
#[derive(Clone, Copy, Debug)]
pub struct KindRow {
    /// Its word in scene files.
    pub word: &'static str,
    /// How its bodies are drawn of which nothing is said.
    pub body: LensBody,
    /// The words of the views that its lenses may have, the default first; empty: they have none.
    pub views: &'static [&'static str],
    /// Whether its lenses show an image or a text in place of a view.
    pub is_note: bool,
    /// Whether one can step through its lenses to what they show.
    pub is_door: bool,
}

impl KindRow {
    /// A kind with a line around its bodies and without views.
    pub const fn new(word: &'static str) -> Self {
        Self { word, body: LensBody::Outline, views: &[], is_note: false, is_door: false }
    }
}

/// The data of a kind: its row, and how it is before anything is given.
pub trait OwnKind: Own {
    /// What is said of the kind as such.
    const ROW: KindRow;

    /// Nothing of its own given yet.
    fn empty() -> Self;
}

/// Data of a kind as those see them who ask across kinds; what a kind does not name it does not have.
pub trait Own {
    /// See [`super::LensKind::content`].
    fn content(&self) -> Option<&Content> {
        None
    }

    /// As [`Self::content`], to be changed.
    fn content_mut(&mut self) -> Option<&mut Content> {
        None
    }

    /// Gives it a content, or none, as far as it can have one.
    fn set_content(&mut self, _: Option<Content>) {}

    /// See [`super::LensKind::rendering`].
    fn rendering(&self) -> Option<&Rendering> {
        None
    }

    /// As [`Self::rendering`], to be changed.
    fn rendering_mut(&mut self) -> Option<&mut Rendering> {
        None
    }

    /// See [`super::LensKind::deform`].
    fn deform(&self) -> Option<&Deform> {
        None
    }

    /// As [`Self::deform`], to be changed.
    fn deform_mut(&mut self) -> Option<&mut Deform> {
        None
    }

    /// See [`super::LensKind::ray`].
    fn ray(&self) -> Option<&RayLens> {
        None
    }

    /// As [`Self::ray`], to be changed.
    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        None
    }

    /// See [`super::LensKind::best_view`].
    fn best_view(&self) -> Option<&BestView> {
        None
    }

    /// As [`Self::best_view`], to be changed.
    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        None
    }
}

/// An overlay that shows nothing yet.
pub fn nothing_shown() -> BestView {
    BestView { pois: Vec::new(), depiction: Depiction::Text(String::new()), lenses: None, look: None }
}
