//! Lenses that show a map of what lies around the main eye.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What a map has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct MapView {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for MapView {
    const ROW: KindRow = KindRow { views: &["map"], ..KindRow::new("map-view") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for MapView {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
