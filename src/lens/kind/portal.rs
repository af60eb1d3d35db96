//! Lenses that show another place that one can go to.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What a portal has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Portal {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for Portal {
    const ROW: KindRow = KindRow { views: &["camera"], is_door: true, ..KindRow::new("portal") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for Portal {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
