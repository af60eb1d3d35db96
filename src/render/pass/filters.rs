//! Neighbourhood filters: a lens' own image, unmasked, shaded over the lens' bounds and what the filter reaches beyond
//! them; then the filter down and across.
//!
//! Filters that read the same image have it shaded once, and uses that would make the same image share it. A filter reads
//! four pixels at once, so four are shaded at once.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        layout::{self, FilterStage},
        operations::Filter,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            shade::{ShadeKey, ShadeTarget, Shown},
        },
        picture_parts::{Piece, is_first, with_same_image},
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{
                DRAWN, GroupLayout, KeptGroup, LAYERED_NUMBERS, STAGE, STAGE_STRIDE, UNIFORM, all_of, group, one_of,
                strided, whole,
            },
            formats::FILTERED,
            key::{Draw, Parts, PipelineKey, Stage, target},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, scissor},
            synced::Synced,
            targets::Needs,
            vertices,
        },
    },
    shader::{Module, Program},
};

/// Group 0: the stage at a dynamic offset, the image, parameters.
static FILTER: GroupLayout = GroupLayout {
    label: "filter",
    entries: &[(0, DRAWN, STAGE), (1, S::FRAGMENT, LAYERED_NUMBERS), (2, DRAWN, UNIFORM)],
};

/// One direction of a neighbourhood filter, by its handler.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct FilterKey(u32);

impl PipelineKey for FilterKey {
    fn name(&self) -> String {
        Module::Filter(self.0).name()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Filter(self.0),
            groups: vec![Some(&FILTER)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                buffers: vec![vertices::picture_corners()],
                targets: vec![target(FILTERED, None); 4],
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// What shades the image that a filter reads: written out on either back end, a few steps without a lens.
fn image_key(plan: &FramePlan, filter: &Filter) -> ShadeKey {
    ShadeKey::new(plan, ShadeTarget::Unfiltered, Shown::Any, Program::Specialised(filter.plan.clone()))
}

/// The stages of a filter in a picture of this size: for each of its images down, and across.
fn stages_of(filter: &Filter, size: [u32; 2], images: usize) -> Vec<FilterStage> {
    let stage = |step, length, layers, layer: usize| FilterStage {
        step,
        reach: filter.reach as i32,
        first: filter.parameters,
        length: length as i32,
        layers,
        layer: layer as i32,
        pad_0: 0,
    };
    (0..images).flat_map(|image| [stage([0, 1], size[1], 1, image), stage([1, 0], size[0], 4, 0)]).collect()
}

fn lenses_of(filter: &Filter) -> impl Iterator<Item = u32> {
    filter.uses.iter().filter_map(|(lens, _)| *lens)
}

/// What the pass keeps: stages, and groups for the ways down and across.
#[derive(Debug)]
pub struct Filters {
    stages: Synced,
    down: KeptGroup,
    across: KeptGroup,
}

/// A pass over the parts of one image.
struct ImagePass<'a> {
    name: &'static str,
    lenses: &'a [u32],
    into: &'a [wgpu::TextureView],
    pieces: &'a [Piece],
}

impl ImagePass<'_> {
    fn record(self, frame: &FrameContext, recording: &mut Recording, set: impl FnOnce(&mut wgpu::RenderPass)) {
        // Every texel that is read with any weight is written first.
        let colors: Vec<_> = self.into.iter().map(|view| Some(kept(view))).collect();
        let pass = DrawnPass {
            name: self.name,
            view: "main",
            lenses: self.lenses,
            shaded: Shaded::Counted,
            colors: &colors,
            depth: None,
        };
        recording.draw(pass, |pass| {
            set(pass);
            pass.set_vertex_buffer(0, frame.shared.mesh.buffer().slice(..));
            let mut counted = Counted::NONE;
            for (corners, tile) in self.pieces.iter().filter(|(_, tile)| !tile.is_empty()) {
                scissor(pass, *tile);
                pass.draw(corners.clone(), 0..1);
                counted += Counted::corners(corners.len() as u32);
            }
            counted
        });
    }
}

impl Filters {
    fn fit_groups(&mut self, frame: &FrameContext) {
        let FrameContext { gpu, pipelines, shared, targets, .. } = *frame;
        let made = |image| {
            let entries = [
                (0, one_of::<layout::FilterStage>(&self.stages)),
                (1, all_of(image)),
                (2, whole(shared.parameters.buffer())),
            ];
            group(gpu, "filter", &pipelines.layout(&FILTER), &entries)
        };
        self.down.fit(shared.stamp, || made(&targets.unfiltered));
        self.across.fit(shared.stamp, || made(&targets.half_filtered));
    }

