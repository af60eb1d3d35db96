//! The depth sprites of lenses (S1, S4): what they are stored in, and the pass that makes them.

use glam::DVec3;

use crate::{
    geom::Aabb,
    gpu::GpuError,
    lens::{
        LensSprite, SpriteSpace,
        sprite::{DepthCode, Format, Mapping},
    },
    render::{
        body::{Body, PlacedLeaf},
        eye::PictureTile,
        frame::{FrameInput, Recorder, color_attachment},
        key::Key,
        layout,
        own_sprites::OwnSprites,
        renderer::Renderer,
        seen::{Kept, Seen, SeenSprite, SeenVolume},
        volume::LensVolume,
    },
    shader::VolumeTest,
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

    /// As the card knows its depth code: number, near and far plane.
    pub(super) fn numbers(&self) -> (u32, f32, f32) {
        let DepthCode { mapping, near_m, far_m, format } = self.code;
        (format as u32 | (mapping as u32) << 4, near_m as f32, far_m.min(1e30) as f32)
    }
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
    let (low, high) = match volume.body.is_bounded() {
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
    /// Layers that the sprite of a body takes.
    pub(super) fn layers_of(&self, body: &Body) -> u32 {
        if body.is_form() || self.aggregate {
            return 1;
        }
        body.most_intervals().map_or(self.layers, |most| self.layers.min(most as u32))
    }
}

/// The pipeline that makes the sprite of a body.
pub(super) fn key(body: &Body) -> Key {
    if body.is_form() { Key::StoredForm(body.test()) } else { Key::StoredLayers(body.leaf_kinds()) }
}

/// The pipelines that make the sprite of a body.
pub(super) fn keys(body: &Body) -> Vec<Key> {
    let lists = solids_of(body).next().map(|_| Key::SpriteList);
    std::iter::once(key(body)).chain(lists).collect()
}

/// The solids of a body whose crossings are listed, each with its number among the leaves.
fn solids_of(body: &Body) -> impl Iterator<Item = (u32, &PlacedLeaf)> {
    (0..).zip(body.leaves()).filter(|(_, leaf)| leaf.leaf.test() == VolumeTest::Solid)
}

/// Crossings that their numbers can count.
const MOST_CROSSINGS: u64 = (1 << 24) - 1;
/// Crossings per texel that there is room for at first.
const CROSSINGS_PER_TEXEL: u64 = 8;

/// Bytes between the stages of stored sprites.
pub(super) const STORED_STRIDE: u64 = 512;

/// A stage in its place.
pub(super) fn placed<T: bytemuck::Pod>(value: &T) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(value).to_vec();
    bytes.resize(STORED_STRIDE as usize, 0);
    bytes
}

/// A sprite that is to be made.
#[derive(Debug)]
pub(super) struct Making<'a> {
    /// Whose it is.
    pub lens: u32,
    /// What it is made of.
    pub body: &'a Body,
    /// Width and height of the whole sprite, texels, and the part of it that is kept.
    pub size: [u32; 2],
    pub bounds: PictureTile,
    /// How it is stored, and where.
    pub stored: Stored,
    /// Its own eye; `None`: the picture's.
    pub own: Option<View>,
}

/// The sprites of the picture's eye, all of which are made in every frame.
pub(super) fn makings<'a>(seen: &[SeenVolume], input: &FrameInput<'a>) -> Vec<Making<'a>> {
    let making = |v: &SeenVolume| match v.sprite.as_ref()? {
        &SeenSprite { size, bounds, kept: Kept::Stored(stored) } => {
            Some(Making { lens: v.lens, body: &input.volumes[v.index].body, size, bounds, stored, own: None })
        }
        _ => None,
    };
    seen.iter().filter_map(making).collect()
}

