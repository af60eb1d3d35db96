//! The numbers of a frame's lens volumes as shaders read them: regions, planes, and where depth sprites stand.

use crate::{
    render::{
        bake::BakeRequest,
        frame::FrameInput,
        layout,
        own_sprites::OwnSprites,
        seen::{Kept, SeenSprite, SeenVolume},
        sprites::Place,
    },
    shader::LensTest,
};

/// Numbers of the volumes of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct LensNumbers {
    /// Of each volume that is seen.
    pub regions: Vec<layout::Region>,
    /// Where the sprite of each stands; zeros where it has none.
    pub places: Vec<layout::SpritePlace>,
    /// Of each whose sides a sprite on a page tells.
    pub sides: Vec<layout::Region>,
    /// Of each sprite that is to be made.
    pub baked: Vec<layout::Region>,
    /// Planes of convex volumes, and other rows that regions name.
    pub planes: Vec<[f32; 4]>,
}

impl LensNumbers {
    /// Those of `seen` volumes, of which the requests of the picture's eye come first, and of the requests of other eyes.
    pub fn new(input: &FrameInput, seen: &[SeenVolume], requests: &[BakeRequest], own: &OwnSprites) -> Self {
        let mut numbers = Self::default();
        let mut of_seen = requests.iter();
        for volume in seen {
            numbers.add(input, volume, own, &mut of_seen);
        }
        // Those that have eyes of their own follow.
        for request in of_seen {
            let own_view = request.own.as_ref().unwrap_or(&input.view);
            numbers.baked.push(match request.region.is_form() {
                true => request.region.rows(own_view, &mut numbers.planes),
                false => request.region.combined_rows(own_view, &mut numbers.planes),
            });
        }
        numbers
    }

    fn add<'r>(
        &mut self,
        input: &FrameInput,
        volume: &SeenVolume,
        own: &OwnSprites,
        requests: &mut impl Iterator<Item = &'r BakeRequest<'r>>,
    ) {
        let region = &input.volumes[volume.index].region;
        let nowhere = bytemuck::Zeroable::zeroed();
        if volume.test == LensTest::OwnSprite {
            self.regions.push(own.rows(volume.index, &input.view, &mut self.planes));
            self.places.push(nowhere);
            return;
        }
        let is_listed = volume.test.is_sprite() && !region.is_form();
        let region = match is_listed {
            true => region.combined_rows(&input.view, &mut self.planes),
            false => region.rows(&input.view, &mut self.planes),
        };
        self.regions.push(layout::Region { test: volume.test.number(), ..region });
        match volume.sprite.as_ref().map(|sprite| (sprite, &sprite.kept)) {
            None => self.places.push(nowhere),
            Some((sprite, Kept::Page(on))) => {
                self.sides.push(region);
                self.places.push(place_on_page(volume, sprite, *on));
            }
            Some((_, Kept::Stored(_))) => {
                let Some(request) = requests.next() else { return };
                self.baked.push(region);
                self.places.push(request.place(volume));
            }
        }
    }
}

fn place_on_page(volume: &SeenVolume, sprite: &SeenSprite, on: Place) -> layout::SpritePlace {
    let shift = std::array::from_fn(|i| on.origin[i] as f32 - sprite.bounds.origin[i] as f32);
    layout::SpritePlace {
        origin: volume.bounds.origin.map(|o| o as i32),
        size: volume.bounds.size.map(|s| s as i32),
        texels_per_pixel: sprite.grid.texels_per_pixel(),
        sprite: shift,
        page: on.page,
        ..bytemuck::Zeroable::zeroed()
    }
}
