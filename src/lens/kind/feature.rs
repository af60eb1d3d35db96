//! Lenses behind which a feature is larger.

use super::row::{KindRow, Own, OwnKind};
use crate::lens::{body::LensBody, ray::RayLens};

/// What such a lens has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureLens {
    /// Where it is, and what it does to rays.
    pub ray: RayLens,
}

impl OwnKind for FeatureLens {
    const ROW: KindRow = KindRow { body: LensBody::None, ..KindRow::new("feature") };

    fn empty() -> Self {
        Self { ray: RayLens::feature() }
    }
}

impl Own for FeatureLens {
    fn ray(&self) -> Option<&RayLens> {
        Some(&self.ray)
    }

    fn ray_mut(&mut self) -> Option<&mut RayLens> {
        Some(&mut self.ray)
    }
}
