//! Translucent layers: fragment nodes in a list per pixel, sorted, shaded and laid one over the other, exactly.
//!
//! How much memory the lists take is bounded: what does not fit is drawn in bands, halved until each fits. How many nodes there
//! are is read back before they are sorted, so nothing is ever left out in silence: what a single pixel has too much is counted.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        city_facts::SectionFacts,
        eye::PictureTile,
        layers::{LAYER_BYTES, LayerFigures, MethodFigures},
        pass::{
            composite::{Band, CompositeKey, HEADER, LayerLists, POOLS, composite},
            context::{Board, FrameContext, Keys, Line, Pass},
            layering::{self, Layering},
            rays::{Followed, RAYS},
            section_kind::{GeometryKind, Normals},
            translucent::draw_translucent,
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{DEPTHS, DRAWN, GroupLayout, UNIFORM, WRITTEN, all_of, group, whole},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CORNERS, CUT_CITY, LENSES},
            recording::{Counted, DrawnPass, Recording, Shaded, read_depth, scissor},
            targets::Needs,
        },
    },
    scene::Transparency,
    shader::{Module, Program},
};

/// Group 0 of listing: the view, lists, nodes, the depth of what is opaque.
static LAYERS: GroupLayout = GroupLayout {
    label: "layers",
    entries: &[(0, DRAWN, UNIFORM), (1, S::FRAGMENT, WRITTEN), (2, S::FRAGMENT, WRITTEN), (3, S::FRAGMENT, DEPTHS)],
};
/// Group 0 of counting and sorting: lists, nodes.
static LAYER_ORDER: GroupLayout =
    GroupLayout { label: "order of layers", entries: &[(0, S::COMPUTE, WRITTEN), (1, S::COMPUTE, WRITTEN)] };

/// Nodes that there is room for before anything is known: per pixel, and at least.
const FIRST_GUESS: [u64; 2] = [2, 1 << 16];
/// Bands of a picture at most; of what is left over, the excess is counted.
const MOST_BANDS: usize = 4096;
/// Nodes that there is room for from which on it is shared out between pools (`pass/layers.wgsl`).
const MANY: u64 = 1 << 16;
/// The word of the lists that has the number of a picked layer, as `pass/composite.wgsl` reads it.
const PICKED: u64 = 3;

/// Lists of translucent layers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ListKey {
    section: GeometryKind,
    normals: Normals,
    /// Whether nodes have colours.
    textured: bool,
    /// Whether these have the opacity of texels.
    blended: bool,
    /// Whether nodes have shares of own light.
    texels_emit: bool,
    /// What is translucent.
    program: Program,
    /// All is.
    all: bool,
    /// Whether the depth test can come first.
    early: bool,
    /// Whether triangles hold their depth where they are seen edge on.
    holds_depth: bool,
}

impl ListKey {
    fn module(&self) -> Module {
        Module::Layers(self.program.clone(), self.early && self.is_interpolated())
    }

    /// Whether depths are those that the rasteriser makes.
    fn is_interpolated(&self) -> bool {
        !self.section.is_layer() && !self.holds_depth
    }

    fn entry_points(&self) -> (&'static str, &'static str) {
        if self.holds_depth {
            let is_textured = self.section.look().is_some();
            return ("vertex_held_layer", if is_textured { "note_held_textured" } else { "note_held" });
        }
        match (self.section, self.normals.smooth) {
            (GeometryKind::Plain, false) => ("vertex", "note_plain"),
            (GeometryKind::Plain, true) => ("vertex_smooth", "note_smooth"),
            (GeometryKind::Textured(_), _) => ("vertex_textured", "note_textured"),
            (GeometryKind::Coplanar(None), _) => ("vertex_coplanar_layer", "note_coplanar"),
            (GeometryKind::Coplanar(Some(_)), _) => ("vertex_textured_layer", "note_textured_coplanar"),
        }
    }
}

