//! Bent rays: what lenses that bend them show, in the targets of what is opaque (`pass/rays.wgsl`).

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
        resource::{
            bindings::{DEPTHS, GroupLayout, NUMBERS, STORAGE, UNIFORM, all_of, group, whole},
            formats::{COLORS, EMISSIONS, OWN_DEPTH, RAY_HITS, codes},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CUT_CITY, IMAGES, LENSES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, kept_depth, scissor},
            synced::Synced,
            targets::Needs,
        },
    },
    scene::Technique,
    shader::{Bends, Module, Program},
};

/// Group 3: cities, and the triangles of their meshes.
pub static RAYS: GroupLayout =
    GroupLayout { label: "rays", entries: &[(0, S::FRAGMENT, UNIFORM), (1, S::FRAGMENT, STORAGE)] };

/// Rays that are followed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct RayKey {
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
    fn new(plan: &FramePlan, programs: &Programs) -> Self {
        Self {
            hidden: programs.picture.clone(),
            bends: plan.input.operations.bends,
            colored: plan.colored,
            smooth: plan.smooth,
            measured: plan.input.measured,
            imaged: has_images(plan),
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
        ]);
        format!("{}{flags}", Module::Rays(self.hidden.clone(), self.bends).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Rays(self.hidden.clone(), self.bends),
            groups: vec![Some(&VIEW), Some(&CUT_CITY), Some(&LENSES), Some(&RAYS)],
            constants: vec![("SMOOTH", flag(self.smooth))],
            stage: Stage::Draw(Draw {
                targets: in_order([
                    Some(codes(self.smooth).into()),
                    self.colored.then(|| COLORS.into()),
                    self.measured.then(|| OWN_DEPTH.into()),
                    self.imaged.then(|| RAY_HITS.into()),
                    None,
                ]),
                depth: Some(depth_test(wgpu::CompareFunction::Always, true)),
                ..Draw::new("vertex", Some("follow"))
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
    /// To all that is translucent, whatever the lens: images do not show it.
    layers: Vec<PictureTile>,
}

/// Where rays are bent, and what they are followed through: for passes that follow them, too.
#[derive(Clone, Debug)]
pub struct Followed {
    pub parts: Vec<PictureTile>,
    pub group: wgpu::BindGroup,
}

/// What the pass keeps, once there were lenses that bend rays.
#[derive(Debug)]
pub struct Rays(Option<Kept>);

#[derive(Debug)]
struct Kept {
    meshes: RayMeshes,
    cities: Synced,
    group: wgpu::BindGroup,
}

impl Kept {
    fn new(stage: &Preparing) -> Result<Self, GpuError> {
        let meshes = RayMeshes::new(stage.gpu)?;
        let cities = Synced::new(stage.gpu, "cities of rays", wgpu::BufferUsages::UNIFORM)?;
        let group = group_of(stage, &meshes, &cities);
        Ok(Self { meshes, cities, group })
    }
}

fn group_of(stage: &Preparing, meshes: &RayMeshes, cities: &Synced) -> wgpu::BindGroup {
    let entries = [(0, whole(cities.buffer())), (1, whole(meshes.words.buffer()))];
    group(stage.gpu, RAYS.label, &stage.pipelines.layout(&RAYS), &entries)
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
        ("images of rays", "and its images, where it has some"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Where> {
        let input = plan.input;
        let parts = |is_wanted: &dyn Fn(RayMethod) -> bool| bent::parts(input.rays, &input.view, input.tile, is_wanted);
        let opaque = parts(&|method| method == RayMethod::Rays);
        let layers = if plan.plans.layering.is_some() { parts(&|_| true) } else { Vec::new() };
        let is_asked = input.technique == Technique::Accumulate && !(opaque.is_empty() && layers.is_empty());
        is_asked.then_some(Where { opaque, layers })
    }

    fn add_needs(parts: &Where, plan: &FramePlan, needs: &mut Needs) {
        needs.ray_hits |= !parts.opaque.is_empty() && has_images(plan);
    }

    fn add_keys(&self, input: Option<&Where>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        if input.is_some_and(|parts| !parts.opaque.is_empty()) {
            keys.add_programs(24, [RayKey::new(plan, programs)]);
            if has_images(plan) {
                let emits = [false, true].into_iter().filter(|emits| !emits || plan.texels_emit);
                keys.add(24, emits.map(|emits| RayImageKey::new(plan, emits)));
            }
        }
    }

    fn prepare(&mut self, _: &Where, stage: &mut Preparing) -> Result<(), GpuError> {
        let mut kept = match self.0.take() {
            Some(kept) => kept,
            None => Kept::new(stage)?,
        };
        let (gpu, plan) = (stage.gpu, stage.plan);
        let mut is_stale = kept.meshes.fit(gpu, plan, &stage.cities)?;
        let placed = stage.cities.uniforms(plan.input.view.camera.eye, plan.input.operations);
        is_stale |= kept.cities.sync(gpu, &kept.meshes.uniform(plan, &placed))?;
        if is_stale {
            kept.group = group_of(stage, &kept.meshes, &kept.cities);
        }
        self.0 = Some(kept);
        Ok(())
    }

    fn record(
        &mut self,
        Where { opaque: parts, layers }: &Where,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(kept) = &self.0 else { return Ok(()) };
        board.put(Followed { parts: layers.clone(), group: kept.group.clone() });
        if parts.is_empty() {
            return Ok(());
        }
        let FrameContext { targets, groups, plan, .. } = *frame;
        let targeted = in_order([
            Some(&targets.codes),
            plan.colored.then_some(&targets.colors),
            plan.input.measured.then_some(&targets.own_depth),
            has_images(plan).then_some(&targets.ray_hits),
            None,
        ]);
        let colors: Vec<_> = targeted.into_iter().map(|target| target.map(|target| self::kept(&target.view))).collect();
        let lenses: Vec<u32> = plan.input.rays.lenses();
        let pass = DrawnPass {
            name: "bent rays",
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            colors: &colors,
            depth: Some(kept_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(frame.pipelines.get(&RayKey::new(plan, frame.programs)));
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &groups.cut_city, &[0; 2]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            pass.set_bind_group(3, &kept.group, &[]);
            for part in parts {
                scissor(pass, *part);
                pass.draw(0..3, 0..1);
            }
            Counted { draws: parts.len() as u32, triangles: parts.len() as u64 }
        });
        if has_images(plan) && !kept.meshes.images.is_empty() {
            kept.draw_images(parts, frame, recording);
        }
        Ok(())
    }
}