/// What lists the crossings of the solids of a body, whose sprite is `stage`, on a target of `target` texels.
pub(super) fn list_stages(
    making: &Making,
    (own_view, stage): (&View, &layout::StoredStage),
    target: [u32; 2],
    room: u64,
) -> Vec<layout::ListStage> {
    let clip_scale: [f32; 2] = std::array::from_fn(|i| making.size[i] as f32 / target[i] as f32);
    // Texels count down the target, clip space up.
    let side = |i: usize| clip_scale[i] - 2.0 * making.bounds.origin[i] as f32 / target[i] as f32 - 1.0;
    let list = |(leaf, of): (u32, &PlacedLeaf)| layout::ListStage {
        view: stage.view,
        shape: of.figures(own_view, &mut Vec::new()),
        clip_scale,
        clip_shift: [side(0), -side(1)],
        width: stage.width,
        height: stage.height,
        first_list: stage.first_list,
        leaf,
        room: room as u32,
        pad_0: [0; 3],
    };
    solids_of(making.body).map(list).collect()
}

/// The target on which crossings are listed: as large as the largest sprite that is made from lists.
pub(super) fn list_target(making: &[Making]) -> [u32; 2] {
    let with_lists = making.iter().filter_map(|m| solids_of(m.body).next().map(|_| m.bounds.size));
    with_lists.fold([0; 2], |all, size| std::array::from_fn(|i| all[i].max(size[i])))
}

