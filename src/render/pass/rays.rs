//! Bent rays: what lenses that bend them show, in the targets of what is opaque (`pass/rays.wgsl`).

use std::time::Instant;

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    lens::ray::RayMethod,
    render::{
        bent,
        city_facts::SectionFacts,
        eye::PictureTile,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::in_order,
        },
        plan::FramePlan,
        programs::Programs,
        ray_meshes::RayMeshes,
        ray_tracer::{MOST_HITS, TracedFigures, TracedView, trace},
        ray_vertices::pieces,
        resource::{
            bindings::{DEPTHS, DRAWN, GroupLayout, NUMBERS, STORAGE, UNIFORM, all_of, group, whole},
            formats::{COLORS, EMISSIONS, OWN_DEPTH, RAY_HITS, codes},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CUT_CITY, IMAGES, LENSES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, kept_depth, scissor},
            synced::Synced,
            targets::Needs,
            vertices,
        },
    },
    scene::Technique,
    shader::{Bends, MOST_RAY_LENSES, Module, Program},
};

/// Group 3: cities, and the triangles of their meshes.
pub static RAYS: GroupLayout = GroupLayout { label: "rays", entries: &[(0, DRAWN, UNIFORM), (1, DRAWN, STORAGE)] };

/// The same, and what was traced on the processor.
static TRACED: GroupLayout = GroupLayout {
    label: "traced rays",
    entries: &[(0, DRAWN, UNIFORM), (1, DRAWN, STORAGE), (2, S::FRAGMENT, STORAGE)],
};

/// Hits that the processor tells at a time, at most: five words each are what any adapter binds.
const MOST_TRACED: usize = 6_000_000;

/// What is drawn of lenses that bend rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    /// What rays meet that are followed,
    Follow,
    /// or were traced on the processor.
    Trace,
    /// Nothing, where corners are moved,
    Clear,
    /// and what moved corners make of the city.
    Move,
}

/// Rays that are followed, or corners that are moved.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct RayKey {
    step: Step,
    /// What is hidden.
    hidden: Option<Program>,
    /// How many lenses bend rays.
    bends: Bends,
    /// Whether base colours are written.
    colored: bool,
    /// Whether normals are.
    smooth: bool,
    /// Whether depths are, for the AOV.
    measured: bool,
    /// Whether triangles are, whose images are looked at.
    imaged: bool,
}

impl RayKey {
    fn new(plan: &FramePlan, programs: &Programs, step: Step) -> Self {
        Self {
            step,
            hidden: programs.picture.clone(),
            bends: plan.input.operations.bends,
            colored: plan.colored,
            smooth: plan.smooth,
            measured: plan.input.measured,
            imaged: has_images(plan),
        }
    }

    fn module(&self) -> Module {
        match self.step {
            Step::Follow => Module::Rays(self.hidden.clone(), self.bends),
            Step::Trace => Module::TracedRays(self.hidden.clone(), self.bends),
            Step::Clear | Step::Move => Module::RayVertices(self.hidden.clone(), self.bends),
        }
    }
}

