//! Lenses whose rays a handler of their user bends.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::ray::RayLens;

/// What such a lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnRayLens {
    /// Where it is, and what it does to rays.
    pub ray: RayLens,
}

impl OwnKind for OwnRayLens {
    const ROW: KindRow = KindRow::new("ray");

    fn empty() -> Self {
        Self { ray: RayLens::own() }
    }
}

impl Own for OwnRayLens {
    fn ray(&self) -> Option<&RayLens> {
        Some(&self.ray)
    }

    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        Some(&mut self.ray)
    }
}