/// What makes a sprite that its eye sees on a target of `target` pixels.
pub(super) fn stage(
    shape: layout::Shape,
    making: &Making,
    view: layout::View,
    target: [u32; 2],
) -> layout::StoredStage {
    let &Making { size, bounds, stored, .. } = making;
    let (kind, near, far) = stored.numbers();
    layout::StoredStage {
        view,
        shape,
        pixels_per_texel: std::array::from_fn(|i| target[i] as f32 / size[i] as f32),
        origin: bounds.origin.map(|o| o as f32),
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

/// Where a sprite of the picture's eye stands.
pub(super) fn place(volume: &SeenVolume, making: &Making, tile: PictureTile) -> layout::SpritePlace {
    let &Making { size, bounds, stored, .. } = making;
    let (kind, near, far) = stored.numbers();
    layout::SpritePlace {
        origin: volume.bounds.origin.map(|o| o as i32),
        size: volume.bounds.size.map(|s| s as i32),
        texels_per_pixel: std::array::from_fn(|i| size[i] as f32 / tile.size[i] as f32),
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
    /// Bytes that it takes on the card.
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

/// The sprites of the picture's eye.
pub(super) fn kept_sprites(making: &[Making], view: &View) -> Vec<KeptSprite> {
    let kept = |m: &Making| KeptSprite {
        lens: m.lens,
        space: SpriteSpace { size: m.size, ..SpriteSpace::of(view) },
        bounds: m.bounds,
        stored: m.stored,
        is_own: false,
    };
    making.iter().filter(|m| m.own.is_none()).map(kept).collect()
}

impl Renderer {
    /// The stored sprites of a lens as the last frame made them.
    pub fn read_sprites(&self, lens: u32) -> Result<Vec<SpriteTexels>, GpuError> {
        let own: Vec<&KeptSprite> = self.kept_sprites.iter().filter(|s| s.lens == lens).collect();
        if own.is_empty() {
            return Ok(Vec::new());
        }
        let bytes = self.gpu.read_buffer(self.buffers.sprites.buffer())?;
        let words: &[u32] = bytemuck::cast_slice(&bytes);
        let texels = |sprite: &&KeptSprite| {
            let KeptSprite { space, bounds, stored, .. } = **sprite;
            let [width, height] = bounds.size;
            let (bits, row) = (stored.code.format.bits(), stored.width(width));
            let code = |number: u32| {
                let word = words[(stored.first + number / (32 / bits)) as usize];
                if bits == 32 { word } else { word >> (bits * (number % (32 / bits))) & ((1 << bits) - 1) }
            };
            let texels = (0..height).flat_map(|y| (0..width).map(move |x| y * row + x));
            let layers = texels.flat_map(|texel| (0..stored.layers).map(move |layer| texel * stored.layers + layer));
            SpriteTexels {
                space,
                bounds,
                code: stored.code,
                layers: stored.layers,
                codes: layers.map(|layer| [code(2 * layer), code(2 * layer + 1)]).collect(),
                bytes: 4 * stored.words(bounds.size),
            }
        };
        Ok(own.iter().map(texels).collect())
    }

    /// Whether the last frame met more crossings than there was room for, and the next has room for them.
    pub fn makes_room(&mut self) -> Result<bool, GpuError> {
        if !self.lists_crossings {
            return Ok(false);
        }
        let bytes = self.gpu.read_buffer(self.buffers.counts.buffer())?;
        let met = u64::from(bytemuck::cast_slice::<u8, u32>(&bytes)[0]);
        let before = self.crossing_room;
        if met > before {
            self.own_sprites.forget();
            // And some more: the next frame meets about as many.
            self.crossing_room = (met + met / 8).min(MOST_CROSSINGS);
        }
        Ok(self.crossing_room > before)
    }

    /// Rays that have more intervals than their sprite has layers, by lens: of the sprites of the last frame's eye, and with `own`
    /// of those that have eyes of their own.
    pub fn read_excess(&self, own: bool) -> Result<Vec<(u32, u32)>, GpuError> {
        if self.kept_sprites.iter().all(|s| s.stored.excess == 0) {
            return Ok(Vec::new());
        }
        let bytes = self.gpu.read_buffer(self.buffers.counts.buffer())?;
        let counts: &[u32] = bytemuck::cast_slice(&bytes);
        let is_asked = |s: &&KeptSprite| own || !s.is_own;
        let excess = |s: &KeptSprite| (s.lens, if s.stored.excess == 0 { 0 } else { counts[s.stored.excess as usize] });
        Ok(self.kept_sprites.iter().filter(is_asked).map(excess).filter(|(_, rays)| *rays > 0).collect())
    }

    /// Makes room for the sprites of a frame, of which those with eyes of their own are needed for some volumes; all that are to
    /// be made.
    pub(super) fn fit_sprites<'a>(
        &mut self,
        seen: &Seen,
        input: &FrameInput<'a>,
        is_needed: impl Fn(usize) -> bool,
    ) -> Result<Vec<Making<'a>>, GpuError> {
        let (gpu, b) = (&self.gpu, &mut self.buffers);
        let mut stale = b.sprites.fit(gpu, 4 * seen.words)?;
        if seen.lists > 0 || self.own_sprites.counts() {
            let all = 1 + u64::from(self.own_sprites.room().1) + seen.volumes.len() as u64;
            stale |= b.counts.fit(gpu, 4 * all)?;
        }
        if stale {
            self.own_sprites.forget();
        }
        let mut making = makings(&seen.volumes, input);
        making.extend(self.own_sprites.to_make(input, is_needed, seen.lists));
        let lists = making.iter().filter(|m| !m.body.is_form()).map(|m| {
            let texels = u64::from(m.stored.width(m.bounds.size[0])) * u64::from(m.bounds.size[1]);
            u64::from(m.stored.first_list) + texels
        });
        let lists = lists.max().unwrap_or(0);
        stale |= b.lists.fit(gpu, 4 * lists)?;
        let target = list_target(&making);
        self.lists_crossings = target != [0; 2];
        if self.lists_crossings {
            self.crossing_room = self.crossing_room.max((CROSSINGS_PER_TEXEL * lists).min(MOST_CROSSINGS));
            stale |= b.crossings.fit(gpu, 8 * self.crossing_room)?;
            let has = self.list_target.as_ref().map_or([0; 2], |t| [t.texture().width(), t.texture().height()]);
            if (0..2).any(|i| has[i] < target[i]) {
                let side = |i: usize| has[i].max(target[i].next_multiple_of(64));
                let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
                let texture = gpu.texture("crossings of sprites", [side(0), side(1), 1], 1, LIST_TARGET, usage);
                self.list_target = Some(texture.create_view(&wgpu::TextureViewDescriptor::default()));
            }
        }
        if stale {
            self.groups = None;
        }
        Ok(making)
    }

    /// Width and height of the target on which crossings are listed, texels.
    pub(super) fn list_size(&self) -> [u32; 2] {
        self.list_target.as_ref().map_or([1; 2], |t| [t.texture().width(), t.texture().height()])
    }

    /// Lists the crossings of rays with the solids of lenses that have sprites.
    fn list_pass(&self, encoder: &mut wgpu::CommandEncoder, recorder: &mut Recorder, making: &[Making]) {
        if making.iter().all(|m| m.body.is_form()) {
            return;
        }
        encoder.clear_buffer(self.buffers.lists.buffer(), 0, None);
        // The counts of sprites that are kept stay.
        let counts = self.buffers.counts.buffer();
        let mut clear = |first: u32, count| encoder.clear_buffer(counts, 4 * u64::from(first), count);
        clear(0, Some(4));
        OwnSprites::counts_of(making).for_each(|own| clear(own, Some(4)));
        clear(1 + self.own_sprites.room().1, None);
        let solids: Vec<(u32, &PlacedLeaf)> =
            making.iter().flat_map(|m| solids_of(m.body).map(move |(_, leaf)| (m.lens, leaf))).collect();
        let (Some(groups), Some(target), false) = (&self.groups, &self.list_target, solids.is_empty()) else { return };
        let mut lenses: Vec<u32> = solids.iter().map(|(lens, _)| *lens).collect();
        lenses.dedup();
        let slot = recorder.begin("crossings of sprites", "main", &lenses, true);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("crossings of sprites"),
            color_attachments: &[Some(color_attachment(target, wgpu::Color::TRANSPARENT))],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_pipeline(self.pipelines.get(&Key::SpriteList));
        pass.set_vertex_buffer(0, self.buffers.solid_corners.buffer().slice(..));
        for (i, (_, leaf)) in solids.iter().enumerate() {
            pass.set_bind_group(2, &groups.stored, &[(i as u64 * STORED_STRIDE) as u32]);
            pass.draw(leaf.place.corners.clone(), 0..1);
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        let corners = |leaf: &PlacedLeaf| u64::from(leaf.place.corners.end - leaf.place.corners.start);
        recorder.count(solids.len() as u32, solids.iter().map(|(_, leaf)| corners(leaf) / 3).sum());
    }

    /// Makes the stored sprites of a frame.
    pub(super) fn stored_pass(&self, encoder: &mut wgpu::CommandEncoder, recorder: &mut Recorder, making: &[Making]) {
        let Some(groups) = &self.groups else { return };
        let mut lenses: Vec<u32> = making.iter().map(|m| m.lens).collect();
        if lenses.is_empty() {
            return;
        }
        lenses.dedup();
        self.list_pass(encoder, recorder, making);
        let lists: usize = making.iter().map(|m| solids_of(m.body).count()).sum();
        let slot = recorder.begin("stored depth sprites", "main", &lenses, false);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("stored depth sprites"),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.compute_writes(slot)),
        });
        pass.set_bind_group(1, &groups.planes, &[]);
        for (i, making) in making.iter().enumerate() {
            let [width, height] = making.bounds.size;
            let together = if making.stored.code.format == Format::Unorm8 { 2 } else { 1 };
            pass.set_pipeline(self.pipelines.get_compute(&key(making.body)));
            // After those of the lists.
            pass.set_bind_group(2, &groups.stored, &[((lists + i) as u64 * STORED_STRIDE) as u32]);
            pass.dispatch_workgroups(width.div_ceil(GROUP * together), height.div_ceil(GROUP), 1);
        }
    }
}

/// Nothing is written to it.
pub(super) const LIST_TARGET: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Side of a workgroup, as `pass/stored-sprite.wgsl` has it.
const GROUP: u32 = 8;
