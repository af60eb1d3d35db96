//! Lenses that show more directions than the picture does.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::ray::RayLens;

/// What such a lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct FisheyeLens {
    /// Where it is, and what it does to rays.
    pub ray: RayLens,
}

impl OwnKind for FisheyeLens {
    const ROW: KindRow = KindRow::new("fisheye");

    fn empty() -> Self {
        Self { ray: RayLens::fisheye() }
    }
}

impl Own for FisheyeLens {
    fn ray(&self) -> Option<&RayLens> {
        Some(&self.ray)
    }

    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        Some(&mut self.ray)
    }
}
