//! Lenses that move what is in them.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::{content::Content, deform::Deform};

/// What a deformation lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformation {
    /// What it does with space.
    pub deform: Deform,
    /// What it shows in place of what is below it; `None`: it acts on that.
    pub content: Option<Content>,
}

impl From<Deform> for Deformation {
    fn from(deform: Deform) -> Self {
        Self { deform, content: None }
    }
}

impl OwnKind for Deformation {
    const ROW: KindRow = KindRow::new("deformation");

    fn empty() -> Self {
        Deform { steps: Vec::new(), control: None, strength: 1.0 }.into()
    }
}

impl Own for Deformation {
    fn content(&self) -> Option<&Content> {
        self.content.as_ref()
    }

    fn content_mut(&mut self) -> Option<&mut Content> {
        self.content.as_mut()
    }

    fn set_content(&mut self, content: Option<Content>) {
        self.content = content;
    }

    fn deform(&self) -> Option<&Deform> {
        Some(&self.deform)
    }

    fn deform_mut(&mut self) -> Option<&mut Deform> {
        Some(&mut self.deform)
    }
}
