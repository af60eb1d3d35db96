//! The lens volumes that a picture may show: where in it, how each is tested, and where its depth sprite stands if it has one.

use crate::{
    lens::LensSprite,
    render::{
        eye::PictureTile,
        frame::FrameInput,
        octagon::Octagon,
        sprites::{self, Pages, Place},
    },
    shader::VolumeTest,
};

/// A volume that may be seen, with its place among the stages.
pub(super) struct SeenVolume {
    pub index: usize,
    pub lens: u32,
    pub test: VolumeTest,
    /// What the leaves of a combination are.
    pub leaves: Vec<VolumeTest>,
    /// Where it may be seen, and the rectangle around that.
    pub part: Octagon,
    pub bounds: PictureTile,
    /// Of one that is tested by its sprite.
    pub sprite: Option<SeenSprite>,
}

/// The sprite of a volume that may be seen.
pub(super) struct SeenSprite {
    /// Its width and height, texels.
    pub size: [u32; 2],
    /// The part of it that is kept, texels.
    pub bounds: PictureTile,
    /// Where it is kept.
    pub place: Place,
}

/// Texels of a sprite.
fn sprite_size(input: &FrameInput, sprite: LensSprite) -> [u32; 2] {
    let size = input.tile.size;
    let Some(longer) = sprite.resolution else { return size };
    // The resolution is one of the whole picture; a tile of it has its share.
    let scale = f64::from(longer) / f64::from(input.view.size[0].max(input.view.size[1]));
    size.map(|side| ((f64::from(side) * scale).round() as u32).clamp(1, 16_384))
}

/// The volumes of a frame that its picture may show, and the pages of their sprites.
pub(super) fn seen_volumes(input: &FrameInput) -> (Vec<SeenVolume>, Pages) {
    let mut seen = Vec::new();
    for (index, volume) in input.volumes.iter().enumerate() {
        let Some(part) = volume.seen_part(&input.view, input.tile) else { continue };
        let bounds = part.rectangle();
        let (lens, test) = (volume.lens, volume.test(input.masks && input.sample == 0));
        let leaves = volume.body.kinds();
        if !test.has_sprite() {
            seen.push(SeenVolume { index, lens, test, leaves, part, bounds, sprite: None });
            continue;
        }
        let sprite = sprite_size(input, volume.sprite.unwrap_or_default());
        let to_texel = |i: usize, pixel: u32| f64::from(pixel) * f64::from(sprite[i]) / f64::from(input.tile.size[i]);
        let low: [u32; 2] = std::array::from_fn(|i| to_texel(i, bounds.origin[i]).floor() as u32);
        let high: [u32; 2] =
            std::array::from_fn(|i| (to_texel(i, bounds.origin[i] + bounds.size[i]).ceil() as u32 + 1).min(sprite[i]));
        let sprite_bounds = PictureTile { origin: low, size: [high[0] - low[0], high[1] - low[1]] };
        let sprite = Some(SeenSprite { size: sprite, bounds: sprite_bounds, place: Place::default() });
        seen.push(SeenVolume { index, lens, test, leaves, part, bounds, sprite });
    }
    let sizes: Vec<[u32; 2]> = seen.iter().filter_map(|v| v.sprite.as_ref()).map(|s| s.bounds.size).collect();
    if sizes.is_empty() {
        return (seen, Pages::default());
    }
    let pages = sprites::arrange(&sizes);
    for (sprite, place) in seen.iter_mut().filter_map(|v| v.sprite.as_mut()).zip(&pages.places) {
        sprite.place = *place;
    }
    (seen, pages)
}

/// The part of a picture that holds all that may be seen of volumes; `None` without any.
pub(super) fn part_of<'a>(seen: impl Iterator<Item = &'a SeenVolume>) -> Option<Octagon> {
    seen.map(|volume| volume.part).reduce(Octagon::with)
}
