//! The maps of what sun and sky see: depth from them, drawn where a map does not hold this view yet.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cells::Details,
        cities::DrawnSection,
        city::{Chunk, CityBuffers, SectionKind, Texels, draws_of},
        cut::{Asked, Cut, Shapes},
        invokers::{InvokerPlans, Invokers},
        layout,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::{CutBy, draw_runs},
            section_kind::GeometryKind,
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{GroupLayout, KeptGroup, STORAGE, UNIFORM, group, one_of, whole},
            key::{Draw, Parts, PipelineKey, Stage, depth_test},
            layouts::{CITY, CUT_CITY, IMAGES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared_depth},
            synced::Synced,
            targets::{Needs, Target},
            vertices,
        },
        sun_eye::SunEye,
        surfaces::LEAST_SHADOW,
    },
    shader::{Module, Plan, Program, handlers},
    view::View,
};

/// Where something is hidden, group 2: object values, parameters, invokers, the main view, shapes, sprites.
static SHAPES: GroupLayout = GroupLayout {
    label: "shapes",
    entries: &[
        (1, S::FRAGMENT, STORAGE),
        (2, S::FRAGMENT, UNIFORM),
        (5, S::FRAGMENT, UNIFORM),
        (7, S::VERTEX, UNIFORM),
        (8, S::FRAGMENT, STORAGE),
        (9, S::FRAGMENT, STORAGE),
        (10, S::FRAGMENT, STORAGE),
    ],
};

/// Depth from the sun.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ShadowKey {
    /// What is hidden from it.
    hidden: Option<Program>,
    /// Of a texture with holes, the bits of the opacity below which there is one; and whether its faces lie in shared planes.
    holes: Option<(u32, bool)>,
}

impl ShadowKey {
    /// Those of a section, where something may be hidden.
    fn new(kind: SectionKind, hidden: Option<Program>) -> Self {
        let least = kind.images().and_then(|images| match images.texels {
            Texels::Opaque => None,
            Texels::Holes(least) => Some(least),
            Texels::Translucent => Some(LEAST_SHADOW.to_bits()),
        });
        let holes = least.map(|least| (least, kind.is_layer()));
        Self { hidden, holes }
    }
}

impl PipelineKey for ShadowKey {
    fn name(&self) -> String {
        let holes = if self.holes.is_some() { " with holes" } else { "" };
        format!("{}{holes}", Module::Shadow(self.hidden.clone()).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let images = self.holes.map(|_| &IMAGES);
        let (mut groups, mut fragment) = match self.hidden {
            Some(_) => (vec![Some(&VIEW), Some(&CUT_CITY), Some(&SHAPES)], Some("fragment")),
            None => (vec![Some(&VIEW), Some(&CITY), None], None),
        };
        groups.push(images);
        let (mut vertex, mut buffers) = ("vertex", vec![vertices::city()]);
        if let Some((_, is_layer)) = self.holes {
            let section = if is_layer { GeometryKind::Coplanar(None) } else { GeometryKind::Plain };
            (vertex, fragment, buffers) = ("vertex_textured", Some("textured"), section.texcoord_buffers());
        }
        Parts {
            module: Module::Shadow(self.hidden.clone()),
            groups,
            constants: self.holes.map(|(least, _)| ("LEAST", f64::from(f32::from_bits(least)))).into_iter().collect(),
            stage: Stage::Draw(Draw {
                buffers,
                depth: Some(depth_test(wgpu::CompareFunction::Greater, true)),
                ..Draw::new(vertex, fragment)
            }),
        }
    }
}

/// What a shadow map shows.
#[derive(Clone, Debug, PartialEq)]
struct Held {
    /// The sun's views.
    views: Vec<layout::View>,
    /// What is hidden from it, and all numbers that this depends on.
    cut: Option<(Program, Vec<u8>)>,
    /// Where contents stand.
    cities: Vec<u8>,
    /// In which detail the city throws it.
    details: Details,
    /// How often what may cast it became another.
    world: u64,
    /// The map.
    map: wgpu::Texture,
}

/// Depth from the sun.
pub type ShadowMap = LightMap<false>;
/// Depth from a point of the sky.
pub type SkyMap = LightMap<true>;

/// What the pass keeps.
#[derive(Debug)]
pub struct LightMap<const OF_SKY: bool> {
    /// What each level is seen with.
    views: Vec<(Synced, KeptGroup)>,
    cities: Synced,
    /// Where something is hidden: the main view, shapes of lens volumes, their planes, invokers.
    eye: Synced,
    shapes: Synced,
    shape_planes: Synced,
    invoker_table: Synced,
    invokers: Synced,
    city_group: KeptGroup,
    shapes_group: KeptGroup,
    /// What the map holds.
    held: Option<Held>,
}

impl<const OF_SKY: bool> LightMap<OF_SKY> {
    const NAME: &'static str = if OF_SKY { "sky map" } else { "shadow map" };
    const VIEW: &'static str = if OF_SKY { "sky" } else { "sun" };