impl PipelineKey for ListKey {
    fn name(&self) -> String {
        let Normals { smooth, flat } = self.normals;
        let flags = words(&[
            (self.all, "of all"),
            (self.textured, "textured"),
            (self.blended, "blended"),
            (self.texels_emit, "of light"),
            (smooth, "smooth"),
            (flat, "flat"),
            (self.holds_depth, "held"),
        ]);
        format!("{}{}{flags}", self.module().name(), self.section.words())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let constants = [
            ("SMOOTH", flag(self.normals.smooth)),
            ("FLAT_CITY", flag(self.normals.flat)),
            ("TEXTURED", flag(self.textured)),
            ("BLENDED", flag(self.blended)),
            ("TEXELS_EMIT", flag(self.texels_emit)),
            ("ALL", flag(self.all)),
        ];
        let compare = match self.is_interpolated() {
            true => wgpu::CompareFunction::Greater,
            false => wgpu::CompareFunction::Always,
        };
        let (vertex, fragment) = self.entry_points();
        Parts {
            module: self.module(),
            groups: vec![
                Some(&LAYERS),
                Some(&CUT_CITY),
                Some(&LENSES),
                self.section.images(),
                self.holds_depth.then_some(&CORNERS),
            ],
            constants: constants.into_iter().chain(self.section.constants(self.holds_depth)).collect(),
            stage: Stage::Draw(Draw {
                buffers: self.section.vertex_buffers(self.holds_depth),
                depth: Some(depth_test(compare, false)),
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

/// Layers that bent rays meet.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct RayListKey {
    /// What is translucent.
    program: Program,
    smooth: bool,
    textured: bool,
    texels_emit: bool,
}

impl RayListKey {
    fn new(plan: &FramePlan, program: &Program) -> Self {
        let textured = layering::has_colors(plan);
        Self { program: program.clone(), smooth: plan.smooth, textured, texels_emit: plan.texels_emit }
    }
}

impl PipelineKey for RayListKey {
    fn name(&self) -> String {
        let flags = words(&[(self.textured, "textured"), (self.texels_emit, "of light"), (self.smooth, "smooth")]);
        format!("{}{flags}", Module::RayLayers(self.program.clone()).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::RayLayers(self.program.clone()),
            groups: vec![Some(&LAYERS), Some(&CUT_CITY), Some(&LENSES), Some(&RAYS)],
            constants: vec![
                ("SMOOTH", flag(self.smooth)),
                ("TEXTURED", flag(self.textured)),
                ("TEXELS_EMIT", flag(self.texels_emit)),
            ],
            stage: Stage::Draw(Draw {
                depth: Some(depth_test(wgpu::CompareFunction::Always, false)),
                ..Draw::new("vertex", Some("note_rays"))
            }),
        }
    }
}

/// What goes through all lists, of nodes of so many words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum OrderKey {
    /// How many layers the pixel has that has most.
    Count { words: u32 },
    /// A step of sorting long lists, of which so many nodes are in order before.
    Sort { words: u32, width: u32 },
}

impl PipelineKey for OrderKey {
    fn name(&self) -> String {
        match self {
            Self::Count { .. } => Module::CountLayers.name(),
            Self::Sort { width, .. } => format!("{} by {width}", Module::SortLayers.name()),
        }
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let number = |n: u32| f64::from(n);
        let (module, entry, constants) = match *self {
            Self::Count { words } => (Module::CountLayers, "count", vec![("WORDS", number(words))]),
            Self::Sort { words, width } => {
                (Module::SortLayers, "sort", vec![("WORDS", number(words)), ("WIDTH", number(width))])
            }
        };
        Parts { module, groups: vec![Some(&LAYER_ORDER)], constants, stage: Stage::Compute(entry) }
    }
}

/// Steps that sort lists of so many nodes.
fn sorting(words: u32, longest: u32) -> Vec<OrderKey> {
    let widths = (0..32).map(|step| 1_u32 << step).take_while(|width| *width < longest);
    widths.map(|width| OrderKey::Sort { words, width }).collect()
}

/// Halves of a band, the longer side halved; `None` of one pixel.
fn halves(band: PictureTile) -> Option<[PictureTile; 2]> {
    let side = usize::from(band.size[1] >= band.size[0]);
    let first = band.size[side] / 2;
    if first == 0 {
        return None;
    }
    let mut parts = [band; 2];
    parts[0].size[side] = first;
    parts[1].size[side] -= first;
    parts[1].origin[side] += first;
    Some(parts)
}

/// What the header of lists tells.
#[derive(Clone, Copy, Debug)]
struct Listed {
    /// How many nodes there are, those without room included.
    nodes: u64,
    /// How many their pools had no room for.
    spilled: u64,
    /// The longest list that the lists before told of.
    longest: u32,
}

impl Listed {
    /// How many found no room, where there is some for so many.
    fn excess(&self, room: u64) -> u64 {
        let pooled = if room >= MANY { POOLS * (room / 64 * 3) } else { room };
        self.spilled.saturating_sub(room - pooled)
    }

    /// Room that would do, unless pools fill unevenly; more than there was.
    fn wanted(&self, room: u64) -> u64 {
        (self.nodes + self.nodes / 2).max(2 * room)
    }
}

/// What the pass keeps.
#[derive(Debug)]
pub struct ExactLayers {
    lists: Option<LayerLists>,
    /// The longest list that frames sort; 0: none is long.
    longest: u32,
    /// What the last frame had of them, and what they took.
    pub figures: LayerFigures,
    pub method: MethodFigures,
}

/// The programs and pipelines of a frame's layers.
struct Run<'a> {
    frame: &'a FrameContext<'a>,
    layering: &'a Layering<'a>,
    /// `None`: nothing of the city is translucent.
    noting: Option<&'a Program>,
    composite: CompositeKey,
    sort: Vec<OrderKey>,
    count: Option<OrderKey>,
    /// Where rays are bent.
    followed: Option<&'a Followed>,
}

impl ExactLayers {
    /// Another city is there now.
    pub fn forget(&mut self) {
        (self.lists, self.longest) = (None, 0);
    }

    /// Gives back what it takes on the GPU.
    pub fn drop_lists(&mut self) {
        self.lists = None;
    }

    /// Whether lists of the last frame are longer than it was made for, and the next one has to sort them; that it then does.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn sorts_longer(&mut self, gpu: &Gpu) -> Result<bool, GpuError> {
        let Some(own) = self.lists.as_ref().filter(|_| self.figures.nodes > 0) else { return Ok(false) };
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("longest list") };
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        encoder.copy_buffer_to_buffer(own.heads.buffer(), 0, &own.counted, 0, 4 * HEADER);
        gpu.queue.submit([encoder.finish()]);
        let longest = gpu.mapped(&own.counted, |bytes| bytemuck::pod_read_unaligned::<u32>(&bytes[8..12]))?;
        let is_longer = longest > self.longest;
        if is_longer {
            self.longest = longest;
        }
        Ok(is_longer)
    }

