//! Lenses that show an image or a text.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What an annotation has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for Annotation {
    const ROW: KindRow = KindRow { is_note: true, ..KindRow::new("annotation") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for Annotation {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
