//! How the depth sprites of lenses are stored.

use glam::DVec3;

use crate::{
    geom::Aabb,
    lens::{
        LensSprite, SpriteSpace,
        sprite::{DepthCode, Format, Mapping},
    },
    render::{eye::PictureTile, placed_region::PlacedRegion, volume::LensVolume},
    view::View,
};

/// How a sprite is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stored {
    /// How distances become codes.
    pub code: DepthCode,
    /// Intervals of a texel, at most.
    pub layers: u32,
    /// Its first word among those of all sprites.
    pub first: u32,
    /// Of one that is made from lists of crossings: the list of its first texel.
    pub first_list: u32,
    /// Where its rays with more intervals than layers are counted; 0: nowhere.
    pub excess: u32,
}

impl Stored {
    /// Texels of a row: of 8-bit sprites an even number, so that no word is shared by rows.
    pub fn width(&self, texels: u32) -> u32 {
        if self.code.format == Format::Unorm8 { texels.next_multiple_of(2) } else { texels }
    }

    /// Words that a sprite of so many texels takes.
    pub fn words(&self, [width, height]: [u32; 2]) -> u64 {
        let depths = 2 * u64::from(self.width(width)) * u64::from(height) * u64::from(self.layers);
        depths * u64::from(self.code.format.bits()) / 32
    }

    /// As the GPU knows its depth code: number, near and far plane.
    pub(super) fn numbers(&self) -> (u32, f32, f32) {
        let DepthCode { mapping, near_m, far_m, format } = self.code;
        (format as u32 | (mapping as u32) << 4, near_m as f32, far_m.min(1e30) as f32)
    }
}

/// Room that sprites take in the buffers of all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpriteRoom {
    /// Words of what is stored.
    pub words: u64,
    /// Counts of rays with more intervals than layers.
    pub counts: u32,
}

/// Two planes at least this part of the distance apart.
const APART: f64 = 1e-3;

/// How the sprite of a volume codes distances. Clip planes that are not given are where the volume begins and ends; one without
/// an end is stored to where the city ends.
pub fn code_of(sprite: &LensSprite, volume: &LensVolume, view: &View, city: &Aabb) -> DepthCode {
    let (format, mapping) = (sprite.format, sprite.mapping);
    let seen_m = view.camera.near_m;
    if sprite.is_as_the_target() {
        let mapping = if view.is_orthographic() { Mapping::ComplementaryW } else { mapping };
        return DepthCode { mapping, near_m: seen_m, far_m: view.far_m, format };
    }
    let depths = |bounds: &Aabb| bounds.corners().map(|corner: DVec3| view.depth(corner));
    let (low, high) = match volume.region.is_bounded() {
        true => {
            let all = depths(&volume.bounds);
            (all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
        }
        false => (seen_m, if city.is_empty() { 0.0 } else { depths(city).into_iter().fold(0.0, f64::max) }),
    };
    let near_m = sprite.near_m.unwrap_or(low.max(seen_m));
    let far_m = sprite.far_m.unwrap_or(high).max(near_m * (1.0 + APART));
    DepthCode { mapping, near_m, far_m: if mapping == Mapping::InverseW { f64::INFINITY } else { far_m }, format }
}

impl LensSprite {
    /// Layers that the sprite of a region takes.
    pub(super) fn layers_of(&self, region: &PlacedRegion) -> u32 {
        if region.is_form() || self.aggregate {
            return 1;
        }
        region.most_intervals().map_or(self.layers, |most| self.layers.min(most as u32))
    }
}

/// A stored sprite, read back.
#[derive(Clone, Debug, PartialEq)]
pub struct SpriteTexels {
    /// Where it was made, and width and height of all of it.
    pub space: SpriteSpace,
    /// The part of it that is kept, texels; rays beside it miss the lens.
    pub bounds: PictureTile,
    /// How distances are coded.
    pub code: DepthCode,
    /// Layers of a texel.
    pub layers: u32,
    /// Codes of entry and exit: layer by layer, texel by texel, row by row from the top.
    pub codes: Vec<[u32; 2]>,
    /// Bytes that it takes on the GPU.
    pub bytes: u64,
}

/// A sprite of the last frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KeptSprite {
    pub lens: u32,
    pub space: SpriteSpace,
    pub bounds: PictureTile,
    pub stored: Stored,
    /// Whether it has its own eye.
    pub is_own: bool,
}
