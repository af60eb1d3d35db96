//! Edges as lines, where effects draw them: into a layer of their own, which shading lays over its picture.

use crate::{
    geom::Aabb,
    gpu::{Gpu, GpuError},
    lens::Class,
    render::{
        city_on_gpu::CityOnGpu,
        cut::Cut,
        edges::{Edge, EdgeBuffers, VERTICES},
        frame::FrameInput,
        hiding::{Reach, reaches_of},
        layout::{self, LineStage},
        pass::context::{Board, FrameContext, Keys, Line, Pass, Preparing},
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{DRAWN, GroupLayout, KeptGroup, STAGE, STAGE_STRIDE, group, one_of, strided},
            formats::LINES,
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, target},
            layouts::{LENSES, SHADE, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared, read_depth},
            synced::Synced,
            targets::Needs,
        },
        standing::{Placement, World},
    },
    shader::{BENT_PARTS, EffectDefinition, Module, Plan, Program, Scope, Step, handlers},
};

/// Group 3: the stage and the city, at dynamic offsets.
static LINE_STAGE: GroupLayout = GroupLayout { label: "line stage", entries: &[(0, DRAWN, STAGE), (1, DRAWN, STAGE)] };

/// Edges as lines.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct LinesKey {
    /// What lines go through.
    program: Program,
    /// Normals are in the target.
    smooth: bool,
}

impl PipelineKey for LinesKey {
    fn name(&self) -> String {
        Module::Lines(self.program.clone()).name()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Lines(self.program.clone()),
            groups: vec![Some(&VIEW), Some(&SHADE), Some(&LENSES), Some(&LINE_STAGE)],
            constants: vec![("SMOOTH", flag(self.smooth))],
            stage: Stage::Draw(Draw {
                buffers: vec![Some(Edge::LAYOUT)],
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                targets: vec![target(LINES, Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING))],
                depth: Some(depth_test(wgpu::CompareFunction::Greater, false)),
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// The parameters of effects that say which edges are drawn, and how, as `pass/lines.wgsl` numbers them: `LINES_*`.
const DRAWN_BY: [(&str, u32); 4] = [("flat_edges", 1), ("faces_front", 2), ("fades", 4), ("keep_terrain", 8)];

/// One effect that draws lines in a frame.
#[derive(Clone, Debug)]
pub struct LineDraw {
    /// For the shader.
    stage: LineStage,
    /// Where it draws.
    reaches: Vec<Reach>,
    /// Whose it is; `None`: the context's.
    lens: Option<u32>,
}

/// The draws of a frame: `plan` is what lines go through, `lenses` the numbers of its lenses.
fn draws(input: &FrameInput, plan: Option<&Plan>, lenses: &[u32]) -> Vec<LineDraw> {
    let Some(plan) = plan else { return Vec::new() };
    let draw = |(number, step): (usize, &Step)| {
        let handler = &handlers()[step.effect as usize];
        let (lens, class) = match step.scope {
            Scope::Everywhere => (None, Class::Rest),
            Scope::Lens(lens, class) => (lenses.get(lens as usize).copied(), Class::from(class)),
        };
        let value = |name: &str| parameter(handler, name, step.parameters, &input.operations.parameters);
        handler.lines.then(|| LineDraw {
            stage: LineStage {
                width: value("line_width").unwrap_or(1.0),
                step: number as u32,
                drawn: DRAWN_BY
                    .iter()
                    .filter(|(name, _)| value(name).is_some_and(|on| on != 0.0))
                    .fold(0, |drawn, (_, bit)| drawn | bit),
                reserved: 0,
            },
            reaches: reaches_of(lens, class, input.volumes, &input.view),
            lens,
        })
    };
    plan.steps.iter().enumerate().filter_map(draw).collect()
}

/// A parameter of a handler that takes one float.
fn parameter(handler: &EffectDefinition, name: &str, first: u32, all: &[[f32; 4]]) -> Option<f32> {
    let mut before = 0;
    for (parameter, _, floats) in handler.shader_parameters() {
        if parameter.name == name {
            return all.get(first as usize + before / 4).map(|slot| slot[before % 4]);
        }
        before += floats;
    }
    None
}

/// What the pass keeps.
#[derive(Debug)]
pub struct Lines {
    stages: Synced,
    group: KeptGroup,
}

/// Edges of one city, and where they stand.
struct PlacedEdges<'a> {
    edges: &'a EdgeBuffers,
    placement: &'a Placement,
    /// The content's number, 0: what moves by timetables; `None`: the scene's own.
    content: Option<u32>,
    /// Offset of its `City`.
    offset: u32,
}

/// The edges that a frame draws.
fn drawn_edges<'a>(frame: &FrameContext<'a>, cut: Option<&Cut>) -> Vec<PlacedEdges<'a>> {
    let cities = frame.cities;
    let edges_of = |city: &'a CityOnGpu, world: &'a World, content: Option<u32>, [at_rest, moved]: [u32; 2]| {
        let of = |edges, placement, offset| PlacedEdges { edges, placement, content, offset };
        let deformed = cities.deformed(world).and_then(|deformed| deformed.edges.as_ref());
        let parts = match deformed {
            Some([left, bent]) => [Some(of(left, &world.placement, at_rest)), Some(of(bent, &Placement::NONE, moved))],
            None => [city.edges.as_ref().map(|edges| of(edges, &world.placement, at_rest)), None],
        };
        parts.into_iter().flatten()
    };
    let own = edges_of(cities.own, &World::OWN, None, [0; 2]);
    let is_asked = |number| number == 0 || cut.is_some_and(|cut| cut.plan.contents.iter().any(|c| c.city == number));
    let contents = cities.contents.placed(cities.own).filter(|placed| is_asked(placed.number));
    let contents = contents.flat_map(|placed| edges_of(placed.city, placed.world, Some(placed.number), placed.offsets));
    own.chain(contents).collect()
}

