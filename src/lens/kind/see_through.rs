//! Lenses that show another place in a region of the picture.

use super::row::{KindRow, Own, OwnKind, nothing_shown};
use crate::lens::best_view::BestView;

/// What a see-through lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct SeeThrough {
    /// What its overlay shows.
    pub shown: BestView,
}

impl OwnKind for SeeThrough {
    const ROW: KindRow = KindRow { views: &["camera"], ..KindRow::new("see-through") };

    fn empty() -> Self {
        Self { shown: nothing_shown() }
    }
}

impl Own for SeeThrough {
    fn best_view(&self) -> Option<&BestView> {
        Some(&self.shown)
    }

    fn best_view_mut(&mut self) -> Option<&mut BestView> {
        Some(&mut self.shown)
    }
}
