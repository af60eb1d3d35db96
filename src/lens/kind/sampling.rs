//! Lenses whose pixels lie closer together in the middle.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::ray::RayLens;

/// What such a lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingLens {
    /// Where it is, and what it does to rays.
    pub ray: RayLens,
}

impl OwnKind for SamplingLens {
    const ROW: KindRow = KindRow::new("sampling");

    fn empty() -> Self {
        Self { ray: RayLens::sampling() }
    }
}

impl Own for SamplingLens {
    fn ray(&self) -> Option<&RayLens> {
        Some(&self.ray)
    }

    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        Some(&mut self.ray)
    }
}