impl PipelineKey for RayKey {
    fn name(&self) -> String {
        let flags = words(&[
            (self.colored, "colored"),
            (self.smooth, "smooth"),
            (self.measured, "measured"),
            (self.imaged, "imaged"),
            (self.step == Step::Clear, "clear"),
        ]);
        format!("{}{flags}", self.module().name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let (vertex, fragment) = match self.step {
            Step::Follow | Step::Trace => ("vertex", "follow"),
            Step::Clear => ("vertex", "cleared"),
            Step::Move => ("vertex_moved", "moved"),
        };
        let (compare, buffers) = match self.step {
            Step::Follow | Step::Trace | Step::Clear => (wgpu::CompareFunction::Always, Vec::new()),
            Step::Move => (wgpu::CompareFunction::Greater, vec![vertices::pieces()]),
        };
        let rays = if self.step == Step::Trace { &TRACED } else { &RAYS };
        Parts {
            module: self.module(),
            groups: vec![Some(&VIEW), Some(&CUT_CITY), Some(&LENSES), Some(rays)],
            constants: vec![("SMOOTH", flag(self.smooth))],
            stage: Stage::Draw(Draw {
                targets: in_order([
                    Some(codes(self.smooth).into()),
                    self.colored.then(|| COLORS.into()),
                    self.measured.then(|| OWN_DEPTH.into()),
                    self.imaged.then(|| RAY_HITS.into()),
                    None,
                ]),
                depth: Some(depth_test(compare, true)),
                buffers,
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

/// Group 1 of images: surfaces, cities, triangles, which of them pixels show, and how far these are.
static IMAGES_OF_RAYS: GroupLayout = GroupLayout {
    label: "images of rays",
    entries: &[
        (0, S::FRAGMENT, NUMBERS),
        (5, S::FRAGMENT, UNIFORM),
        (6, S::FRAGMENT, STORAGE),
        (7, S::FRAGMENT, NUMBERS),
        (8, S::FRAGMENT, DEPTHS),
    ],
};

/// Images of what rays meet.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct RayImageKey {
    bends: Bends,
    /// Whether the images say how much light of their own faces have.
    emits: bool,
    /// Whether the picture has shares of own light.
    texels_emit: bool,
}

impl PipelineKey for RayImageKey {
    fn name(&self) -> String {
        let flags = words(&[(self.emits, "of light"), (self.texels_emit, "of texels")]);
        format!("{}{flags}", Module::RayImages(self.bends).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let targets = [Some(COLORS), self.texels_emit.then_some(EMISSIONS)];
        Parts {
            module: Module::RayImages(self.bends),
            groups: vec![Some(&VIEW), Some(&IMAGES_OF_RAYS), Some(&LENSES), Some(&IMAGES)],
            constants: vec![("IMAGE_EMITS", flag(self.emits))],
            stage: Stage::Draw(Draw {
                targets: targets.into_iter().flatten().map(|format| Some(format.into())).collect(),
                ..Draw::new("vertex", Some("imaged"))
            }),
        }
    }
}

/// Where rays are followed.
#[derive(Clone, Debug)]
pub struct Where {
    /// To what is opaque, in lenses that find it so.
    opaque: Vec<PictureTile>,
    /// The same on the processor: what is around them.
    traced: Option<PictureTile>,
    /// In place of that corners are moved.
    moved: Vec<PictureTile>,
    /// To all that is translucent, whatever the lens: images do not show it.
    layers: Vec<PictureTile>,
}

impl Where {
    fn is_empty(&self) -> bool {
        self.opaque.is_empty() && self.moved.is_empty() && self.layers.is_empty()
    }

    /// Whether something of it is drawn where the opaque city is.
    fn draws(&self) -> bool {
        !(self.opaque.is_empty() && self.moved.is_empty())
    }

    /// How what is opaque is found.
    fn step(&self) -> Step {
        if self.traced.is_some() { Step::Trace } else { Step::Follow }
    }

    /// Whether rays are followed.
    fn follows(&self) -> bool {
        !(self.opaque.is_empty() && self.layers.is_empty())
    }
}

/// Where rays are bent, and what they are followed through: for passes that follow them, too.
#[derive(Clone, Debug)]
pub struct Followed {
    pub parts: Vec<PictureTile>,
    pub group: wgpu::BindGroup,
}

/// What the pass keeps, once there were lenses that bend rays.
#[derive(Debug)]
pub struct Rays {
    kept: Option<Kept>,
    /// What the processor followed for the last frame.
    pub figures: TracedFigures,
}

#[derive(Debug)]
struct Kept {
    meshes: RayMeshes,
    cities: Synced,
    group: wgpu::BindGroup,
    /// What the processor traced, and the group with it.
    traced: Synced,
    traced_group: Option<wgpu::BindGroup>,
    /// Triangles that are cut, and how many alike.
    pieces: Synced,
    counts: Vec<u32>,
}

impl Kept {
    fn new(stage: &Preparing) -> Result<Self, GpuError> {
        let meshes = RayMeshes::new(stage.gpu)?;
        let cities = Synced::new(stage.gpu, "cities of rays", wgpu::BufferUsages::UNIFORM)?;
        let group = group_of(stage, &meshes, &cities);
        let pieces = Synced::new(stage.gpu, "triangles that are cut", wgpu::BufferUsages::VERTEX)?;
        let traced = Synced::new(stage.gpu, "traced rays", wgpu::BufferUsages::STORAGE)?;
        Ok(Self { meshes, cities, group, traced, traced_group: None, pieces, counts: Vec::new() })
    }
}

fn traced_group_of(stage: &Preparing, kept: &Kept) -> wgpu::BindGroup {
    let buffers = [kept.cities.buffer(), kept.meshes.words.buffer(), kept.traced.buffer()];
    let entries: Vec<_> = (0..).zip(buffers.map(whole)).collect();
    group(stage.gpu, TRACED.label, &stage.pipelines.layout(&TRACED), &entries)
}

fn group_of(stage: &Preparing, meshes: &RayMeshes, cities: &Synced) -> wgpu::BindGroup {
    let entries = [(0, whole(cities.buffer())), (1, whole(meshes.words.buffer()))];
    group(stage.gpu, RAYS.label, &stage.pipelines.layout(&RAYS), &entries)
}

fn pixels(part: PictureTile) -> usize {
    part.size[0] as usize * part.size[1] as usize
}

/// How many hits of a ray the processor tells, where there is room: where something is hidden those behind the first ones may be seen.
fn hits_of(plan: &FramePlan, part: PictureTile) -> usize {
    let most = if plan.cuts.picture.is_some() { MOST_HITS } else { 1 };
    (MOST_TRACED / pixels(part).max(1)).clamp(1, most)
}

/// Whether the processor traces what lies in a part.
fn is_traced(plan: &FramePlan, part: PictureTile) -> bool {
    let bends = plan.input.operations.bends;
    let is_plain = bends.choosing == 0 && bends.own == [0; MOST_RAY_LENSES];
    // Layers that lie in what is opaque are as far, to the bit, where both are found in one way.
    let has_layers = plan.plans.layering.is_some();
    plan.settings.traces_rays && is_plain && !has_layers && pixels(part) <= MOST_TRACED
}

/// Whether some of what is drawn has images, storeys and windows left out.
fn has_images(plan: &FramePlan) -> bool {
    let is_image = |section: &SectionFacts| section.kind.images().is_some_and(|images| !images.facade);
    !plan.is_clay() && plan.sections.iter().any(is_image)
}

impl RayImageKey {
    fn new(plan: &FramePlan, emits: bool) -> Self {
        Self { bends: plan.input.operations.bends, emits, texels_emit: plan.texels_emit }
    }
}

impl Kept {
    /// Draws triangles whose corners are moved.
    fn draw_pieces(&self, pass: &mut wgpu::RenderPass, parts: &[PictureTile]) -> Counted {
        let mut counted = Counted::NONE;
        let Some(all) = parts.iter().copied().reduce(PictureTile::around) else { return counted };
        scissor(pass, all);
        pass.set_vertex_buffer(0, self.pieces.buffer().slice(..));
        let mut first = 0;
        for (level, count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let corners = 3 << (2 * level);
            pass.draw(0..corners, first..first + count);
            counted += Counted { draws: 1, triangles: u64::from(corners / 3) * u64::from(*count) };
            first += count;
        }
        counted
    }

    /// Looks at the images of what rays meet, section by section.
    fn draw_images(&self, parts: &[PictureTile], frame: &FrameContext, recording: &mut Recording) {
        let FrameContext { gpu, pipelines, cities, targets, groups, plan, .. } = *frame;
        let entries = [
            (0, wgpu::BindingResource::TextureView(cities.surfaces())),
            (5, whole(self.cities.buffer())),
            (6, whole(self.meshes.words.buffer())),
            (7, all_of(&targets.ray_hits)),
            (8, all_of(&targets.depth)),
        ];
        let own = group(gpu, IMAGES_OF_RAYS.label, &pipelines.layout(&IMAGES_OF_RAYS), &entries);
        let targeted = [Some(&targets.colors), plan.texels_emit.then_some(&targets.emissions)];
        let colors: Vec<_> = targeted.into_iter().flatten().map(|target| Some(kept(&target.view))).collect();
        let lenses = plan.input.rays.lenses();
        let pass = DrawnPass {
            name: "images of rays",
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            colors: &colors,
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &own, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            for (section, images) in &self.meshes.images {
                pass.set_pipeline(pipelines.get(&RayImageKey::new(plan, images.emits)));
                pass.set_bind_group(3, &images.group, &[]);
                for part in parts {
                    scissor(pass, *part);
                    pass.draw(0..3, *section..section + 1);
                }
            }
            let draws = (parts.len() * self.meshes.images.len()) as u32;
            Counted { draws, triangles: draws.into() }
        });
    }
}

impl Pass for Rays {
    type Input<'a> = Where;

    const LIST: &'static [Line] = &[
        ("bent rays", "what lenses that bend rays show, in place of what was drawn there,"),
        ("moved corners", "or the city's triangles where they show its corners,"),
        ("images of rays", "and its images, where it has some"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { kept: None, figures: TracedFigures::default() })
    }

    fn begin(&mut self, _: &FramePlan) {
        self.figures = TracedFigures::default();
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Where> {
        let input = plan.input;
        let parts = |is_wanted: &dyn Fn(RayMethod) -> bool| bent::parts(input.rays, &input.view, input.tile, is_wanted);
        let opaque = parts(&|method| method == RayMethod::Rays);
        let moved = parts(&|method| method == RayMethod::Vertices);
        let layers = if plan.plans.layering.is_some() { parts(&|_| true) } else { Vec::new() };
        let traced = opaque.iter().copied().reduce(PictureTile::around).filter(|part| is_traced(plan, *part));
        let all = Where { opaque, traced, moved, layers };
        (input.technique == Technique::Accumulate && !all.is_empty()).then_some(all)
    }

    fn add_needs(parts: &Where, plan: &FramePlan, needs: &mut Needs) {
        needs.ray_hits |= parts.draws() && has_images(plan);
    }

    fn add_keys(&self, input: Option<&Where>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let Some(parts) = input else { return };
        let steps = [
            (parts.step(), !parts.opaque.is_empty()),
            (Step::Clear, !parts.moved.is_empty()),
            (Step::Move, !parts.moved.is_empty()),
        ];
        let asked = steps.into_iter().filter(|(_, is_asked)| *is_asked);
        keys.add_programs(24, asked.map(|(step, _)| RayKey::new(plan, programs, step)));
        if parts.draws() && has_images(plan) {
            let emits = [false, true].into_iter().filter(|emits| !emits || plan.texels_emit);
            keys.add(24, emits.map(|emits| RayImageKey::new(plan, emits)));
        }
    }

    fn prepare(&mut self, parts: &Where, stage: &mut Preparing) -> Result<(), GpuError> {
        let mut kept = match self.kept.take() {
            Some(kept) => kept,
            None => Kept::new(stage)?,
        };
        let (gpu, plan) = (stage.gpu, stage.plan);
        let mut is_stale = kept.meshes.fit(gpu, plan, &stage.cities, parts.follows())?;
        let placed = stage.cities.uniforms(plan.input.view.camera.eye, plan.input.operations);
        let cities = kept.meshes.traced(&plan.input.view, &placed);
        is_stale |= kept.cities.sync(gpu, &RayMeshes::uniform(&cities))?;
        if !parts.moved.is_empty() {
            let view = &plan.input.view;
            let pieces = pieces(plan.input.rays, view, &kept.meshes.cities(view, &placed));
            kept.pieces.sync(gpu, &pieces.all)?;
            kept.counts = pieces.counts.to_vec();
        }
        if is_stale {
            kept.group = group_of(stage, &kept.meshes, &kept.cities);
        }
        if let Some(part) = parts.traced {
            let view = plan.view_uniform();
            let view = TracedView { across_from_pixel: view.across_from_pixel, near: view.near };
            let started = Instant::now();
            let most = hits_of(plan, part);
            let (hits, rays) = trace(plan.input.rays, &view, &cities, part, most);
            self.figures = TracedFigures { rays, ms: started.elapsed().as_secs_f64() * 1e3 };
            let mut words = vec![part.origin[0], part.origin[1], part.size[0], most as u32];
            words.extend_from_slice(bytemuck::cast_slice(&hits));
            is_stale |= kept.traced.sync(gpu, &words)?;
            if is_stale || kept.traced_group.is_none() {
                kept.traced_group = Some(traced_group_of(stage, &kept));
            }
        }
        self.kept = Some(kept);
        Ok(())
    }

    fn record(
        &mut self,
        parts: &Where,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(kept) = &self.kept else { return Ok(()) };
        let Where { opaque, traced, moved, layers } = parts;
        board.put(Followed { parts: layers.clone(), group: kept.group.clone() });
        if !parts.draws() {
            return Ok(());
        }
        let FrameContext { targets, groups, plan, pipelines, .. } = *frame;
        let targeted = in_order([
            Some(&targets.codes),
            plan.colored.then_some(&targets.colors),
            plan.input.measured.then_some(&targets.own_depth),
            has_images(plan).then_some(&targets.ray_hits),
            None,
        ]);
        let colors: Vec<_> = targeted.into_iter().map(|target| target.map(|target| self::kept(&target.view))).collect();
        let lenses: Vec<u32> = plan.input.rays.lenses();
        let draw = |recording: &mut Recording, name, draw: &dyn Fn(&mut wgpu::RenderPass) -> Counted| {
            let pass = DrawnPass {
                name,
                view: "main",
                lenses: &lenses,
                shaded: Shaded::Counted,
                colors: &colors,
                depth: Some(kept_depth(&targets.depth.view)),
            };
            recording.draw(pass, |pass| {
                pass.set_bind_group(0, &groups.view, &[]);
                pass.set_bind_group(1, &groups.cut_city, &[0; 2]);
                pass.set_bind_group(2, &groups.lenses, &[]);
                pass.set_bind_group(3, &kept.group, &[]);
                draw(pass)
            });
        };
        let key = |step| RayKey::new(plan, frame.programs, step);
        if !opaque.is_empty() {
            draw(recording, "bent rays", &|pass| {
                pass.set_pipeline(pipelines.get(&key(parts.step())));
                if let Some(group) = kept.traced_group.as_ref().filter(|_| traced.is_some()) {
                    pass.set_bind_group(3, group, &[]);
                }
                draw_parts(pass, opaque)
            });
        }
        if !moved.is_empty() {
            draw(recording, "moved corners", &|pass| {
                pass.set_pipeline(pipelines.get(&key(Step::Clear)));
                let mut counted = draw_parts(pass, moved);
                pass.set_pipeline(pipelines.get(&key(Step::Move)));
                counted += kept.draw_pieces(pass, moved);
                counted
            });
        }
        if has_images(plan) && !kept.meshes.images.is_empty() {
            let parts = PictureTile::apart(opaque.iter().chain(moved).copied());
            kept.draw_images(&parts, frame, recording);
        }
        Ok(())
    }
}

/// Draws one triangle over parts of the picture.
fn draw_parts(pass: &mut wgpu::RenderPass, parts: &[PictureTile]) -> Counted {
    for part in parts {
        scissor(pass, *part);
        pass.draw(0..3, 0..1);
    }
    Counted { draws: parts.len() as u32, triangles: parts.len() as u64 }
}
