//! Sections: where lenses lay closed shells open, their volumes' surfaces close them again (`pass/sections.wgsl`).

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cities::DrawnSection,
        city::{Chunk, draws_of},
        layout,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::{CutBy, draw_runs, visible},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{GroupLayout, STAGE_STRIDE, STORED_STAGE, WRITTEN, group, one_of, strided, whole},
            formats::{COLORS, OWN_DEPTH, SMOOTH_CODES},
            key::{Draw, Parts, PipelineKey, Stage, depth_test},
            layouts::{CUT_CITY, LENSES, VIEW},
            pipelines::Pipelines,
            recording::{Counted, DrawnPass, Recording, Shaded, kept, kept_depth, read_depth, scissor},
            synced::{Room, Synced},
            vertices,
        },
        section_rounds::{SectionRound, rounds},
    },
    shader::{Module, Program},
};

/// Group 3: the stage at a dynamic offset, and the ends of rays.
static SECTIONS: GroupLayout =
    GroupLayout { label: "sections", entries: &[(0, S::FRAGMENT, STORED_STAGE), (1, S::FRAGMENT, WRITTEN)] };

/// What of a pixel the GPU keeps, bytes: `SectionPixel` of `pass/sections.wgsl`.
const PIXEL_BYTES: u64 = 8;

/// The draws of `pass/sections.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum SectionDraw {
    /// Where volumes end.
    Ends,
    /// How many shells are there.
    Count,
    /// The sections; whether interpolated depth is written, for the AOV.
    Fill { measured: bool },
}

/// One of the draws that make sections, and what is hidden.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct SectionKey {
    program: Program,
    draw: SectionDraw,
}

impl PipelineKey for SectionKey {
    fn name(&self) -> String {
        let draw = match self.draw {
            SectionDraw::Ends => "ends",
            SectionDraw::Count => "count",
            SectionDraw::Fill { measured: false } => "fill",
            SectionDraw::Fill { measured: true } => "fill measured",
        };
        format!("{} {draw}", Module::Sections(self.program.clone()).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let draw = match self.draw {
            SectionDraw::Ends => Draw {
                depth: Some(depth_test(wgpu::CompareFunction::Always, false)),
                ..Draw::new("vertex_everywhere", Some("ends"))
            },
            SectionDraw::Count => Draw {
                buffers: vec![vertices::city()],
                depth: Some(depth_test(wgpu::CompareFunction::Always, false)),
                ..Draw::new("vertex", Some("count"))
            },
            SectionDraw::Fill { measured } => {
                let own_depth = measured.then(|| Some(OWN_DEPTH.into()));
                Draw {
                    targets: [Some(SMOOTH_CODES.into()), Some(COLORS.into())].into_iter().chain(own_depth).collect(),
                    depth: Some(depth_test(wgpu::CompareFunction::Greater, true)),
                    ..Draw::new("vertex_everywhere", Some("fill"))
                }
            }
        };
        Parts {
            module: Module::Sections(self.program.clone()),
            groups: vec![Some(&VIEW), Some(&CUT_CITY), Some(&LENSES), Some(&SECTIONS)],
            constants: Vec::new(),
            stage: Stage::Draw(draw),
        }
    }
}

/// The pipelines of sections: ends, count, fill.
fn keys_of(program: &Program, measured: bool) -> [SectionKey; 3] {
    [SectionDraw::Ends, SectionDraw::Count, SectionDraw::Fill { measured }]
        .map(|draw| SectionKey { program: program.clone(), draw })
}

/// What the GPU has of sections between frames.
#[derive(Debug)]
struct Kept {
    stages: Synced,
    pixels: Room,
    group: wgpu::BindGroup,
}

impl Kept {
    fn new(gpu: &Gpu, pipelines: &Pipelines) -> Result<Self, GpuError> {
        let stages = Synced::new(gpu, "stages of sections", wgpu::BufferUsages::STORAGE)?;
        let pixels = Room::new(gpu, "sections", wgpu::BufferUsages::STORAGE, "a smaller picture would do")?;
        let group = section_group(gpu, pipelines, &stages, &pixels);
        Ok(Self { stages, pixels, group })
    }
}

fn section_group(gpu: &Gpu, pipelines: &Pipelines, stages: &Synced, pixels: &Room) -> wgpu::BindGroup {
    let entries = [(0, one_of::<layout::SectionStage>(stages)), (1, whole(pixels.buffer()))];
    group(gpu, "sections", &pipelines.layout(&SECTIONS), &entries)
}

/// What the pass keeps, once there were sections.
#[derive(Debug)]
pub struct Sections(Option<Kept>);

/// One end of one volume, and what closes it.
struct RoundDraw<'a> {
    round: &'a SectionRound,
    offset: u32,
    keys: &'a [SectionKey; 3],
    own: &'a wgpu::BindGroup,
    by: CutBy<'a>,
}

