//! The city, region by region. Depth is kept from pass to pass, so that the nearest fragment of any region wins, and every pass writes
//! its number beside the code of the surface.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        city::{Chunk, draws_of},
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::{
                GeometryKey, OpaqueEye, REGION, SectionPart, add_cut_keys, add_whole_keys, draw_corners, draw_opaque,
                in_order, set_section, visible,
            },
        },
        plan::FramePlan,
        programs::Programs,
        regions::{RegionPass, RegionPasses},
        resource::{
            bindings::{STAGE_STRIDE, group, one_of, whole},
            formats::REGIONS,
            recording::{Counted, DrawnPass, Recording, Shaded, cleared, kept, kept_depth},
            synced::Synced,
        },
    },
    shader::{Program, Regions},
};

/// The number of each pixel's region, handed on.
#[derive(Debug)]
pub struct RegionMap(pub wgpu::TextureView);

/// What the GPU has of regions between frames.
#[derive(Debug)]
struct Kept {
    numbers: Synced,
    map: wgpu::Texture,
}

/// What the pass keeps, once a technique drew by regions.
#[derive(Debug)]
pub struct RegionGeometry(Option<Kept>);

impl RegionGeometry {
    /// Chunks that no lens reaches, and the others; all with what they are drawn by.
    fn parts<'a>(frame: &FrameContext<'a>, regions: &RegionPasses) -> [Vec<SectionPart<'a>>; 2] {
        let input = frame.plan.input;
        let [mut apart, mut reached] = [Vec::new(), Vec::new()];
        for drawn in frame.cities.drawn_sections(&frame.plan.details, None) {
            let seen = visible(&drawn, &frame.plan.input.view, None);
            // Layers of coplanar faces stay together: the later one wins where depths are equal.
            let is_layer = drawn.section.kind.is_layer();
            let is_reached = |chunk: &&Chunk| is_layer || regions.is_reached(&chunk.bounds, input);
            let (own, others) = seen.iter().map(|s| s.chunk).partition(is_reached);
            reached.push(SectionPart { drawn, chunks: own });
            apart.push(SectionPart { drawn, chunks: others });
        }
        [apart, reached]
    }
}

/// The passes over one region after the other.
struct RegionDraw<'a> {
    frame: &'a FrameContext<'a>,
    program: Program,
    view: wgpu::BindGroup,
    map: wgpu::TextureView,
}

impl RegionDraw<'_> {
    fn draw(&self, recording: &mut Recording, region: &RegionPass, parts: &[SectionPart], is_first: bool) {
        let FrameContext { targets, groups, plan, pipelines, .. } = *self.frame;
        let map = match is_first {
            true => cleared(&self.map, wgpu::Color::TRANSPARENT),
            false => kept(&self.map),
        };
        let pass = DrawnPass {
            name: "geometry of a region",
            view: "main",
            lenses: &region.lenses,
            shaded: Shaded::Counted,
            colors: &in_order([
                Some(kept(&targets.codes.view)),
                plan.colored.then(|| kept(&targets.colors.view)),
                plan.input.measured.then(|| kept(&targets.own_depth.view)),
                Some(map),
                plan.texels_emit.then(|| kept(&targets.emissions.view)),
            ]),
            depth: Some(kept_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            pass.set_bind_group(0, &self.view, &[region.number * STAGE_STRIDE as u32]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            let mut counted = Counted::NONE;
            for SectionPart { drawn, chunks } in parts {
                let key = GeometryKey::new(plan, &drawn.facts(), Some(self.program.clone()));
                set_section(self.frame, pass, drawn, key.holds_depth);
                pass.set_bind_group(1, &groups.cut_city, &[drawn.offset; 2]);
                pass.set_pipeline(pipelines.get(&key));
                let (runs, triangles) = draws_of(chunks.iter().map(|chunk| chunk.range.clone()));
                draw_corners(pass, &runs, 0, key.holds_depth);
                counted += Counted { draws: runs.len() as u32, triangles };
            }
            counted
        });
    }
}

impl Pass for RegionGeometry {
    type Input<'a> = &'a RegionPasses;

    const LIST: &'static [Line] = &[
        ("geometry", "where a technique goes by regions: chunks that no lens reaches, as ever"),
        (
            "geometry of a region",
            "for each region that may occur: chunks that may reach into it; fragments in other regions are discarded before visibility",
        ),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a RegionPasses> {
        plan.plans.regions.as_ref()
    }

    fn add_keys(&self, input: Option<&&RegionPasses>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let Some(regions) = input else { return };
        add_whole_keys(plan, keys);
        let by_region = Program::Specialised(regions.plan.clone());
        add_cut_keys(plan, programs.made_for_picture.as_ref().unwrap_or(&by_region), keys);
    }

    fn prepare(&mut self, regions: &&RegionPasses, stage: &mut Preparing) -> Result<(), GpuError> {
        let [width, height] = stage.plan.input.tile.size;
        if self.0.as_ref().is_none_or(|own| [own.map.width(), own.map.height()] != [width, height]) {
            self.0 = None;
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
            self.0 = Some(Kept {
                numbers: Synced::new(stage.gpu, "numbers of regions", wgpu::BufferUsages::UNIFORM)?,
                map: stage.gpu.texture("regions", [width, height, 1], 1, REGIONS, usage),
            });
        }
        let count = regions.plan.regions.as_ref().and_then(Regions::count).unwrap_or(0);
        let mut numbers = vec![0_u32; count as usize * STAGE_STRIDE as usize / 4];
        (0..).zip(numbers.chunks_mut(STAGE_STRIDE as usize / 4)).for_each(|(number, stage)| stage[0] = number);
        if let Some(own) = &mut self.0 {
            own.numbers.sync(stage.gpu, &numbers)?;
        }
        Ok(())
    }

    fn record(
        &mut self,
        regions: &&RegionPasses,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(own) = &self.0 else { return Ok(()) };
        let [apart, reached] = Self::parts(frame, regions);
        draw_opaque(frame, recording, &OpaqueEye::of_picture(frame), "geometry", &apart, None, true);
        let entries = [(0, whole(frame.shared.view.buffer())), (1, one_of::<[u32; 4]>(&own.numbers))];
        let map = own.map.create_view(&Default::default());
        let draw = RegionDraw {
            frame,
            program: Program::Specialised(regions.plan.clone()),
            view: group(frame.gpu, "region", &frame.pipelines.layout(&REGION), &entries),
            map: map.clone(),
        };
        let view = &frame.plan.input.view;
        let mut is_first = true;
        for region in &regions.passes {
            let is_in = |chunk: &&&Chunk| {
                region.reaches.iter().all(|any| any.iter().any(|reach| reach.touches(&chunk.bounds, view)))
            };
            let parts = reached.iter().map(|of| {
                let chunks = of.chunks.iter().filter(is_in).copied().collect();
                SectionPart { drawn: of.drawn, chunks }
            });
            let parts: Vec<SectionPart> = parts.filter(|part| !part.chunks.is_empty()).collect();
            if is_first || !parts.is_empty() {
                draw.draw(recording, region, &parts, is_first);
                is_first = false;
            }
        }
        board.put(RegionMap(map));
        Ok(())
    }
}
