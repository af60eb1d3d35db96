//! K-buffer, peeling and weighted sums: the nearest layers of each pixel in slots (`lib/slots.wgsl`), then as lists for the pass that lays
//! the exact method's one over the other; what finds no slot as one layer (`lib/tail.wgsl`).

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        eye::PictureTile,
        layers::{LAYER_BYTES, LayerFigures, MethodFigures},
        layout,
        pass::{
            composite::{self, CompositeKey, HEADER, LayerLists, composite},
            context::{Board, FrameContext, Keys, Line, Pass},
            layering::{LayerPrograms, Layering, asks_most},
            translucent::draw_translucent,
            transparency::fragments::{FORWARD, FragmentKey, FragmentPass, SLOTS, Slots, slots_of},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{GroupLayout, STAGE, STAGE_STRIDE, WRITTEN, all_of, group, one_of, strided, whole},
            key::{Parts, PipelineKey, Stage},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared, kept, read_depth, scissor},
            synced::Synced,
            targets::Needs,
        },
    },
    shader::{Module, Program},
};

/// Group 0 of linking: lists and records, slots, the band at a dynamic offset.
static LINK_SLOTS: GroupLayout = GroupLayout {
    label: "slots as lists",
    entries: &[(0, S::COMPUTE, WRITTEN), (1, S::COMPUTE, WRITTEN), (2, S::COMPUTE, STAGE)],
};

/// Bytes of a pixel of the targets of what finds no slot.
const TAIL_BYTES: u64 = 20;

/// Slots as lists.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct LinkKey(Slots);

impl PipelineKey for LinkKey {
    fn name(&self) -> String {
        format!("{} ({})", Module::LinkSlots.name(), self.0.slots)
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::LinkSlots,
            groups: vec![Some(&LINK_SLOTS)],
            constants: self.0.constants().to_vec(),
            stage: Stage::Compute("link"),
        }
    }
}

/// What the GPU has of slots between frames.
#[derive(Debug)]
struct SlotLists {
    /// Heads and records of pixels, slots, and what is read of them.
    lists: LayerLists,
    /// Words of the slots of the largest band.
    words: u64,
    /// The bands, each at its offset, once for the first round of peeling and once for the others.
    bands: Synced,
}

impl SlotLists {
    fn slots(&self) -> wgpu::BindingResource<'_> {
        self.lists.nodes(self.words)
    }

    fn band(&self) -> wgpu::BindingResource<'_> {
        one_of::<BandStage>(&self.bands)
    }
}

/// A band, as `pass/link-slots.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct BandStage {
    origin: [u32; 2],
    size: [u32; 2],
    picture: [u32; 2],
    round: u32,
    reserved: u32,
}

/// A band, and where its stage is.
#[derive(Clone, Copy)]
struct Band {
    at: usize,
    tile: PictureTile,
}

impl Band {
    fn offset(self) -> u32 {
        (self.at as u64 * STAGE_STRIDE) as u32
    }
}

/// The parts of a region that so many pixels have room for, by whole rows.
fn bands_of(region: PictureTile, pixels: u64) -> Vec<PictureTile> {
    let rows = (pixels / u64::from(region.size[0].max(1))).clamp(1, u64::from(region.size[1].max(1))) as u32;
    let starts = (0..region.size[1]).step_by(rows as usize);
    let band = |y: u32| PictureTile {
        origin: [region.origin[0], region.origin[1] + y],
        size: [region.size[0], rows.min(region.size[1] - y)],
    };
    starts.map(band).collect()
}

/// What is translucent in a frame, and its slots.
#[derive(Clone, Debug)]
pub struct SlotInput<'a> {
    layering: Layering<'a>,
    slots: Slots,
}

/// What the pass keeps.
#[derive(Debug)]
pub struct SlotLayers {
    own: Option<SlotLists>,
    /// What the last frame had of them, and what the method took.
    pub figures: LayerFigures,
    pub method: MethodFigures,
}

impl SlotLayers {
    /// Gives back what it takes on the GPU.
    pub fn drop_lists(&mut self) {
        self.own = None;
    }

