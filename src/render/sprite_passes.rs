//! The passes that tell the sides of solids and combinations, by sprites of where rays enter first and leave last (S1).

use crate::{
    render::{
        body::{Body, PlacedLeaf},
        eye::PictureTile,
        frame::{FrameInput, Recorder, color_attachment, depth_attachment, scissor},
        key::Key,
        layout,
        renderer::{Renderer, STAGE_STRIDE},
        seen::{Kept, SeenSprite, SeenVolume},
        sprites::Place,
    },
    shader::VolumeTest,
    view::View,
};

/// The draws that make the depth sprites of solids and combinations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SolidStage {
    /// Nothing is there yet.
    Missed,
    /// Where rays enter first.
    Nearest,
    /// Where they leave last.
    Farthest,
    /// Of a combination, where rays enter first by the ends of its closed forms.
    NearestForm,
    /// Where they leave last.
    FarthestForm,
    /// Of a combination, where rays enter first through faces of its solids.
    NearestFace,
    /// Where they leave last.
    FarthestFace,
}

impl SolidStage {
    /// Whether it writes where rays enter.
    pub fn is_nearest(self) -> bool {
        matches!(self, Self::Nearest | Self::NearestForm | Self::NearestFace)
    }
}

/// The pipelines that make the sprite of a body.
pub(super) fn keys(body: &Body) -> Vec<Key> {
    let solid = [SolidStage::Missed, SolidStage::Nearest, SolidStage::Farthest];
    match body {
        Body::One(_) => solid.map(Key::SolidSprite).to_vec(),
        Body::Combined(_) => {
            let kinds = body.kinds();
            let forms = [SolidStage::NearestForm, SolidStage::FarthestForm].into_iter();
            let faces = [SolidStage::NearestFace, SolidStage::FarthestFace].into_iter();
            let wanted = forms.chain(faces.filter(|_| kinds.contains(&VolumeTest::Solid)));
            let keys = wanted.map(|stage| Key::CombinedSprite(stage, kinds.clone()));
            std::iter::once(Key::SolidSprite(SolidStage::Missed)).chain(keys).collect()
        }
    }
}

/// The leaves of a body that have draws of their own: the solids of a combination, by their places in it.
fn own_draws(body: &Body) -> impl Iterator<Item = (u32, &PlacedLeaf)> {
    let is_combined = matches!(body, Body::Combined(_));
    (0..).zip(body.leaves()).filter(move |(_, leaf)| is_combined && leaf.leaf.test() == VolumeTest::Solid)
}

/// A volume whose sides a sprite tells, with the sprite and its place.
pub(super) fn on_page(volume: &SeenVolume) -> Option<(&SeenVolume, &SeenSprite, Place)> {
    match volume.sprite.as_ref()? {
        sprite @ SeenSprite { kept: Kept::Page(place), .. } => Some((volume, sprite, *place)),
        _ => None,
    }
}

/// What makes a sprite, one stage for the body and one for each solid of a combination, and where it then stands; on pages of
/// `page` texels.
pub(super) fn layouts(
    shape: layout::Shape,
    (volume, sprite, on): (&SeenVolume, &SeenSprite, Place),
    body: &Body,
    view: &View,
    tile: PictureTile,
    page: [u32; 2],
) -> (Vec<layout::SpriteStage>, layout::SpritePlace) {
    let scale: [f32; 2] = std::array::from_fn(|i| sprite.size[i] as f32 / tile.size[i] as f32);
    // From the sprite's own texels to those of its page.
    let shift: [f32; 2] = std::array::from_fn(|i| on.origin[i] as f32 - sprite.bounds.origin[i] as f32);
    // Texels count down the page, clip space up.
    let clip_scale: [f32; 2] = std::array::from_fn(|i| sprite.size[i] as f32 / page[i] as f32);
    let side = |i: usize| clip_scale[i] + 2.0 * shift[i] / page[i] as f32 - 1.0;
    let stage = |shape, leaf| layout::SpriteStage {
        shape,
        pixels_per_texel: scale.map(|s| 1.0 / s),
        origin: shift.map(|s| -s),
        clip_scale,
        clip_shift: [side(0), -side(1)],
        leaves: leaf,
    };
    let leaves = [shape.size_x as u32, shape.size_y as u32];
    let mut stages = vec![stage(shape, [leaves[0], leaves[1], 0, 0])];
    // A solid has no planes.
    let of_leaf =
        |(i, leaf): (u32, &PlacedLeaf)| stage(leaf.figures(view, &mut Vec::new()), [leaves[0], leaves[1], i, 0]);
    stages.extend(own_draws(body).map(of_leaf));
    let place = layout::SpritePlace {
        origin: volume.bounds.origin.map(|o| o as i32),
        size: volume.bounds.size.map(|s| s as i32),
        texels_per_pixel: scale,
        sprite: shift,
        page: on.page,
        ..bytemuck::Zeroable::zeroed()
    };
    (stages, place)
}

