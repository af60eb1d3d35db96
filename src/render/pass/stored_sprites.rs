//! The depth sprites that lenses are tested by: crossings of rays with solids, listed, and sprites made of these and of closed
//! forms.

use glam::DVec2;
use wgpu::ShaderStages as S;

use crate::{
    geom::shape::VolumeForm,
    gpu::{Gpu, GpuError},
    lens::sprite::Format,
    render::{
        bake::{BakeRequest, kept_sprites, list_target, solids_of},
        eye::{PictureTile, view_uniform},
        layout,
        own_sprites::OwnSprites,
        pass::context::{Board, FrameContext, Keys, Line, Pass, Preparing},
        placed_region::{PlacedLeaf, PlacedRegion},
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{COMPUTED, DRAWN, GroupLayout, KeptGroup, STAGE, WRITTEN, group, one_of, whole},
            formats::LIST_TARGET,
            key::{Draw, Parts, PipelineKey, Stage},
            layouts::PLANES,
            recording::{Counted, DrawnPass, Recording, Shaded, cleared},
            synced::{Room, Synced},
            vertices,
        },
        shared::{COARSER, Shared},
        stored::{KeptSprite, SpriteTexels},
    },
    shader::{Form, Module},
};

/// Group 2: the stage, at a dynamic offset, the sprites, lists of crossings, crossings, counts.
static STORED: GroupLayout = GroupLayout {
    label: "stored sprites",
    entries: &[
        (0, DRAWN.union(S::COMPUTE), STAGE),
        (1, S::COMPUTE, WRITTEN),
        (2, COMPUTED, WRITTEN),
        (3, COMPUTED, WRITTEN),
        (4, COMPUTED, WRITTEN),
    ],
};

/// Crossings that their numbers can count.
const MOST_CROSSINGS: u64 = (1 << 24) - 1;
/// Crossings per texel that there is room for at first.
const CROSSINGS_PER_TEXEL: u64 = 8;
/// Bytes between the stages of stored sprites.
const STORED_STRIDE: u64 = 512;
/// Side of a workgroup, as `pass/stored-sprite.wgsl` has it.
const GROUP: u32 = 8;

/// What makes sprites.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum StoredKey {
    /// That of a volume that has a closed form, by its kind.
    Form(VolumeForm),
    /// That of a lens of several leaves, or of a solid, and what the leaves are.
    Layers(Vec<Form>),
    /// Where rays go through the faces of its solids.
    List,
}

impl StoredKey {
    /// What makes the sprite of a region.
    fn of(region: &PlacedRegion) -> Self {
        match region.form().and_then(Form::closed) {
            Some(form) => Self::Form(form),
            None => Self::Layers(region.leaf_forms()),
        }
    }
}

impl PipelineKey for StoredKey {
    fn name(&self) -> String {
        match self {
            Self::Form(form) => format!("depth sprite of a {}", form.name()),
            Self::Layers(_) => "depth sprite in layers".to_owned(),
            Self::List => "crossings of a sprite".to_owned(),
        }
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let module = match self {
            Self::Form(form) => Module::StoredForm(*form),
            Self::Layers(forms) => Module::StoredLayers(forms.clone()),
            Self::List => {
                let unwritten =
                    wgpu::ColorTargetState { format: LIST_TARGET, blend: None, write_mask: wgpu::ColorWrites::empty() };
                return Parts {
                    module: Module::SpriteList,
                    groups: vec![None, None, Some(&STORED)],
                    constants: Vec::new(),
                    stage: Stage::Draw(Draw {
                        buffers: vec![vertices::solid_corners()],
                        targets: vec![Some(unwritten)],
                        ..Draw::new("vertex", Some("note"))
                    }),
                };
            }
        };
        let groups = vec![None, Some(&PLANES), Some(&STORED)];
        Parts { module, groups, constants: Vec::new(), stage: Stage::Compute("store") }
    }
}

/// What the pass keeps.
#[derive(Debug)]
pub struct StoredSprites {
    stages: Synced,
    /// Lists of crossings that layered sprites are made from, the crossings, and how many there are; then the rays of each
    /// sprite that have more intervals than layers.
    lists: Room,
    crossings: Room,
    counts: Room,
    group: KeptGroup,
    /// What crossings are drawn on, once there were some.
    list_target: Option<wgpu::TextureView>,
    /// The sprites of the last frame.
    kept: Vec<KeptSprite>,
    /// Whether the last frame listed crossings, and how many of them there is room for.
    lists_crossings: bool,
    crossing_room: u64,
}

/// A stage in its place.
fn placed<T: bytemuck::Pod>(value: &T) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(value).to_vec();
    bytes.resize(STORED_STRIDE as usize, 0);
    bytes
}

fn offset(stage: usize) -> u32 {
    (stage as u64 * STORED_STRIDE) as u32
}

impl StoredSprites {
    /// How much room there is for what is counted, bytes.
    pub fn count_bytes(&self) -> u64 {
        self.counts.buffer().size()
    }

