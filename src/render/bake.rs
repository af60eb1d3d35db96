//! Depth sprites that a frame has to make: bake requests, and the numbers that the GPU makes each from.

use crate::{
    lens::SpriteSpace,
    render::{
        eye::PictureTile,
        frame::FrameInput,
        layout,
        placed_region::{PlacedLeaf, PlacedRegion},
        seen::{Kept, SeenSprite, SeenVolume},
        sprite_grid::SpriteGrid,
        stored::{KeptSprite, Stored},
    },
    view::View,
};

/// The solids of a region whose crossings are listed, each with its number among the leaves.
pub(super) fn solids_of(region: &PlacedRegion) -> impl Iterator<Item = (u32, &PlacedLeaf)> {
    (0..).zip(region.leaves()).filter(|(_, leaf)| leaf.is_solid())
}

/// A sprite that is to be made.
#[derive(Debug)]
pub(super) struct BakeRequest<'a> {
    /// Whose it is.
    pub lens: u32,
    /// What it is made of.
    pub region: &'a PlacedRegion,
    /// Its texels against the pixels of its eye, and the part of it that is kept.
    pub grid: SpriteGrid,
    pub bounds: PictureTile,
    /// How it is stored, and where.
    pub stored: Stored,
    /// Its own eye; `None`: the picture's.
    pub own: Option<View>,
}

/// The sprites of the picture's eye, all of which are made in every frame.
pub(super) fn of_picture<'a>(seen: &[SeenVolume], input: &FrameInput<'a>) -> Vec<BakeRequest<'a>> {
    let request = |v: &SeenVolume| match v.sprite.as_ref()? {
        &SeenSprite { grid, bounds, kept: Kept::Stored(stored) } => {
            Some(BakeRequest { lens: v.lens, region: &input.volumes[v.index].region, grid, bounds, stored, own: None })
        }
        _ => None,
    };
    seen.iter().filter_map(request).collect()
}

impl BakeRequest<'_> {
    /// Lists of crossings that it takes, those before it included; 0 where it is made without.
    pub fn lists_end(&self) -> u64 {
        if self.region.is_form() {
            return 0;
        }
        let texels = u64::from(self.stored.width(self.bounds.size[0])) * u64::from(self.bounds.size[1]);
        u64::from(self.stored.first_list) + texels
    }

    /// What makes it, of a region whose rows are `region`; `view`: what its eye sees.
    pub fn stage(&self, region: layout::Region, view: layout::View) -> layout::StoredStage {
        let &Self { grid, bounds, stored, .. } = self;
        let (kind, near, far) = stored.numbers();
        layout::StoredStage {
            view,
            region,
            pixels_per_texel: grid.pixels_per_texel(),
            origin: grid.shift(bounds.origin).map(|texels| -texels),
            width: stored.width(bounds.size[0]),
            height: bounds.size[1],
            layers: stored.layers,
            first: stored.first,
            kind,
            near,
            far,
            first_list: stored.first_list,
            excess: stored.excess,
            pad_0: [0; 3],
        }
    }

    /// What lists the crossings of the solids of its region, whose sprite is `stage`, on a target of `target` texels; `room`: how many
    /// crossings there is room for.
    pub fn list_stages(
        &self,
        own_view: &View,
        stage: &layout::StoredStage,
        target: [u32; 2],
        room: u64,
    ) -> Vec<layout::ListStage> {
        let (clip_scale, shift) = (self.grid.clip_scale(target), self.grid.shift(self.bounds.origin));
        // Texels count down the target, clip space up.
        let side = |i: usize| clip_scale[i] + 2.0 * shift[i] / target[i] as f32 - 1.0;
        let list = |(leaf, of): (u32, &PlacedLeaf)| layout::ListStage {
            view: stage.view,
            region: of.rows(own_view, &mut Vec::new()),
            clip_scale,
            clip_shift: [side(0), -side(1)],
            width: stage.width,
            height: stage.height,
            first_list: stage.first_list,
            leaf,
            room: room as u32,
            pad_0: [0; 3],
        };
        solids_of(self.region).map(list).collect()
    }

    /// Where a sprite of the picture's eye stands.
    pub fn place(&self, volume: &SeenVolume) -> layout::SpritePlace {
        let &Self { grid, bounds, stored, .. } = self;
        let (kind, near, far) = stored.numbers();
        layout::SpritePlace {
            origin: volume.bounds.origin.map(|o| o as i32),
            size: volume.bounds.size.map(|s| s as i32),
            texels_per_pixel: grid.texels_per_pixel(),
            sprite: bounds.origin.map(|o| -(o as f32)),
            page: 0,
            first: stored.first,
            width: stored.width(bounds.size[0]),
            layers: stored.layers,
            kind,
            near,
            far,
            own: 0,
        }
    }
}

/// The target on which crossings are listed: as large as the largest sprite that is made from lists.
pub(super) fn list_target(requests: &[BakeRequest]) -> [u32; 2] {
    let with_lists = requests.iter().filter_map(|m| solids_of(m.region).next().map(|_| m.bounds.size));
    with_lists.fold([0; 2], |all, size| std::array::from_fn(|i| all[i].max(size[i])))
}

/// The sprites of the picture's eye, for reading back.
pub(super) fn kept_sprites(requests: &[BakeRequest], view: &View) -> Vec<KeptSprite> {
    let kept = |m: &BakeRequest| KeptSprite {
        lens: m.lens,
        space: SpriteSpace { size: m.grid.size, ..SpriteSpace::of(view) },
        bounds: m.bounds,
        stored: m.stored,
        is_own: false,
    };
    requests.iter().filter(|m| m.own.is_none()).map(kept).collect()
}