    /// Slots with room for the largest band of a region, and the bands.
    fn fitted(
        &mut self,
        frame: &FrameContext,
        region: PictureTile,
        slots: Slots,
    ) -> Result<(SlotLists, Vec<PictureTile>), GpuError> {
        let (gpu, plan) = (frame.gpu, frame.plan);
        let mut own = match self.own.take() {
            Some(own) => own,
            None => SlotLists {
                lists: LayerLists::new(gpu)?,
                words: 0,
                bands: Synced::new(gpu, "bands of layers", wgpu::BufferUsages::UNIFORM)?,
            },
        };
        let picture = plan.input.tile.size;
        let pixels = u64::from(picture[0]) * u64::from(picture[1]);
        own.lists.heads.fit(gpu, 4 * (HEADER + pixels * u64::from(1 + slots.record)))?;
        let of_pixel = 4 * u64::from(slots.slots * slots.words);
        let most = plan.settings.most_layers.map_or(LAYER_BYTES, |layers| 4 * u64::from(slots.words) * layers);
        let bands = bands_of(region, most.checked_div(of_pixel).unwrap_or(u64::MAX));
        let room = of_pixel * u64::from(region.size[0]) * u64::from(bands.first().map_or(0, |band| band.size[1]));
        own.lists.nodes.fit(gpu, room)?;
        own.words = room / 4;
        let rounds = |round| {
            let stage = move |band: &PictureTile| BandStage {
                origin: band.origin,
                size: band.size,
                picture,
                round,
                reserved: 0,
            };
            bands.iter().flat_map(move |band| strided(&stage(band)))
        };
        own.bands.sync(gpu, &rounds(0).chain(rounds(1)).collect::<Vec<u8>>())?;
        Ok((own, bands))
    }
}

/// What a frame runs.
struct Run<'a> {
    frame: &'a FrameContext<'a>,
    layering: &'a Layering<'a>,
    programs: LayerPrograms<'a>,
    slots: Slots,
    composite: CompositeKey,
    own: &'a SlotLists,
}

/// What was found over all bands.
#[derive(Default)]
struct Found {
    nodes: u64,
    left: u64,
    rounds: u32,
}