impl Renderer {
    /// Width and height of the pages, texels.
    pub(super) fn page_size(&self) -> [u32; 2] {
        self.targets.as_ref().map_or([1; 2], |t| [t.needs.sprites[0], t.needs.sprites[1]].map(|s| s.max(1)))
    }

    /// The sprites of the volumes in view that are tested by them, page by page: of closed forms in one draw; of solids and
    /// combinations what clears them, and then where rays enter first and leave last.
    pub(super) fn sprite_passes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        seen: &[SeenVolume],
        pages: u32,
    ) {
        let mut first_stage = 0;
        let mut draws: Vec<(u32, Draw)> = Vec::new();
        for (volume, sprite, place) in seen.iter().filter_map(on_page) {
            let body = &input.volumes[volume.index].body;
            let stage = first_stage;
            let mut add = |key, stage, corners| {
                draws.push((place.page, Draw { stage, key, lens: volume.lens, sprite, place, corners }));
            };
            // Inside of it, rays enter nowhere first.
            let enters = |of: SolidStage| !of.is_nearest() || !body.holds_eye(&input.view);
            match body {
                Body::One(leaf) => {
                    add(Key::SolidSprite(SolidStage::Missed), stage, 0..3);
                    for of in [SolidStage::Nearest, SolidStage::Farthest].into_iter().filter(|of| enters(*of)) {
                        add(Key::SolidSprite(of), stage, leaf.place.corners.clone());
                    }
                }
                Body::Combined(_) => {
                    add(Key::SolidSprite(SolidStage::Missed), stage, 0..3);
                    let kinds = body.kinds();
                    let key = |of| Key::CombinedSprite(of, kinds.clone());
                    let forms = [SolidStage::NearestForm, SolidStage::FarthestForm];
                    forms.into_iter().filter(|of| enters(*of)).for_each(|of| add(key(of), stage, 0..3));
                    for (i, (_, leaf)) in own_draws(body).enumerate() {
                        let faces = [SolidStage::NearestFace, SolidStage::FarthestFace];
                        for of in faces.into_iter().filter(|of| enters(*of)) {
                            add(key(of), stage + 1 + i, leaf.place.corners.clone());
                        }
                    }
                }
            }
            first_stage += 1 + own_draws(body).count();
        }
        for page in 0..pages {
            let passes = [
                ("depth sprites", None),
                ("depth sprites, nearest", Some(0.0)),
                ("depth sprites, farthest", Some(1.0)),
            ];
            for (name, clear) in passes {
                let is_here = |key: &Key| match key {
                    Key::SolidSprite(SolidStage::Missed) => clear.is_none(),
                    Key::SolidSprite(of) | Key::CombinedSprite(of, _) => {
                        clear == Some(if of.is_nearest() { 0.0 } else { 1.0 })
                    }
                    _ => false,
                };
                let here: Vec<&Draw> =
                    draws.iter().filter(|(p, draw)| *p == page && is_here(&draw.key)).map(|(_, draw)| draw).collect();
                if !here.is_empty() {
                    self.sprite_pass(encoder, recorder, page, name, clear, &here);
                }
            }
        }
    }

    fn sprite_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        page: u32,
        name: &'static str,
        depth: Option<f32>,
        draws: &[&Draw],
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let mut lenses: Vec<u32> = draws.iter().map(|d| d.lens).collect();
        lenses.dedup();
        let slot = recorder.begin(name, "main", &lenses, true);
        // Every texel that is read is written first.
        let mut kept = color_attachment(&targets.sprites.layers[page as usize], wgpu::Color::TRANSPARENT);
        kept.ops.load = wgpu::LoadOp::Load;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &[Some(kept)],
            depth_stencil_attachment: depth.map(|clear| depth_attachment(&targets.sprite_depth.view, clear)),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &groups.planes, &[]);
        if depth.is_some() {
            pass.set_vertex_buffer(0, self.buffers.solid_corners.buffer().slice(..));
        }
        for draw in draws {
            pass.set_pipeline(self.pipelines.get(&draw.key));
            pass.set_bind_group(2, &groups.sprite_stage, &[draw.stage as u32 * STAGE_STRIDE as u32]);
            scissor(&mut pass, PictureTile { origin: draw.place.origin, size: draw.sprite.bounds.size });
            pass.draw(draw.corners.clone(), 0..1);
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(draws.len() as u32, draws.iter().map(|d| u64::from(d.corners.end - d.corners.start) / 3).sum());
    }
}

/// A draw of a sprite pass.
struct Draw<'a> {
    /// Which of the stages.
    stage: usize,
    key: Key,
    lens: u32,
    sprite: &'a SeenSprite,
    place: Place,
    corners: std::ops::Range<u32>,
}
