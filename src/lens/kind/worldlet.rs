//! Lenses that show a small model of a place that can be turned.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What a worldlet has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Worldlet {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for Worldlet {
    const ROW: KindRow = KindRow { views: &["worldlet"], ..KindRow::new("worldlet") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for Worldlet {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