    /// The pipelines that do not depend on sections: composite, count, sort.
    fn composite_key(&self, plan: &FramePlan, program: &Program) -> CompositeKey {
        CompositeKey {
            sorted: self.longest > 1,
            picks: plan.settings.picked_layer.is_some(),
            ..CompositeKey::new(plan, program)
        }
    }
}

fn count_key(plan: &FramePlan) -> Option<OrderKey> {
    layering::asks_most(plan).then(|| OrderKey::Count { words: layering::words(plan) })
}

fn list_key(plan: &FramePlan, program: &Program, section: &SectionFacts, all: bool) -> ListKey {
    ListKey {
        section: section.kind.into(),
        normals: Normals::new(plan.smooth, section.is_smooth),
        textured: layering::has_colors(plan),
        blended: plan.blended,
        texels_emit: plan.texels_emit,
        program: program.clone(),
        all,
        early: plan.adapter.tests_depth_early,
        holds_depth: plan.holds_depth(section),
    }
}

impl Run<'_> {
    /// Lists the layers of a band, and reads how many there are. What was recorded is submitted.
    fn list(&self, recording: &mut Recording, lists: &LayerLists, band: Band) -> Result<Listed, GpuError> {
        let FrameContext { gpu, targets, groups, shared, plan, .. } = *self.frame;
        let Some((noting, cut)) = self.noting.zip(self.layering.cut) else {
            recording.encoder.clear_buffer(lists.heads.buffer(), 0, None);
            return Ok(Listed { nodes: 0, spilled: 0, longest: 0 });
        };
        // What the header tells of lists before stays.
        recording.encoder.clear_buffer(lists.heads.buffer(), 0, Some(4));
        recording.encoder.clear_buffer(lists.heads.buffer(), 4 * 16, None);
        let entries = [
            (0, whole(shared.view.buffer())),
            (1, whole(lists.heads.buffer())),
            (2, lists.nodes(band.words)),
            (3, all_of(&targets.depth)),
        ];
        let view = group(gpu, "layers", &self.frame.pipelines.layout(&LAYERS), &entries);
        let pass = DrawnPass {
            name: "layers",
            view: "main",
            lenses: self.layering.lenses(),
            shaded: Shaded::Counted,
            colors: &[],
            depth: Some(read_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            scissor(pass, band.tile);
            pass.set_bind_group(0, &view, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            let mut counted = draw_translucent(
                self.frame,
                pass,
                Some(cut),
                true,
                |section, all| list_key(plan, noting, section, all),
                |pass, offset| pass.set_bind_group(1, &groups.cut_city, &[offset; 2]),
            );
            for part in self.followed.iter().flat_map(|followed| &followed.parts) {
                let part = part.common(band.tile);
                if !part.is_empty() {
                    counted += self.note_rays(pass, noting, part);
                }
            }
            counted
        });
        lists.read_header(gpu, recording, |bytes| {
            let header: [u32; HEADER as usize] = bytemuck::pod_read_unaligned(&bytes[..4 * HEADER as usize]);
            let nodes = header[16..].iter().step_by(16).map(|pool| u64::from(*pool)).sum();
            Listed { nodes, spilled: header[0].into(), longest: header[2] }
        })
    }

    /// Notes what bent rays meet in a part of the picture.
    fn note_rays(&self, pass: &mut wgpu::RenderPass, noting: &Program, part: PictureTile) -> Counted {
        let FrameContext { groups, pipelines, plan, .. } = *self.frame;
        let Some(followed) = self.followed else { return Counted::NONE };
        scissor(pass, part);
        pass.set_pipeline(pipelines.get(&RayListKey::new(plan, noting)));
        pass.set_bind_group(1, &groups.cut_city, &[0; 2]);
        pass.set_bind_group(3, &followed.group, &[]);
        pass.draw(0..3, 0..1);
        Counted { draws: 1, triangles: 1 }
    }

    /// Goes through all lists of the picture.
    fn order(&self, recording: &mut Recording, name: &'static str, key: OrderKey, lists: &LayerLists, words: u64) {
        let entries = [(0, whole(lists.heads.buffer())), (1, lists.nodes(words))];
        let FrameContext { gpu, pipelines, plan, .. } = *self.frame;
        let own = group(gpu, "order of layers", &pipelines.layout(&LAYER_ORDER), &entries);
        let [width, height] = plan.input.tile.size;
        recording.compute(name, &[], |pass| {
            pass.set_pipeline(pipelines.get_compute(&key));
            pass.set_bind_group(0, &own, &[]);
            let groups = (width * height).div_ceil(64);
            let across = groups.min(32768);
            pass.dispatch_workgroups(across, groups.div_ceil(across), 1);
            Counted { draws: 1, triangles: 0 }
        });
    }

    /// Sorts what was listed for a band, and lays it one over the other.
    fn lay(&self, recording: &mut Recording, lists: &LayerLists, band: Band) {
        for key in &self.sort {
            self.order(recording, "sort layers", *key, lists, band.words);
        }
        composite(self.frame, recording, self.layering, &self.composite, lists, band);
    }
}