    /// The stored sprites of a lens as the last frame made them.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn read(&self, gpu: &Gpu, shared: &Shared, lens: u32) -> Result<Vec<SpriteTexels>, GpuError> {
        let own: Vec<&KeptSprite> = self.kept.iter().filter(|s| s.lens == lens).collect();
        if own.is_empty() {
            return Ok(Vec::new());
        }
        let bytes = gpu.read_buffer(shared.sprites.buffer())?;
        let words: &[u32] = bytemuck::cast_slice(&bytes);
        Ok(own.iter().map(|sprite| texels_of(sprite, words)).collect())
    }

    /// Whether the last frame met more crossings than there was room for, and the next has room for them.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn makes_room(&mut self, gpu: &Gpu, own_sprites: &mut OwnSprites) -> Result<bool, GpuError> {
        if !self.lists_crossings {
            return Ok(false);
        }
        let bytes = gpu.read_buffer(self.counts.buffer())?;
        let met = u64::from(bytemuck::cast_slice::<u8, u32>(&bytes)[0]);
        let before = self.crossing_room;
        if met > before {
            own_sprites.forget();
            // And some more: the next frame meets about as many.
            self.crossing_room = (met + met / 8).min(MOST_CROSSINGS);
        }
        Ok(self.crossing_room > before)
    }

    /// Rays that have more intervals than their sprite has layers, by lens: of the sprites of the last frame's eye, and with `own`
    /// of those that have eyes of their own.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn read_excess(&self, gpu: &Gpu, own: bool) -> Result<Vec<(u32, u32)>, GpuError> {
        if self.kept.iter().all(|s| s.stored.excess == 0) {
            return Ok(Vec::new());
        }
        let bytes = gpu.read_buffer(self.counts.buffer())?;
        let counts: &[u32] = bytemuck::cast_slice(&bytes);
        let is_asked = |s: &&KeptSprite| own || !s.is_own;
        let excess = |s: &KeptSprite| (s.lens, if s.stored.excess == 0 { 0 } else { counts[s.stored.excess as usize] });
        Ok(self.kept.iter().filter(is_asked).map(excess).filter(|(_, rays)| *rays > 0).collect())
    }

    /// Makes room for what is listed.
    fn fit_lists(&mut self, gpu: &Gpu, requests: &[BakeRequest]) -> Result<bool, GpuError> {
        let lists = requests.iter().map(BakeRequest::lists_end).max().unwrap_or(0);
        let mut stale = self.lists.fit(gpu, 4 * lists)?;
        let target = list_target(requests);
        self.lists_crossings = target != [0; 2];
        if self.lists_crossings {
            self.crossing_room = self.crossing_room.max((CROSSINGS_PER_TEXEL * lists).min(MOST_CROSSINGS));
            stale |= self.crossings.fit(gpu, 8 * self.crossing_room)?;
            self.fit_target(gpu, target);
        }
        Ok(stale)
    }

    fn fit_target(&mut self, gpu: &Gpu, target: [u32; 2]) {
        let has = self.list_target.as_ref().map_or([0; 2], |t| [t.texture().width(), t.texture().height()]);
        if (0..2).any(|i| has[i] < target[i]) {
            let side = |i: usize| has[i].max(target[i].next_multiple_of(64));
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            let texture = gpu.texture("crossings of sprites", [side(0), side(1), 1], 1, LIST_TARGET, usage);
            self.list_target = Some(texture.create_view(&wgpu::TextureViewDescriptor::default()));
        }
    }

    /// Stages of the lists, and those of the sprites after them.
    fn stages(&self, plan: &FramePlan) -> Vec<u8> {
        let list_size = self.list_target.as_ref().map_or([1; 2], |t| [t.texture().width(), t.texture().height()]);
        let input = plan.input;
        let picture_view = plan.view_uniform();
        let (mut lists, mut stages) = (Vec::new(), Vec::new());
        for (request, shape) in plan.requests.iter().zip(&plan.numbers.baked) {
            let (own_view, uniform) = match &request.own {
                None => (&input.view, picture_view),
                Some(own) => {
                    let uniform = view_uniform(own, PictureTile::whole(own.size), DVec2::ZERO, 0, 0.0);
                    (own, uniform)
                }
            };
            let stage = request.stage(*shape, uniform);
            let own = request.list_stages(own_view, &stage, list_size, self.crossing_room);
            lists.extend(own.iter().flat_map(placed));
            stages.extend(placed(&stage));
        }
        [lists, stages].concat()
    }

    fn fit_group(&mut self, frame: &FrameContext) {
        let FrameContext { gpu, pipelines, shared, .. } = *frame;
        self.group.fit(shared.stamp, || {
            let entries = [
                (0, one_of::<layout::StoredStage>(&self.stages)),
                (1, whole(shared.sprites.buffer())),
                (2, whole(self.lists.buffer())),
                (3, whole(self.crossings.buffer())),
                (4, whole(self.counts.buffer())),
            ];
            group(gpu, "stored sprites", &pipelines.layout(&STORED), &entries)
        });
    }

    /// Lists the crossings of rays with the solids of lenses that have sprites.
    fn list(&self, requests: &[BakeRequest], frame: &FrameContext, recording: &mut Recording) {
        if requests.iter().all(|m| m.region.is_form()) {
            return;
        }
        recording.encoder.clear_buffer(self.lists.buffer(), 0, None);
        // The counts of sprites that are kept stay.
        let counts = self.counts.buffer();
        let mut clear = |first: u32, count| recording.encoder.clear_buffer(counts, 4 * u64::from(first), count);
        clear(0, Some(4));
        OwnSprites::counts_of(requests).for_each(|own| clear(own, Some(4)));
        clear(1 + frame.plan.own_sprites.room().counts, None);
        let solids: Vec<(u32, &PlacedLeaf)> =
            requests.iter().flat_map(|m| solids_of(m.region).map(move |(_, leaf)| (m.lens, leaf))).collect();
        let (Some(target), false) = (&self.list_target, solids.is_empty()) else { return };
        let mut lenses: Vec<u32> = solids.iter().map(|(lens, _)| *lens).collect();
        lenses.dedup();
        let pass = DrawnPass {
            name: "crossings of sprites",
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            colors: &[Some(cleared(target, wgpu::Color::TRANSPARENT))],
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(frame.pipelines.get(&StoredKey::List));
            pass.set_vertex_buffer(0, frame.shared.solid_corners.buffer().slice(..));
            let mut counted = Counted::NONE;
            for (i, (_, leaf)) in solids.iter().enumerate() {
                pass.set_bind_group(2, self.group.get(), &[offset(i)]);
                pass.draw(leaf.place.corners.clone(), 0..1);
                counted += Counted::corners(leaf.place.corners.end - leaf.place.corners.start);
            }
            counted
        });
    }
}

