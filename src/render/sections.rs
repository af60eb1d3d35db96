//! Sections (L5): where lenses lay closed shells open, their volumes' surfaces close them again (`pass/sections.wgsl`).

use crate::{
    gpu::{Gpu, GpuError},
    lens::Class,
    render::{
        city::{Chunk, CityBuffers, draws_of},
        city_passes::draw_ranges,
        contents::DrawnSection,
        cut::Cut,
        eye::PictureTile,
        frame::{FrameInput, Recorder, color_attachment, read_depth, scissor, strided},
        hiding::Reach,
        key::{Key, SectionDraw},
        layout,
        operations::Operations,
        palette,
        renderer::{Renderer, group, whole},
        seen::SeenVolume,
        synced::{Room, Synced},
        volume::projected_box,
    },
    shader::{EffectKind, Program, handlers},
};

/// How often rays may leave a volume that is not convex, or enter it, and have a section there.
const TURNS: u32 = 4;
/// What of a pixel the card keeps, bytes: `SectionPixel` of `pass/sections.wgsl`.
const PIXEL_BYTES: u64 = 8;

/// One end of one volume.
#[derive(Clone, Debug)]
pub(super) struct SectionRound {
    /// Whose.
    lens: u32,
    /// Where it may be.
    part: PictureTile,
    reach: Reach,
    stage: layout::SectionStage,
}

/// What the card has of sections between frames.
#[derive(Debug)]
pub(super) struct SectionsOnGpu {
    stages: Synced,
    pixels: Room,
    group: wgpu::BindGroup,
}

/// Whether some lens of the scene asks for sections, in view or not, and hides something or shows something else.
pub(super) fn are_asked_for(input: &FrameInput) -> bool {
    input.volumes.iter().any(|v| v.section.is_some() && !ends_of(input.operations, v.lens).is_empty())
}

/// Of which of its ends a lens has sections: where rays leave it (`true`), where they enter it.
pub(super) fn ends_of(operations: &Operations, lens: u32) -> Vec<bool> {
    let hides = |effect: u32| handlers()[effect as usize].kind == EffectKind::Hide;
    let hidden = operations.list.iter().filter(|o| o.lens == Some(lens) && hides(o.effect)).map(|o| o.class);
    let hidden: Vec<Class> = hidden.collect();
    let shown: Vec<Class> = operations.contents.iter().filter(|c| c.lens == lens).map(|c| c.class).collect();
    // What is shown instead begins where its class does, and what is below it again where that ends.
    let is_one = |classes: &[Class], asked: &[Class]| classes.iter().any(|class| asked.contains(class));
    let leaves = hidden.contains(&Class::Inside) || is_one(&shown, &[Class::Inside, Class::Behind]);
    let enters = hidden.contains(&Class::Front) || is_one(&shown, &[Class::Inside, Class::Front]);
    [(true, leaves), (false, enters)].into_iter().filter(|(_, is_one)| *is_one).map(|(end, _)| end).collect()
}

/// The ends of a frame's volumes at which something may be laid open.
pub(super) fn rounds(input: &FrameInput, seen: &[SeenVolume], cut: Option<&Cut>) -> Vec<SectionRound> {
    let Some(cut) = cut else { return Vec::new() };
    let mut rounds = Vec::new();
    for (number, of_seen) in seen.iter().enumerate() {
        let volume = &input.volumes[of_seen.index];
        let Some(color) = volume.section else { continue };
        if !cut.hiding.lenses.contains(&volume.lens) || !volume.body.is_bounded() {
            continue;
        }
        let (view, bounds) = (&input.view, volume.bounds);
        let reach = projected_box(view, &bounds).map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high));
        let middle = bounds.center() - view.camera.eye;
        let center = [middle.dot(view.basis.right), middle.dot(view.basis.up), -view.depth(bounds.center())];
        let radius = 1.01 * bounds.center().distance(bounds.max);
        // What a file's sprite holds need not be convex.
        let intervals = volume.body.most_intervals().filter(|_| volume.body.saved().is_none());
        let turns = intervals.map_or(TURNS, |most| TURNS.min(most as u32));
        for leaves in ends_of(input.operations, volume.lens) {
            rounds.extend((0..turns).map(|turn| SectionRound {
                lens: volume.lens,
                part: of_seen.bounds,
                reach: reach.clone(),
                stage: layout::SectionStage {
                    center: center.map(|x| x as f32),
                    radius: radius as f32,
                    color: palette::linear(color),
                    volume: number as u32,
                    leaves: u32::from(leaves),
                    turn,
                    has_forms: u32::from(intervals.is_some()),
                    pad_0: 0,
                },
            }));
        }
    }
    rounds
}