/// How many nodes there is room for, `most` at most.
struct Limits {
    words: u64,
    most: u64,
}

impl Limits {
    fn room(&self, lists: &LayerLists) -> u64 {
        self.most.min(lists.nodes.buffer().size() / (4 * self.words))
    }

    fn band(&self, tile: PictureTile, room: u64) -> Band {
        Band { tile, words: room * self.words }
    }
}

impl ExactLayers {
    /// Lists with room for a first guess of the nodes of a region.
    fn fitted(&mut self, frame: &FrameContext, region: PictureTile, limits: &Limits) -> Result<LayerLists, GpuError> {
        let gpu = frame.gpu;
        let mut lists = match self.lists.take() {
            Some(lists) => lists,
            None => LayerLists::new(gpu)?,
        };
        let pixels = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        lists.heads.fit(gpu, 4 * (HEADER + pixels(frame.plan.input.tile.size)))?;
        if let Some(picked) = frame.plan.settings.picked_layer {
            gpu.queue.write_buffer(lists.heads.buffer(), 4 * PICKED, &picked.to_le_bytes());
        }
        let guess = (FIRST_GUESS[0] * pixels(region.size)).max(FIRST_GUESS[1]);
        lists.nodes.fit(gpu, 4 * limits.words * limits.most.min(guess))?;
        Ok(lists)
    }

