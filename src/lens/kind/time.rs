//! Lenses in which another moment shows.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::content::Content;

/// What a time lens has of its own; its operators are those that any lens may have ([`crate::lens::Lens::time`]).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct TimeLens {
    /// What it shows in place of what is below it; `None`: it acts on that.
    pub content: Option<Content>,
}

impl OwnKind for TimeLens {
    const ROW: KindRow = KindRow::new("time");

    fn empty() -> Self {
        Self::default()
    }
}

impl Own for TimeLens {
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
