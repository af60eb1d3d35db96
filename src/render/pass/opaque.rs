//! Drawing what is opaque of the city into the targets: what geometry passes share.

use crate::{
    render::{
        cities::DrawnSection,
        city::{Chunk, CityBuffers, Draw as Run, Section, SeenChunk, draws_of},
        city_facts::SectionFacts,
        cut::{Asked, Cut},
        pass::{
            context::{FrameContext, Keys},
            section_kind::{GeometryKind, Normals},
        },
        plan::FramePlan,
        resource::{
            bindings::{DRAWN, GroupLayout, STAGE, UNIFORM, group, whole},
            formats::{COLORS, OWN_DEPTH, REGIONS, codes},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CITY, CORNERS, CUT_CITY, LENSES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared, cleared_depth, kept, kept_depth},
            targets::Targets,
        },
    },
    shader::{Module, Program},
    view::View,
};

/// Group 0 of the geometry of a region: the view, and the number of the region at a dynamic offset.
pub static REGION: GroupLayout =
    GroupLayout { label: "region", entries: &[(0, DRAWN, UNIFORM), (1, wgpu::ShaderStages::FRAGMENT, STAGE)] };

/// Opaque triangles.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct GeometryKey {
    /// How vertices are laid out and where depth comes from.
    pub section: GeometryKind,
    /// Whether base colours are written.
    pub colored: bool,
    pub normals: Normals,
    /// Whether interpolated depth is written, for the AOV.
    pub measured: bool,
    /// Whether the picture has shares of own light.
    pub texels_emit: bool,
    /// What is hidden; of a program that tells regions apart, what is not in the one that is drawn.
    pub cut: Option<Program>,
    /// Whether triangles hold their depth where they are seen edge on.
    pub holds_depth: bool,
}

impl GeometryKey {
    /// The pipeline that draws a section of a frame; `cut`: where something may be hidden.
    pub fn new(plan: &FramePlan, section: &SectionFacts, cut: Option<Program>) -> Self {
        Self {
            section: section.kind.into(),
            colored: plan.colored,
            normals: Normals::new(plan.smooth, section.is_smooth),
            measured: plan.input.measured,
            texels_emit: plan.texels_emit,
            cut,
            holds_depth: plan.holds_depth(section),
        }
    }

    fn is_of_region(&self) -> bool {
        self.cut.as_ref().is_some_and(|program| program.regions().is_some())
    }

    fn entry_points(&self) -> (&'static str, &'static str) {
        if self.holds_depth {
            let is_textured = self.section.look().is_some();
            return ("vertex_held", if is_textured { "held_textured" } else { "held_full" });
        }
        let full = self.colored || self.measured || self.is_of_region();
        match (self.section, self.normals.smooth) {
            (GeometryKind::Plain, false) => ("vertex", if full { "full" } else { "plain" }),
            (GeometryKind::Plain, true) => ("vertex_smooth", if full { "smooth_full" } else { "smooth_plain" }),
            (GeometryKind::Textured(_), _) => ("vertex_textured", "textured"),
            (GeometryKind::Coplanar(None), _) if !full => ("vertex_coplanar", "coplanar_plain"),
            (GeometryKind::Coplanar(None), _) => ("vertex_coplanar", "coplanar_full"),
            (GeometryKind::Coplanar(Some(_)), _) => ("vertex_coplanar_textured", "coplanar_textured"),
        }
    }

    fn targets(&self) -> Vec<Option<wgpu::ColorTargetState>> {
        in_order([
            Some(codes(self.normals.smooth).into()),
            self.colored.then(|| COLORS.into()),
            self.measured.then(|| OWN_DEPTH.into()),
            self.is_of_region().then(|| REGIONS.into()),
            self.texels_emit.then(|| self.section.emissions()),
        ])
    }
}