    /// Lists a region in as many bands as it takes, and lays or counts each; these.
    fn lay_bands(
        &mut self,
        run: &Run,
        recording: &mut Recording,
        lists: &mut LayerLists,
        region: PictureTile,
        limits: &Limits,
    ) -> Result<Vec<Band>, GpuError> {
        let gpu = run.frame.gpu;
        let mut bands = vec![region];
        let mut fitting: Vec<Band> = Vec::new();
        let mut figures = LayerFigures::default();
        while let Some(tile) = bands.pop() {
            let mut room = limits.room(lists);
            let mut found = run.list(recording, lists, limits.band(tile, room))?;
            // The last frame says how long its lists were: nobody may have asked since.
            self.longest = self.longest.max(if fitting.is_empty() { found.longest } else { 0 });
            while found.excess(room) > 0 && room < limits.most {
                lists.nodes.fit(gpu, 4 * limits.words * found.wanted(room).min(limits.most))?;
                room = limits.room(lists);
                found = run.list(recording, lists, limits.band(tile, room))?;
            }
            let excess = found.excess(room);
            let is_last = fitting.len() + bands.len() + 1 >= MOST_BANDS || limits.most == 0;
            if let Some(parts) = halves(tile).filter(|_| excess > 0 && !is_last) {
                bands.extend(parts);
                continue;
            }
            if fitting.is_empty() {
                recording.encoder.clear_buffer(lists.heads.buffer(), 4, Some(8));
            }
            figures.nodes += found.nodes;
            figures.bands += 1;
            figures.excess += excess;
            let band = limits.band(tile, room);
            fitting.push(band);
            match run.count {
                Some(count) => run.order(recording, "count layers", count, lists, band.words),
                None => run.lay(recording, lists, band),
            }
        }
        self.figures = figures;
        Ok(fitting)
    }
}

impl Pass for ExactLayers {
    type Input<'a> = Layering<'a>;

    const LIST: &'static [Line] = &[
        ("layers", "every fragment that is seen through and not behind what is opaque, into the list of its pixel"),
        ("count layers", "where opacity rules ask how many layers the picture has"),
        ("sort layers", "where a list is very long"),
        ("composite", "the lists, sorted and laid one over the other"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        let (figures, method) = (LayerFigures::default(), MethodFigures::default());
        Ok(Self { lists: None, longest: 0, figures, method })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Layering<'a>> {
        Layering::of(plan).filter(|_| plan.input.transparency == Transparency::Exact)
    }

    fn begin(&mut self, _: &FramePlan) {
        (self.figures, self.method) = (LayerFigures::default(), MethodFigures::default());
    }

    fn add_needs(_: &Layering, plan: &FramePlan, needs: &mut Needs) {
        Layering::add_needs(plan, needs);
    }

    fn add_keys(&self, input: Option<&Layering>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let (Some(_), Some(composite)) = (input, programs.layering.as_ref()) else { return };
        keys.add_programs(28, [self.composite_key(plan, composite)]);
        keys.add_programs(28, count_key(plan));
        keys.add_programs(28, sorting(layering::words(plan), self.longest));
        let Some(noting) = &programs.picture else { return };
        if plan.input.operations.bends.is_any() {
            keys.add_programs(28, [RayListKey::new(plan, noting)]);
        }
        keys.add(30, plan.sections.iter().flat_map(|s| [false, true].map(|all| list_key(plan, noting, s, all))));
    }

    fn record(
        &mut self,
        layering: &Layering,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let plan = frame.plan;
        let Some(composite) = &frame.programs.layering else { return Ok(()) };
        layering.clear(frame, recording)?;
        let Some(region) = layering.region else { return Ok(()) };
        let words = layering::words(plan);
        let run = Run {
            frame,
            layering,
            noting: frame.programs.picture.as_ref(),
            composite: self.composite_key(plan, composite),
            sort: sorting(words, self.longest),
            // How many layers there are at most is known after the last band.
            count: count_key(plan),
            followed: board.get(),
        };
        let most = plan.settings.most_layers.unwrap_or(LAYER_BYTES / (4 * u64::from(words)));
        let limits = Limits { words: u64::from(words), most };
        let mut lists = self.fitted(frame, region, &limits)?;
        let bands = self.lay_bands(&run, recording, &mut lists, region, &limits)?;
        if run.count.is_some() {
            for band in &bands {
                // Those of the only one are still there.
                if bands.len() > 1 {
                    run.list(recording, &lists, *band)?;
                }
                run.lay(recording, &lists, *band);
            }
        }
        self.method.bytes = lists.bytes();
        self.lists = Some(lists);
        Ok(())
    }
}
