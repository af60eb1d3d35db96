//! Lenses that show something else in them.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::content::Content;

/// What a content lens has of its own.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ContentLens {
    /// What it shows in place of what is below it.
    pub content: Content,
}

impl OwnKind for ContentLens {
    const ROW: KindRow = KindRow::new("content");

    fn empty() -> Self {
        Self::default()
    }
}

impl Own for ContentLens {
    fn content(&self) -> Option<&Content> {
        Some(&self.content)
    }

    fn content_mut(&mut self) -> Option<&mut Content> {
        Some(&mut self.content)
    }

    fn set_content(&mut self, content: Option<Content>) {
        self.content = content.unwrap_or_default();
    }
}
