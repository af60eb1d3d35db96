//! Lenses that restyle what is in them.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::content::Content;

/// What a colour lens has of its own.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ColorLens {
    /// What it shows in place of what is below it; `None`: it acts on that.
    pub content: Option<Content>,
}

impl OwnKind for ColorLens {
    const ROW: KindRow = KindRow::new("color");

    fn empty() -> Self {
        Self::default()
    }
}

impl Own for ColorLens {
    fn content(&self) -> Option<&Content> {
        self.content.as_ref()
    }

    fn content_mut(&mut self) -> Option<&mut Content> {
        self.content.as_mut()
    }

    fn set_content(&mut self, content: Option<Content>) {
        self.content = content;
    }
}
