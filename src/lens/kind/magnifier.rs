//! Lenses behind which things are larger.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::ray::RayLens;

/// What such a lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnifier {
    /// Where it is, and what it does to rays.
    pub ray: RayLens,
}

impl OwnKind for Magnifier {
    const ROW: KindRow = KindRow::new("magnifier");

    fn empty() -> Self {
        Self { ray: RayLens::magnifier() }
    }
}

impl Own for Magnifier {
    fn ray(&self) -> Option<&RayLens> {
        Some(&self.ray)
    }

    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        Some(&mut self.ray)
    }
}