/// The pipelines of sections.
pub(super) fn keys(program: &Program, measured: bool) -> [Key; 3] {
    [SectionDraw::Ends, SectionDraw::Count, SectionDraw::Fill { measured }]
        .map(|draw| Key::Section { program: program.clone(), draw })
}

impl Renderer {
    /// Makes room for the sections of a frame.
    pub(super) fn fit_sections(&mut self, size: [u32; 2], rounds: &[SectionRound]) -> Result<(), GpuError> {
        if rounds.is_empty() {
            return Ok(());
        }
        let gpu = &self.gpu;
        let mut own = match self.sections.take() {
            Some(own) => own,
            None => {
                let stages = Synced::new(gpu, "stages of sections", wgpu::BufferUsages::STORAGE)?;
                let pixels = Room::new(gpu, "sections", wgpu::BufferUsages::STORAGE, "a smaller picture would do")?;
                let group = section_group(gpu, &self.pipelines.layouts.sections, &stages, &pixels);
                SectionsOnGpu { stages, pixels, group }
            }
        };
        let stages: Vec<u8> = rounds.iter().flat_map(|round| strided(&round.stage)).collect();
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let grown = [own.stages.sync(gpu, &stages)?, own.pixels.fit(gpu, pixels * PIXEL_BYTES)?];
        if grown.contains(&true) {
            own.group = section_group(gpu, &self.pipelines.layouts.sections, &own.stages, &own.pixels);
        }
        self.sections = Some(own);
        Ok(())
    }

    /// Closes what lenses lay open.
    pub(super) fn section_passes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        rounds: &[SectionRound],
        (cut, program): (&Cut, &Program),
    ) {
        let (Some(targets), Some(groups), Some(own)) = (&self.targets, &self.groups, &self.sections) else { return };
        let [ends, count, fill] = keys(program, input.measured);
        let frustum = input.view.frustum(1.0);
        let sections = self.drawn_sections(Some(cut));
        for (i, round) in rounds.iter().enumerate().filter(|(_, round)| !round.part.is_empty()) {
            let offset = strided(&round.stage).len() as u32 * i as u32;
            let begin = |pass: &mut wgpu::RenderPass, key: &Key| {
                pass.set_pipeline(self.pipelines.get(key));
                scissor(pass, round.part);
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.cut_city, &[0; 2]);
                pass.set_bind_group(2, &groups.lenses, &[]);
                pass.set_bind_group(3, &own.group, &[offset]);
            };
            let slot = recorder.begin("count sections", "main", &[round.lens], false);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("count sections"),
                depth_stencil_attachment: Some(read_depth(&targets.depth.view)),
                timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
                ..Default::default()
            });
            begin(&mut pass, &ends);
            pass.draw(0..3, 0..1);
            let mut counted = (1, 1);
            begin(&mut pass, &count);
            for drawn in &sections {
                let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, Some(cut), &input.view));
                let seen = CityBuffers::visible(shown, &frustum, input.view.camera.eye);
                let chunks = seen.iter().map(|s| s.chunk).filter(|c| round.reach.touches(&c.bounds, &input.view));
                let chunks: Vec<&Chunk> = chunks.collect();
                if chunks.is_empty() {
                    continue;
                }
                let DrawnSection { section, offset, .. } = drawn;
                pass.set_bind_group(1, &groups.cut_city, &[*offset; 2]);
                pass.set_vertex_buffer(0, section.vertices.slice(..));
                let (draws, triangles) = draws_of(chunks.into_iter());
                draw_ranges(&mut pass, &section.indices, &draws);
                counted = (counted.0 + draws.len() as u32, counted.1 + triangles);
            }
            drop(pass);
            recorder.count(counted.0, counted.1);
            let slot = recorder.begin("sections", "main", &[round.lens], false);
            let kept = |view| {
                let mut attachment = color_attachment(view, wgpu::Color::TRANSPARENT);
                attachment.ops.load = wgpu::LoadOp::Load;
                Some(attachment)
            };
            let colors = [
                kept(&targets.codes.view),
                kept(&targets.colors.view),
                input.measured.then(|| kept(&targets.own_depth.view)).flatten(),
            ];
            let operations = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("sections"),
                color_attachments: &colors[..if input.measured { 3 } else { 2 }],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &targets.depth.view,
                    depth_ops: Some(operations),
                    stencil_ops: None,
                }),
                timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
                ..Default::default()
            });
            begin(&mut pass, &fill);
            pass.draw(0..3, 0..1);
            drop(pass);
            recorder.count(1, 1);
        }
    }
}

fn section_group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, stages: &Synced, pixels: &Room) -> wgpu::BindGroup {
    let stage = wgpu::BufferBinding {
        buffer: stages.buffer(),
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<layout::SectionStage>() as u64),
    };
    let entries = [(0, wgpu::BindingResource::Buffer(stage)), (1, whole(pixels.buffer()))];
    group(gpu, "sections", layout, &entries)
}