    fn target<'a>(frame: &FrameContext<'a>) -> &'a Target {
        if OF_SKY { &frame.targets.sky } else { &frame.targets.shadow }
    }

    /// Brings what hides something from the sun up to date; whether bind groups are stale.
    fn upload_cut(&mut self, stage: &Preparing, cut: &Cut) -> Result<bool, GpuError> {
        let Shapes { eye, shapes, planes } = cut.shapes(stage.plan.input, stage.plan.own_sprites);
        let mut stale = self.eye.sync(stage.gpu, &[eye])?;
        stale |= self.shapes.sync(stage.gpu, &shapes)?;
        stale |= self.shape_planes.sync(stage.gpu, &planes)?;
        if stage.programs.is_uber {
            let none = Plan::default();
            let plans =
                InvokerPlans { context: &none, lenses: &none, hiding: Some(&cut.plan), lining: None, layering: None };
            let invokers = Invokers::new(plans, handlers());
            stale |= self.invoker_table.sync(stage.gpu, &invokers.table([0, 0]))?;
            stale |= self.invokers.sync(stage.gpu, invokers.all())?;
        }
        Ok(stale)
    }

    fn fit_groups(&mut self, frame: &FrameContext) {
        let FrameContext { gpu, pipelines, shared, cities, .. } = *frame;
        let stamp = shared.stamp;
        for (view, kept) in &mut self.views {
            kept.fit(stamp, || group(gpu, "sun's view", &pipelines.layout(&VIEW), &[(0, whole(view.buffer()))]));
        }
        self.city_group.fit(stamp, || {
            let entries = [
                (0, wgpu::BindingResource::TextureView(cities.surfaces())),
                (1, whole(self.shape_planes.buffer())),
                (2, whole(shared.solids.buffer())),
                (3, one_of::<layout::City>(&self.cities)),
                (4, one_of::<layout::City>(&shared.cities)),
            ];
            group(gpu, CUT_CITY.label, &pipelines.layout(&CUT_CITY), &entries)
        });
        self.shapes_group.fit(stamp, || {
            let entries = [
                (1, whole(shared.object_values.buffer())),
                (2, whole(shared.parameters.buffer())),
                (5, whole(self.invoker_table.buffer())),
                (7, whole(self.eye.buffer())),
                (8, whole(self.shapes.buffer())),
                (9, whole(self.invokers.buffer())),
                (10, whole(shared.sprites.buffer())),
            ];
            group(gpu, "shapes", &pipelines.layout(&SHAPES), &entries)
        });
    }

    /// Draws what a section has for a level of the sun's eye.
    fn draw_section(
        &self,
        frame: &FrameContext,
        pass: &mut wgpu::RenderPass,
        drawn: &DrawnSection,
        sun: &View,
        by: Option<CutBy>,
    ) -> Counted {
        let (view, cut) = (&frame.plan.input.view, by.map(|by| by.cut));
        let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, cut, view));
        // Casters may stand before the picture's edge, never behind the sun.
        let seen = CityBuffers::visible(shown, &sun.frustum(1.0), sun.camera.eye);
        let chunks: Vec<&Chunk> = seen.iter().map(|s| s.chunk).collect();
        pass.set_vertex_buffer(0, drawn.section.vertices.slice(..));
        let key = |hidden| ShadowKey::new(drawn.section.kind, hidden);
        if let Some((image, texcoords)) =
            drawn.image.zip(drawn.section.extra.as_ref()).filter(|_| key(None).holes.is_some())
        {
            pass.set_vertex_buffer(1, texcoords.slice(..));
            pass.set_bind_group(3, &image.drawn, &[]);
        }
        let mut counted = Counted::NONE;
        let asked = Asked { is_content: drawn.content.is_some(), keeps_order: false };
        for (part, is_cut) in Cut::parts(cut, view, &chunks, asked) {
            let (runs, triangles) = draws_of(part.into_iter());
            let program = by.filter(|_| is_cut).map(|by| by.program.clone());
            match program.is_some() {
                true => {
                    pass.set_bind_group(1, self.city_group.get(), &[drawn.offset; 2]);
                    pass.set_bind_group(2, self.shapes_group.get(), &[]);
                }
                false => pass.set_bind_group(1, &drawn.city.group, &[]),
            }
            pass.set_pipeline(frame.pipelines.get(&key(program)));
            draw_runs(pass, &drawn.section.indices, &runs);
            counted += Counted { draws: runs.len() as u32, triangles };
        }
        counted
    }
}

impl<const OF_SKY: bool> Pass for LightMap<OF_SKY> {
    /// The eye of the light.
    type Input<'a> = &'a SunEye;