impl RoundDraw<'_> {
    fn set(&self, frame: &FrameContext, pass: &mut wgpu::RenderPass, key: &SectionKey) {
        pass.set_pipeline(frame.pipelines.get(key));
        scissor(pass, self.round.part);
        pass.set_bind_group(0, &frame.groups.view, &[]);
        pass.set_bind_group(1, &frame.groups.cut_city, &[0; 2]);
        pass.set_bind_group(2, &frame.groups.lenses, &[]);
        pass.set_bind_group(3, self.own, &[self.offset]);
    }

    /// A pass that draws into storage alone.
    fn noting<'a>(&'a self, frame: &FrameContext<'a>, name: &'static str) -> DrawnPass<'a> {
        DrawnPass {
            name,
            view: "main",
            lenses: std::slice::from_ref(&self.round.lens),
            shaded: Shaded::Unmeasured,
            colors: &[],
            depth: Some(read_depth(&frame.targets.depth.view)),
        }
    }

    /// Finds where rays end. A pass of its own: what one draw stores, another of the same pass need not see.
    fn find_ends(&self, frame: &FrameContext, recording: &mut Recording) {
        recording.draw(self.noting(frame, "ends of lenses"), |pass| {
            self.set(frame, pass, &self.keys[0]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
    }

    /// Counts shells from all faces beyond the end.
    fn count(&self, frame: &FrameContext, recording: &mut Recording, sections: &[DrawnSection]) {
        recording.draw(self.noting(frame, "count sections"), |pass| {
            let mut counted = Counted::NONE;
            self.set(frame, pass, &self.keys[1]);
            for drawn in sections {
                let seen = visible(drawn, &frame.plan.input.view, Some(self.by.cut));
                let touches = |c: &&Chunk| self.round.reach.touches(&c.bounds, &frame.plan.input.view);
                let chunks: Vec<&Chunk> = seen.iter().map(|s| s.chunk).filter(touches).collect();
                if chunks.is_empty() {
                    continue;
                }
                pass.set_bind_group(1, &frame.groups.cut_city, &[drawn.offset; 2]);
                pass.set_vertex_buffer(0, drawn.section.vertices.slice(..));
                let (runs, triangles) = draws_of(chunks.into_iter().map(|chunk| chunk.range.clone()));
                draw_runs(pass, &drawn.section.indices, &runs);
                counted += Counted { draws: runs.len() as u32, triangles };
            }
            counted
        });
    }

    /// Draws the section where a shell is open.
    fn fill(&self, frame: &FrameContext, recording: &mut Recording) {
        let (targets, measured) = (frame.targets, frame.plan.input.measured);
        let colors = [
            Some(kept(&targets.codes.view)),
            Some(kept(&targets.colors.view)),
            measured.then(|| kept(&targets.own_depth.view)),
        ];
        let pass = DrawnPass {
            name: "sections",
            view: "main",
            lenses: &[self.round.lens],
            shaded: Shaded::Unmeasured,
            colors: &colors[..if measured { 3 } else { 2 }],
            depth: Some(kept_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            self.set(frame, pass, &self.keys[2]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
    }
}

impl Pass for Sections {
    type Input<'a> = Vec<SectionRound>;

    const LIST: &'static [Line] = &[
        ("ends of lenses", "where rays leave lenses that ask for sections, and enter them,"),
        ("count sections", "how many closed shells are laid open there,"),
        ("sections", "and the surface that closes them"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Vec<SectionRound>> {
        let rounds = rounds(plan.input, &plan.seen.volumes, plan.cuts.picture.as_ref());
        (!rounds.is_empty()).then_some(rounds)
    }

    fn add_keys(&self, _: Option<&Vec<SectionRound>>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let program = programs.made_for_picture.as_ref();
        if let Some(program) = program.filter(|p| plan.has_sections && p.regions().is_none()) {
            keys.add_programs(24, keys_of(program, plan.input.measured));
        }
    }

    fn prepare(&mut self, rounds: &Vec<SectionRound>, stage: &mut Preparing) -> Result<(), GpuError> {
        let own = match &mut self.0 {
            Some(own) => own,
            none => none.insert(Kept::new(stage.gpu, stage.pipelines)?),
        };
        let bytes: Vec<u8> = rounds.iter().flat_map(|round| strided(&round.stage)).collect();
        let pixels: u64 = stage.plan.input.tile.size.iter().map(|&side| u64::from(side)).product();
        let grown = [own.stages.sync(stage.gpu, &bytes)?, own.pixels.fit(stage.gpu, pixels * PIXEL_BYTES)?];
        if grown.contains(&true) {
            own.group = section_group(stage.gpu, stage.pipelines, &own.stages, &own.pixels);
        }
        Ok(())
    }

    fn record(
        &mut self,
        rounds: &Vec<SectionRound>,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let (Some(own), Some(by)) = (&self.0, CutBy::of_picture(frame)) else { return Ok(()) };
        let keys = keys_of(by.program, frame.plan.input.measured);
        let sections = frame.cities.drawn_sections(&frame.plan.details, Some(by.cut));
        for (i, round) in rounds.iter().enumerate().filter(|(_, round)| !round.part.is_empty()) {
            let offset = STAGE_STRIDE as u32 * i as u32;
            let draw = RoundDraw { round, offset, keys: &keys, own: &own.group, by };
            draw.find_ends(frame, recording);
            draw.count(frame, recording, &sections);
            draw.fill(frame, recording);
        }
        Ok(())
    }
}
