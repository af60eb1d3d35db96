//! The lens volumes that a picture may show: where in it, how each is tested, and where its depth sprite stands if it has one.

use crate::{
    geom::Aabb,
    lens::LensSprite,
    render::{
        bent,
        eye::PictureTile,
        frame::FrameInput,
        screen_bound::ScreenBound,
        sprite_grid::SpriteGrid,
        sprites::{self, Pages, Place},
        stored::{self, SpriteRoom, Stored},
        volume::LensVolume,
    },
    shader::{Form, LensTest},
};

/// A volume that may be seen, with its place among the stages.
pub(super) struct SeenVolume {
    pub index: usize,
    pub lens: u32,
    pub test: LensTest,
    /// What the leaves of a combination are.
    pub leaves: Vec<Form>,
    /// Where it may be seen, and the rectangle around that.
    pub part: ScreenBound,
    pub bounds: PictureTile,
    /// Of one that is tested by its sprite.
    pub sprite: Option<SeenSprite>,
}

/// The sprite of a volume that may be seen.
pub(super) struct SeenSprite {
    /// Its texels against the picture's pixels.
    pub grid: SpriteGrid,
    /// The part of it that is kept, texels.
    pub bounds: PictureTile,
    /// Where it is kept.
    pub kept: Kept,
}

/// Where a sprite is kept.
pub(super) enum Kept {
    /// On a page: what tells the sides of a solid.
    Page(Place),
    /// Among the words of all lenses' sprites.
    Stored(Stored),
}

/// The volumes that a picture may show, and what their sprites take.
pub(super) struct Seen {
    pub volumes: Vec<SeenVolume>,
    /// Of those that tell sides.
    pub pages: Pages,
    /// Of those that lenses are tested by.
    pub words: u64,
    /// Texels of those that are made from lists of crossings.
    pub lists: u64,
}

/// Texels of a sprite of the whole picture.
fn sprite_size(input: &FrameInput, sprite: LensSprite) -> [u32; 2] {
    let size = input.view.size;
    let Some(longer) = sprite.resolution else { return size };
    let scale = f64::from(longer) / f64::from(size[0].max(size[1]));
    size.map(|side| ((f64::from(side) * scale).round() as u32).clamp(1, 16_384))
}

/// The volumes of a frame that its picture may show; `city`: the box around what is drawn; `own`: what the sprites take that come
/// first, those with eyes of their own; `idle`: lenses that do nothing, ascending.
pub(super) fn seen_volumes(input: &FrameInput, city: &Aabb, own: SpriteRoom, idle: &[u32]) -> Seen {
    let mut seen: Vec<SeenVolume> = Vec::new();
    let (mut words, mut lists, mut counts) = (own.words, 0, own.counts);
    let masks = input.masks && input.sample == 0;
    let bent = bent::bound(input.rays, &input.view, input.tile);
    let is_busy = |volume: &LensVolume| idle.binary_search(&volume.lens).is_err();
    for (index, volume) in input.volumes.iter().enumerate().filter(|(_, volume)| is_busy(volume)) {
        // Other classes may be anywhere in the own space of a sprite.
        let has_any_part = masks && volume.has_own_eye();
        let any_part = has_any_part.then(|| ScreenBound::whole(input.tile.size));
        let seen_part = any_part.or_else(|| volume.seen_part(&input.view, input.tile));
        // Bent rays may come to it wherever it is.
        let Some(part) = seen_part.into_iter().chain(bent).reduce(ScreenBound::with) else { continue };
        let bounds = part.rectangle();
        let (lens, test) = (volume.lens, volume.test(masks));
        let leaves = volume.region.forms_in_combination();
        if !test.is_sprite() && !test.has_sides() {
            seen.push(SeenVolume { index, lens, test, leaves, part, bounds, sprite: None });
            continue;
        }
        let wanted = volume.sprite.unwrap_or_default();
        let grid = SpriteGrid { size: sprite_size(input, wanted), picture: input.view.size, tile: input.tile };
        let sprite_bounds = grid.around(bounds);
        let mut kept = Kept::Page(Place::default());
        if test.is_sprite() {
            let code = stored::code_of(&wanted, volume, &input.view, city);
            // Beyond what any GPU holds; such a buffer is refused.
            let number = |n: u64| u32::try_from(n).unwrap_or(u32::MAX);
            let layers = wanted.layers_of(&volume.region);
            let mut stored = Stored { code, layers, first: number(words), first_list: number(lists), excess: 0 };
            if !volume.region.is_form() {
                lists += u64::from(stored.width(sprite_bounds.size[0])) * u64::from(sprite_bounds.size[1]);
                counts += 1;
                stored.excess = if wanted.aggregate { 0 } else { counts };
            }
            words += stored.words(sprite_bounds.size);
            kept = Kept::Stored(stored);
        }
        let sprite = Some(SeenSprite { grid, bounds: sprite_bounds, kept });
        seen.push(SeenVolume { index, lens, test, leaves, part, bounds, sprite });
    }
    let mut on_pages: Vec<(&mut Place, [u32; 2])> = seen
        .iter_mut()
        .filter_map(|v| match v.sprite.as_mut()? {
            SeenSprite { bounds, kept: Kept::Page(place), .. } => Some((place, bounds.size)),
            _ => None,
        })
        .collect();
    let sizes: Vec<[u32; 2]> = on_pages.iter().map(|(_, size)| *size).collect();
    let pages = if sizes.is_empty() { Pages::default() } else { sprites::arrange(&sizes) };
    for ((place, _), found) in on_pages.iter_mut().zip(&pages.places) {
        **place = *found;
    }
    Seen { volumes: seen, pages, words, lists }
}

/// The part of a picture that holds all that may be seen of volumes; `None` without any.
pub(super) fn part_of<'a>(seen: impl Iterator<Item = &'a SeenVolume>) -> Option<ScreenBound> {
    seen.map(|volume| volume.part).reduce(ScreenBound::with)
}