impl Run<'_> {
    /// Finds the nearest layers of the pixels of a band.
    fn fill(&self, recording: &mut Recording, band: Band, passes: &[FragmentPass]) {
        let FrameContext { gpu, targets, groups, shared, pipelines, plan, .. } = *self.frame;
        recording.encoder.clear_buffer(self.own.lists.nodes.buffer(), 0, None);
        let entries = [
            (0, whole(shared.view.buffer())),
            (1, whole(self.own.lists.heads.buffer())),
            (2, self.own.slots()),
            (3, all_of(&targets.depth)),
            (4, self.own.band()),
        ];
        let view = group(gpu, "slots of layers", &pipelines.layout(&SLOTS), &entries);
        for &of in passes {
            let pass = DrawnPass {
                name: of.name(),
                view: "main",
                lenses: self.layering.lenses(),
                shaded: Shaded::Counted,
                colors: &[],
                depth: Some(read_depth(&targets.depth.view)),
            };
            recording.draw(pass, |pass| {
                scissor(pass, band.tile);
                pass.set_bind_group(0, &view, &[band.offset()]);
                pass.set_bind_group(2, &groups.lenses, &[]);
                draw_translucent(
                    self.frame,
                    pass,
                    self.layering.cut,
                    false,
                    |s, _| FragmentKey::new(plan, self.programs, of, self.slots, s.kind.into(), s.is_smooth),
                    |pass, offset| pass.set_bind_group(1, &groups.cut_city, &[offset; 2]),
                )
            });
        }
    }

    /// Makes lists of the slots of a band, and counts what has none.
    fn link(&self, recording: &mut Recording, band: Band) {
        let FrameContext { gpu, pipelines, .. } = *self.frame;
        let entries = [(0, whole(self.own.lists.heads.buffer())), (1, self.own.slots()), (2, self.own.band())];
        let lists = group(gpu, "slots as lists", &pipelines.layout(&LINK_SLOTS), &entries);
        recording.compute("link slots", &[], |pass| {
            pass.set_pipeline(pipelines.get_compute(&LinkKey(self.slots)));
            pass.set_bind_group(0, &lists, &[band.offset()]);
            let groups = (band.tile.size[0] * band.tile.size[1]).div_ceil(64);
            let across = groups.min(32768);
            pass.dispatch_workgroups(across, groups.div_ceil(across), 1);
            Counted { draws: 1, triangles: 0 }
        });
    }

    /// What found no slot in a band, as one layer.
    fn lay_tail(&self, recording: &mut Recording, band: Band) {
        let FrameContext { gpu, targets, groups, shared, pipelines, plan, .. } = *self.frame;
        let entries = [
            (0, whole(shared.view.buffer())),
            (2, self.own.slots()),
            (4, self.own.band()),
            (5, one_of::<layout::City>(&shared.cities)),
        ];
        let view = group(gpu, "fragments", &pipelines.layout(&FORWARD), &entries);
        let [sums, through] = [&targets.tail_sums.view, &targets.tail_through.view];
        let colors = match band.at {
            0 => [cleared(sums, wgpu::Color::TRANSPARENT), cleared(through, wgpu::Color::WHITE)],
            _ => [kept(sums), kept(through)],
        };
        let pass = DrawnPass {
            name: FragmentPass::Tail.name(),
            view: "main",
            lenses: self.layering.lenses(),
            shaded: Shaded::Counted,
            colors: &colors.map(Some),
            depth: Some(read_depth(&targets.depth.view)),
        };
        let of = FragmentPass::Tail;
        recording.draw(pass, |pass| {
            scissor(pass, band.tile);
            pass.set_bind_group(1, &groups.shade, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            draw_translucent(
                self.frame,
                pass,
                self.layering.cut,
                false,
                |s, _| FragmentKey::new(plan, self.programs, of, self.slots, s.kind.into(), s.is_smooth),
                |pass, offset| pass.set_bind_group(0, &view, &[band.offset(), offset]),
            )
        });
    }

    /// How many layers there were so far, and how many found no slot. What was recorded is submitted.
    fn count(&self, recording: &mut Recording) -> Result<[u64; 2], GpuError> {
        self.own.lists.read_header(self.frame.gpu, recording, |bytes| {
            let [all, _, left] = bytemuck::pod_read_unaligned::<[u32; 3]>(&bytes[..12]);
            [all, left].map(u64::from)
        })
    }

    /// Finds out how many layers the pixel has that has most, over all bands.
    fn find_most(&self, recording: &mut Recording, bands: &[PictureTile]) {
        for (at, tile) in bands.iter().enumerate() {
            let band = Band { at, tile: *tile };
            self.fill(recording, band, &self.slots.passes()[..1]);
            self.link(recording, band);
        }
        // All but that is found again.
        recording.encoder.clear_buffer(self.own.lists.heads.buffer(), 0, Some(4));
        recording.encoder.clear_buffer(self.own.lists.heads.buffer(), 8, None);
    }

    /// Lays a band, round by round where it is peeled.
    fn lay_band(
        &self,
        recording: &mut Recording,
        bands: &[PictureTile],
        i: usize,
        found: &mut Found,
    ) -> Result<(), GpuError> {
        let slots = &self.slots;
        let mut round = 0;
        loop {
            let at = if round == 0 { i } else { bands.len() + i };
            let band = Band { at, tile: bands[i] };
            if slots.slots > 0 {
                self.fill(recording, band, slots.passes());
                self.link(recording, band);
            }
            if slots.has_tail() {
                self.lay_tail(recording, band);
            }
            let of_lists = composite::Band { tile: band.tile, words: self.own.words };
            composite(self.frame, recording, self.layering, &self.composite, &self.own.lists, of_lists);
            round += 1;
            if !slots.is_peeling() && i + 1 < bands.len() {
                break;
            }
            let [all, rest] = self.count(recording)?;
            found.nodes = all;
            recording.encoder.clear_buffer(self.own.lists.heads.buffer(), 8, Some(4));
            let is_over = slots.limit > 0 && round * slots.slots >= slots.limit;
            if is_over || rest == 0 || !slots.is_peeling() {
                found.left += rest;
                break;
            }
        }
        found.rounds += if slots.is_peeling() { round } else { 0 };
        Ok(())
    }
}