/// A sprite among the words of all.
fn texels_of(sprite: &KeptSprite, words: &[u32]) -> SpriteTexels {
    let KeptSprite { space, bounds, stored, .. } = *sprite;
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
}

impl Pass for StoredSprites {
    type Input<'a> = &'a [BakeRequest<'a>];

    const LIST: &'static [Line] = &[
        ("crossings of sprites", "of rays with the solids of lenses that have layered sprites"),
        (
            "stored depth sprites",
            "of the lens volumes in view that are tested by them, and those that have eyes of their own and are not there yet",
        ),
    ];

    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        Ok(Self {
            stages: Synced::new(gpu, "stages of stored sprites", U::UNIFORM)?,
            lists: Room::new(gpu, "lists of crossings", U::STORAGE | U::COPY_DST, COARSER)?,
            crossings: Room::new(gpu, "crossings", U::STORAGE, COARSER)?,
            counts: Room::new(gpu, "counts of sprites", U::STORAGE | U::COPY_DST | U::COPY_SRC, COARSER)?,
            group: KeptGroup::default(),
            list_target: None,
            kept: Vec::new(),
            lists_crossings: false,
            crossing_room: 0,
        })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a [BakeRequest<'a>]> {
        (!plan.requests.is_empty()).then_some(&plan.requests[..])
    }

    fn begin(&mut self, plan: &FramePlan) {
        self.lists_crossings = false;
        self.kept = kept_sprites(&plan.requests, &plan.input.view);
        self.kept.extend(plan.own_sprites.kept());
    }

    fn add_keys(&self, input: Option<&&[BakeRequest]>, _: &FramePlan, _: &Programs, keys: &mut Keys) {
        let keys_of = |request: &BakeRequest| {
            let lists = solids_of(request.region).next().map(|_| StoredKey::List);
            std::iter::once(StoredKey::of(request.region)).chain(lists)
        };
        keys.add(13, input.copied().into_iter().flatten().flat_map(keys_of));
    }

    fn prepare(&mut self, requests: &&[BakeRequest], stage: &mut Preparing) -> Result<(), GpuError> {
        let mut stale = self.counts.fit(stage.gpu, stage.plan.count_bytes)?;
        stale |= self.fit_lists(stage.gpu, requests)?;
        stale |= self.stages.sync(stage.gpu, &self.stages(stage.plan))?;
        if stale {
            self.group.forget();
        }
        Ok(())
    }

    fn record(
        &mut self,
        requests: &&[BakeRequest],
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        self.fit_group(frame);
        self.list(requests, frame, recording);
        let mut lenses: Vec<u32> = requests.iter().map(|m| m.lens).collect();
        lenses.dedup();
        let lists: usize = requests.iter().map(|m| solids_of(m.region).count()).sum();
        recording.compute("stored depth sprites", &lenses, |pass| {
            pass.set_bind_group(1, &frame.groups.planes, &[]);
            for (i, request) in requests.iter().enumerate() {
                let [width, height] = request.bounds.size;
                let together = if request.stored.code.format == Format::Unorm8 { 2 } else { 1 };
                pass.set_pipeline(frame.pipelines.get_compute(&StoredKey::of(request.region)));
                // After those of the lists.
                pass.set_bind_group(2, self.group.get(), &[offset(lists + i)]);
                pass.dispatch_workgroups(width.div_ceil(GROUP * together), height.div_ceil(GROUP), 1);
            }
            Counted::NONE
        });
        Ok(())
    }
}