impl PipelineKey for GeometryKey {
    fn name(&self) -> String {
        let kind = self.section.words();
        let Normals { smooth, flat } = self.normals;
        let flags = words(&[
            (self.colored, "colored"),
            (smooth, "smooth"),
            (flat, "flat"),
            (self.measured, "measured"),
            (self.holds_depth, "held"),
        ]);
        format!("{}{kind}{flags}", Module::Geometry(self.cut.clone()).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let is_cut = self.cut.is_some();
        let compare = match self.section {
            GeometryKind::Coplanar(_) => wgpu::CompareFunction::GreaterEqual,
            _ => wgpu::CompareFunction::Greater,
        };
        let (vertex, fragment) = self.entry_points();
        let constants = [("SMOOTH", flag(self.normals.smooth)), ("FLAT_CITY", flag(self.normals.flat))];
        Parts {
            module: Module::Geometry(self.cut.clone()),
            groups: vec![
                Some(if self.is_of_region() { &REGION } else { &VIEW }),
                Some(if is_cut { &CUT_CITY } else { &CITY }),
                is_cut.then_some(&LENSES),
                self.section.images(),
                self.holds_depth.then_some(&CORNERS),
            ],
            constants: constants.into_iter().chain(self.section.constants(self.holds_depth)).collect(),
            stage: Stage::Draw(Draw {
                buffers: self.section.vertex_buffers(self.holds_depth),
                targets: self.targets(),
                depth: Some(depth_test(compare, true)),
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

/// What geometry is drawn into beside depth, as passes and pipelines list it: codes, colours, interpolated depth, regions, shares of own
/// light. The list ends where it may.
pub fn in_order<T>(targets: [Option<T>; 5]) -> Vec<Option<T>> {
    let count = targets.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    targets.into_iter().take(count).collect()
}

/// What a pass draws of a section.
#[derive(Clone, Debug)]
pub struct SectionPart<'a> {
    pub drawn: DrawnSection<'a>,
    pub chunks: Vec<&'a Chunk>,
}

/// What is hidden, and the program that hides it.
#[derive(Clone, Copy, Debug)]
pub struct CutBy<'a> {
    pub cut: &'a Cut,
    pub program: &'a Program,
}

impl<'a> CutBy<'a> {
    /// What is hidden in the picture of a frame.
    pub fn of_picture(frame: &FrameContext<'a>) -> Option<Self> {
        let (cut, program) = frame.plan.cuts.picture.as_ref().zip(frame.programs.picture.as_ref())?;
        Some(Self { cut, program })
    }
}

/// Adds the pipelines of what no lens reaches.
pub fn add_whole_keys(plan: &FramePlan, keys: &mut Keys) {
    keys.add(11, plan.own_sections.iter().map(|s| GeometryKey::new(plan, s, None)));
}

/// Adds those of what a program hides something of: for all sections, contents' too.
pub fn add_cut_keys(plan: &FramePlan, program: &Program, keys: &mut Keys) {
    let key = |s: &SectionFacts| GeometryKey::new(plan, s, Some(program.clone()));
    keys.add_programs(23, plan.sections.iter().map(key));
}

/// An eye that opaque triangles are drawn for, and what they are drawn into.
#[derive(Clone, Copy)]
pub struct OpaqueEye<'a> {
    /// What it is called in statistics.
    pub name: &'static str,
    pub view: &'a View,
    /// The view, the lenses, and the city where something is hidden, as shaders read them.
    pub groups: [&'a wgpu::BindGroup; 3],
    /// Codes, colours, interpolated depth, shares of own light: those are drawn that the plan asks for.
    pub targets: [&'a wgpu::TextureView; 4],
    pub depth: &'a wgpu::TextureView,
    /// The part of these that it has, pixels, from the first.
    pub size: [u32; 2],
}

impl<'a> OpaqueEye<'a> {
    /// The picture's.
    pub fn of_picture(frame: &FrameContext<'a>) -> Self {
        let FrameContext { targets, groups, plan, .. } = *frame;
        let Targets { codes, colors, own_depth, emissions, depth, .. } = targets;
        Self {
            name: "main",
            view: &plan.input.view,
            groups: [&groups.view, &groups.lenses, &groups.cut_city],
            targets: [codes, colors, own_depth, emissions].map(|target| &target.view),
            depth: &depth.view,
            size: plan.input.tile.size,
        }
    }
}

/// The chunks of a section that an eye may see, in drawing order.
pub fn visible<'a>(drawn: &DrawnSection<'a>, view: &View, cut: Option<&Cut>) -> Vec<SeenChunk<'a>> {
    let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, cut, view));
    CityBuffers::visible(shown, &view.frustum(1.0), view.camera.eye)
}

/// Sets what a section is drawn from, but for its pipeline.
pub fn set_section(frame: &FrameContext, pass: &mut wgpu::RenderPass, drawn: &DrawnSection, holds_depth: bool) {
    let Section { vertices, indices, extra, .. } = drawn.section;
    if holds_depth {
        let entries = [(0, whole(indices)), (1, whole(vertices)), (2, whole(extra.as_ref().unwrap_or(indices)))];
        let corners = group(frame.gpu, "corners", &frame.pipelines.layout(&CORNERS), &entries);
        pass.set_bind_group(4, &corners, &[]);
    } else {
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        if let Some(extra) = extra {
            pass.set_vertex_buffer(1, extra.slice(..));
        }
    }
    if let Some(image) = drawn.image {
        pass.set_bind_group(3, &image.drawn, &[]);
    }
}

/// Draws parts of the city for an eye, into targets that are cleared before where they are the `first`.
pub fn draw_opaque(
    frame: &FrameContext,
    recording: &mut Recording,
    eye: &OpaqueEye,
    name: &'static str,
    parts: &[SectionPart],
    cut: Option<CutBy>,
    is_first: bool,
) {
    let plan = frame.plan;
    let [codes, bases, own_depth, emissions] = eye.targets;
    let shown = in_order([
        Some(codes),
        plan.colored.then_some(bases),
        plan.input.measured.then_some(own_depth),
        None,
        plan.texels_emit.then_some(emissions),
    ]);
    let attachment = |view| if is_first { cleared(view, wgpu::Color::TRANSPARENT) } else { kept(view) };
    let colors: Vec<_> = shown.into_iter().map(|target| target.map(attachment)).collect();
    let depth = eye.depth;
    let pass = DrawnPass {
        name,
        view: eye.name,
        lenses: cut.map_or(&[][..], |by| &by.cut.hiding.lenses),
        shaded: Shaded::Counted,
        colors: &colors,
        depth: Some(if is_first { cleared_depth(depth, 0.0) } else { kept_depth(depth) }),
    };
    recording.draw(pass, |pass| {
        let [width, height] = eye.size;
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_bind_group(0, eye.groups[0], &[]);
        let mut counted = Counted::NONE;
        for part in parts.iter().filter(|part| !part.chunks.is_empty()) {
            set_section(frame, pass, &part.drawn, plan.holds_depth(&part.drawn.facts()));
            counted += draw_part(frame, pass, eye, part, cut);
        }
        counted
    });
}

/// Draws what a part has, what is cut and what is not each by its pipeline.
fn draw_part(
    frame: &FrameContext,
    pass: &mut wgpu::RenderPass,
    eye: &OpaqueEye,
    part: &SectionPart,
    by: Option<CutBy>,
) -> Counted {
    let plan = frame.plan;
    let [_, lenses, cut_city] = eye.groups;
    let DrawnSection { city, content, offset, .. } = part.drawn;
    let facts = part.drawn.facts();
    let mut counted = Counted::NONE;
    let asked = Asked { is_content: content.is_some(), keeps_order: part.drawn.section.kind.is_layer() };
    for (ranges, is_cut) in Cut::parts(by.map(|by| by.cut), eye.view, &part.chunks, asked) {
        let (runs, triangles) = draws_of(ranges.into_iter());
        let program = by.filter(|_| is_cut).map(|by| by.program.clone());
        if program.is_some() {
            pass.set_bind_group(2, lenses, &[]);
        }
        match program.is_some() {
            true => pass.set_bind_group(1, cut_city, &[offset; 2]),
            false => pass.set_bind_group(1, &city.group, &[]),
        }
        let key = GeometryKey::new(plan, &facts, program);
        pass.set_pipeline(frame.pipelines.get(&key));
        draw_corners(pass, &runs, 0, key.holds_depth);
        counted += Counted { draws: runs.len() as u32, triangles };
    }
    counted
}

/// Draws runs of what [`set_section`] has set, as this instance.
pub fn draw_corners(pass: &mut wgpu::RenderPass, runs: &[Run], instance: u32, holds_depth: bool) {
    for run in runs {
        match holds_depth {
            true => pass.draw(run.clone(), instance..instance + 1),
            false => pass.draw_indexed(run.clone(), 0, instance..instance + 1),
        }
    }
}

/// Draws runs of an index buffer.
pub fn draw_runs(pass: &mut wgpu::RenderPass, indices: &wgpu::Buffer, runs: &[Run]) {
    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
    for run in runs {
        pass.draw_indexed(run.clone(), 0, 0..1);
    }
}