fn composite_key(plan: &FramePlan, program: &Program, slots: Slots) -> CompositeKey {
    CompositeKey { sorted: true, record: slots.record, tail: slots.has_tail(), ..CompositeKey::new(plan, program) }
}

impl Pass for SlotLayers {
    type Input<'a> = SlotInput<'a>;

    const LIST: &'static [Line] = &[
        ("slots, depths", "where the scene asks for a K-buffer or peeling: the nearest layers of each pixel,"),
        ("slots, codes", "which fragments these are,"),
        ("slots, rest", "and their normals and colours"),
        ("link slots", "slots as lists"),
        ("weighted", "what found no slot as one layer"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { own: None, figures: LayerFigures::default(), method: MethodFigures::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<SlotInput<'a>> {
        let (layering, slots) = Layering::of(plan).zip(slots_of(plan))?;
        Some(SlotInput { layering, slots })
    }

    fn begin(&mut self, _: &FramePlan) {
        (self.figures, self.method) = (LayerFigures::default(), MethodFigures::default());
    }

    fn add_needs(input: &SlotInput, plan: &FramePlan, needs: &mut Needs) {
        Layering::add_needs(plan, needs);
        needs.tails = input.slots.has_tail();
    }

    fn add_keys(&self, input: Option<&SlotInput>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let (Some(SlotInput { slots, .. }), Some(programs)) = (input, LayerPrograms::of(programs)) else { return };
        keys.add_programs(28, [composite_key(plan, programs.composite, *slots)]);
        let passes = slots.passes().iter().copied().chain(slots.has_tail().then_some(FragmentPass::Tail));
        for pass in passes {
            let key = |s: &crate::render::city_facts::SectionFacts| {
                FragmentKey::new(plan, programs, pass, *slots, s.kind.into(), s.is_smooth)
            };
            keys.add(30, plan.sections.iter().map(key));
        }
        keys.add(30, (slots.slots > 0).then_some(LinkKey(*slots)));
    }

    fn record(
        &mut self,
        input: &SlotInput,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let SlotInput { layering, slots } = input;
        let Some(programs) = LayerPrograms::of(frame.programs) else { return Ok(()) };
        layering.clear(frame, recording)?;
        let Some(region) = layering.region else { return Ok(()) };
        let (plan, slots) = (frame.plan, *slots);
        let (own, bands) = self.fitted(frame, region, slots)?;
        recording.encoder.clear_buffer(own.lists.heads.buffer(), 0, None);
        let composite = composite_key(plan, programs.composite, slots);
        let run = Run { frame, layering, programs, slots, composite, own: &own };
        // How many layers there are at most is known after the last band.
        if asks_most(plan) && bands.len() > 1 {
            run.find_most(recording, &bands);
        }
        let mut found = Found::default();
        for i in 0..bands.len() {
            run.lay_band(recording, &bands, i, &mut found)?;
        }
        let pixels: u64 = plan.input.tile.size.iter().map(|&side| u64::from(side)).product();
        let of_tail = if slots.has_tail() { pixels * TAIL_BYTES } else { 0 };
        self.method = MethodFigures {
            bytes: own.lists.bytes() + of_tail,
            rounds: found.rounds,
            dropped: if slots.is_peeling() { found.left } else { 0 },
            merged: (!slots.is_peeling() && slots.slots > 0).then_some(found.left),
        };
        self.figures = LayerFigures { nodes: found.nodes, bands: bands.len() as u32, excess: 0 };
        self.own = Some(own);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_a_region_once() {
        for (width, height, pixels) in [(10, 7, 20), (10, 7, 1), (10, 7, 70), (3, 1, 2), (1, 9, 4)] {
            let region = PictureTile { origin: [5, 6], size: [width, height] };
            let bands = bands_of(region, pixels);
            let mut next = 6;
            for band in &bands {
                assert_eq!((band.origin, band.size[0]), ([5, next], width));
                assert!(u64::from(band.size[1] * width) <= pixels.max(u64::from(width)) && band.size[1] > 0);
                next += band.size[1];
            }
            assert_eq!(next, 6 + height);
        }
    }
}