    const LIST: &'static [Line] = match OF_SKY {
        false => &[("shadow map", "if the sun casts shadows and the map does not hold this view yet")],
        true => &[("sky map", "of several samples: what a point of the sky sees, in each another")],
    };

    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        let uniform = |label| Synced::new(gpu, label, U::UNIFORM);
        let storage = |label| Synced::new(gpu, label, U::STORAGE);
        Ok(Self {
            views: Vec::new(),
            cities: uniform("cities for the sun")?,
            eye: uniform("main view for the sun")?,
            shapes: storage("lens shapes for the sun")?,
            shape_planes: storage("lens planes for the sun")?,
            invoker_table: uniform("invoker table for the sun")?,
            invokers: storage("invokers for the sun")?,
            city_group: KeptGroup::default(),
            shapes_group: KeptGroup::default(),
            held: None,
        })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a SunEye> {
        if OF_SKY { plan.sky.as_ref() } else { plan.sun.as_ref() }
    }

    fn forget(&mut self) {
        self.held = None;
    }

    fn add_needs(sun: &&SunEye, _: &FramePlan, needs: &mut Needs) {
        let side = if OF_SKY { &mut needs.sky } else { &mut needs.shadow };
        *side = sun.size;
    }

    fn add_keys(&self, input: Option<&&SunEye>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let sections = || plan.sections.iter().filter(|_| input.is_some());
        keys.add(10, sections().map(|section| ShadowKey::new(section.kind, None)));
        let hidden = |program: &Program| {
            plan.sections.iter().map(move |s| ShadowKey::new(s.kind, Some(program.clone()))).collect::<Vec<_>>()
        };
        keys.add_programs(25, programs.made_for_sun.iter().flat_map(hidden));
    }

    fn prepare(&mut self, sun: &&SunEye, stage: &mut Preparing) -> Result<(), GpuError> {
        let mut stale = false;
        for level in 0..sun.levels.len() {
            if self.views.len() == level {
                let view = Synced::new(stage.gpu, "sun's view", wgpu::BufferUsages::UNIFORM)?;
                self.views.push((view, KeptGroup::default()));
            }
            stale |= self.views[level].0.sync(stage.gpu, &[sun.uniform(level)])?;
        }
        let eye = sun.widest().camera.eye;
        stale |= self.cities.sync(stage.gpu, &stage.cities.uniforms(eye, stage.plan.input.operations))?;
        if let Some(cut) = &stage.plan.cuts.sun {
            stale |= self.upload_cut(stage, cut)?;
        }
        if stale {
            let of_views = self.views.iter_mut().map(|(_, group)| group);
            of_views.chain([&mut self.city_group, &mut self.shapes_group]).for_each(KeptGroup::forget);
        }
        Ok(())
    }

    fn record(
        &mut self,
        sun: &&SunEye,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { plan, programs, shared, cities, .. } = *frame;
        let by = plan.cuts.sun.as_ref().zip(programs.sun.as_ref()).map(|(cut, program)| CutBy { cut, program });
        let numbers = |by: CutBy| (by.program.clone(), by.cut.all_numbers(plan.input, plan.own_sprites));
        let wanted = Held {
            views: (0..sun.levels.len()).map(|level| sun.uniform(level)).collect(),
            cut: by.map(numbers),
            cities: cities.uniforms(sun.widest().camera.eye, plan.input.operations),
            details: plan.details.clone(),
            world: shared.world,
            map: Self::target(frame).texture.clone(),
        };
        if self.held.as_ref() == Some(&wanted) {
            return Ok(());
        }
        self.held = Some(wanted);
        self.fit_groups(frame);
        let pass = DrawnPass {
            name: Self::NAME,
            view: Self::VIEW,
            lenses: by.map_or(&[][..], |by| &by.cut.hiding.lenses),
            shaded: Shaded::Unmeasured,
            colors: &[],
            depth: Some(cleared_depth(&Self::target(frame).view, 0.0)),
        };
        recording.draw(pass, |pass| {
            let mut counted = Counted::NONE;
            let sections = cities.drawn_sections(&plan.details, by.map(|by| by.cut));
            for (level, (view, (_, group))) in sun.levels.iter().zip(&self.views).enumerate() {
                let [left, top, side] = sun.place(level);
                let [x, y, width] = [left, top, side].map(|texels| texels as f32);
                pass.set_viewport(x, y, width, width, 0.0, 1.0);
                pass.set_scissor_rect(left, top, side, side);
                pass.set_bind_group(0, group.get(), &[]);
                for drawn in sections.iter().filter(|drawn| drawn.has_shadow) {
                    counted += self.draw_section(frame, pass, drawn, view, by);
                }
            }
            counted
        });
        Ok(())
    }
}