impl Lines {
    /// Draws all edges of one city as one effect has them.
    fn draw(
        &self,
        frame: &FrameContext,
        pass: &mut wgpu::RenderPass,
        draw: &LineDraw,
        of: &PlacedEdges,
        cut: Option<&Cut>,
    ) -> Counted {
        let view = &frame.plan.input.view;
        let frustum = view.frustum(1.0);
        let is_wanted = |bounds: &Aabb| draw.reaches.iter().any(|reach| reach.touches(bounds, view));
        let is_shown = |bounds: &Aabb| {
            of.content.is_none_or(|number| number == 0 || cut.is_some_and(|c| c.hiding.shows(number, bounds, view)))
        };
        let is_bent = frame.plan.input.operations.bends.is_any();
        let parts = if is_bent { BENT_PARTS } else { 1 };
        let mut counted = Counted::NONE;
        pass.set_vertex_buffer(0, of.edges.instances.slice(..));
        for range in of.edges.draws(|bounds| {
            let placed = of.placement.boxed(bounds);
            (is_bent || frustum.meets(&placed) && is_wanted(&placed)) && is_shown(&placed)
        }) {
            let triangles = 2 * u64::from(range.end - range.start);
            counted += Counted { draws: parts, triangles: u64::from(parts) * triangles };
            for part in 0..parts {
                pass.draw(part * VERTICES..(part + 1) * VERTICES, range.clone());
            }
        }
        counted
    }
}

impl Pass for Lines {
    type Input<'a> = Vec<LineDraw>;

    const LIST: &'static [Line] = &[("lines", "edges, where effects draw them")];

    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let stages = Synced::new(gpu, "line stages", wgpu::BufferUsages::UNIFORM)?;
        Ok(Self { stages, group: KeptGroup::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Vec<LineDraw>> {
        let draws = match plan.has_edges {
            true => draws(plan.input, plan.plans.lining.as_ref(), &plan.plans.seen),
            false => Vec::new(),
        };
        (!draws.is_empty()).then_some(draws)
    }

    fn add_needs(_: &Vec<LineDraw>, _: &FramePlan, needs: &mut Needs) {
        needs.lines = true;
    }

    fn add_keys(&self, _: Option<&Vec<LineDraw>>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let key = |program: &Program| LinesKey { program: program.clone(), smooth: plan.smooth };
        keys.add_programs(26, programs.lining.iter().map(key));
    }

    fn prepare(&mut self, draws: &Vec<LineDraw>, stage: &mut Preparing) -> Result<(), GpuError> {
        let stages: Vec<u8> = draws.iter().flat_map(|draw| strided(&draw.stage)).collect();
        if self.stages.sync(stage.gpu, &stages)? {
            self.group.forget();
        }
        Ok(())
    }

    fn record(
        &mut self,
        draws: &Vec<LineDraw>,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { gpu, pipelines, shared, groups, targets, plan, .. } = *frame;
        let Some(program) = &frame.programs.lining else { return Ok(()) };
        self.group.fit(shared.stamp, || {
            let entries = [(0, one_of::<LineStage>(&self.stages)), (1, one_of::<layout::City>(&shared.cities))];
            group(gpu, "line stage", &pipelines.layout(&LINE_STAGE), &entries)
        });
        let mut lenses: Vec<u32> = draws.iter().filter_map(|d| d.lens).collect();
        lenses.dedup();
        let pass = DrawnPass {
            name: "lines",
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            colors: &[Some(cleared(&targets.lines.view, wgpu::Color::TRANSPARENT))],
            depth: Some(read_depth(&targets.depth.view)),
        };
        let cut = plan.cuts.picture.as_ref();
        let edges = drawn_edges(frame, cut);
        recording.draw(pass, |pass| {
            pass.set_pipeline(pipelines.get(&LinesKey { program: program.clone(), smooth: plan.smooth }));
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &groups.shade, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            let mut counted = Counted::NONE;
            for (i, draw) in draws.iter().enumerate() {
                for of in &edges {
                    pass.set_bind_group(3, self.group.get(), &[(i as u64 * STAGE_STRIDE) as u32, of.offset]);
                    counted += self.draw(frame, pass, draw, of, cut);
                }
            }
            counted
        });
        Ok(())
    }
}
