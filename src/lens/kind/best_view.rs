//! Lenses that show the city from an eye of their own.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What a best-view lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct BestViewLens {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for BestViewLens {
    const ROW: KindRow =
        KindRow { views: &["best", "mcop", "scop", "follow", "onboard", "camera"], ..KindRow::new("best-view") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for BestViewLens {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