    /// The image `image` of the filter `k`, down and across.
    fn filter(&self, frame: &FrameContext, recording: &mut Recording, k: usize, image: usize) {
        let (plan, targets) = (frame.plan, frame.targets);
        let (filter, parts) = (&plan.plans.filters[k], &plan.parts.filters[k]);
        let lenses: Vec<u32> = lenses_of(filter).collect();
        let number = k * plan.input.behind().images() + image;
        let made = &targets.filtered.layers[4 * number..4 * number + 4];
        let mut pass = |name, group: &KeptGroup, direction: usize, into, pieces| {
            let offset = ((2 * number + direction) as u64 * STAGE_STRIDE) as u32;
            ImagePass { name, lenses: &lenses, into, pieces }.record(frame, recording, |pass| {
                pass.set_pipeline(frame.pipelines.get(&FilterKey(filter.effect)));
                pass.set_bind_group(0, group.get(), &[offset]);
            });
        };
        pass("filter down", &self.down, 0, &targets.half_filtered.layers, &parts.down);
        pass("filter across", &self.across, 1, made, &parts.across);
    }
}

impl Pass for Filters {
    type Input<'a> = &'a [Filter];

    const LIST: &'static [Line] = &[
        (
            "unfiltered",
            "for each neighbourhood filter in view: its lens' own image over the lens' bounds and what the filter reaches beyond them,",
        ),
        ("filter down", "and the filter, down"),
        ("filter across", "and across"),
    ];

    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let stages = Synced::new(gpu, "filter stages", wgpu::BufferUsages::UNIFORM)?;
        Ok(Self { stages, down: KeptGroup::default(), across: KeptGroup::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a [Filter]> {
        let filters = &plan.plans.filters[..];
        (!filters.is_empty()).then_some(filters)
    }

    fn add_needs(filters: &&[Filter], plan: &FramePlan, needs: &mut Needs) {
        needs.filters = filters.len() as u32;
        needs.filter_images = plan.input.behind().images() as u32;
    }

    fn add_keys(&self, input: Option<&&[Filter]>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        let filters = input.copied().unwrap_or_default();
        keys.add_programs(22, filters.iter().map(|filter| image_key(plan, filter)));
        keys.add(31, filters.iter().map(|filter| FilterKey(filter.effect)));
    }

    fn prepare(&mut self, filters: &&[Filter], stage: &mut Preparing) -> Result<(), GpuError> {
        let input = stage.plan.input;
        let stages = filters.iter().flat_map(|f| stages_of(f, input.tile.size, input.behind().images()));
        let bytes: Vec<u8> = stages.flat_map(|stage| strided(&stage)).collect();
        if self.stages.sync(stage.gpu, &bytes)? {
            self.down.forget();
            self.across.forget();
        }
        Ok(())
    }

    fn record(
        &mut self,
        filters: &&[Filter],
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        self.fit_groups(frame);
        let FrameContext { targets, groups, plan, .. } = *frame;
        let images = plan.input.behind().images();
        // A filter reads no image that a later one makes: those that read the same image may as well come first.
        for i in (0..filters.len()).filter(|&i| is_first(filters, i)) {
            let lenses: Vec<u32> = with_same_image(filters, i).flat_map(|k| lenses_of(&filters[k])).collect();
            let pass = ImagePass {
                name: "unfiltered",
                lenses: &lenses,
                into: &targets.unfiltered.layers[..images],
                pieces: &plan.parts.filters[i].unfiltered,
            };
            pass.record(frame, recording, |pass| {
                pass.set_pipeline(frame.pipelines.get(&image_key(plan, &filters[i])));
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.shade, &[]);
                pass.set_bind_group(2, &groups.lenses, &[]);
            });
            for k in with_same_image(filters, i) {
                (0..images).for_each(|image| self.filter(frame, recording, k, image));
            }
        }
        Ok(())
    }
}
