//! Bent rays: what lenses that bend them show, in the targets of what is opaque (`pass/rays.wgsl`).

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        bent,
        eye::PictureTile,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::in_order,
        },
        plan::FramePlan,
        programs::Programs,
        ray_meshes::RayMeshes,
        resource::{
            bindings::{GroupLayout, STORAGE, UNIFORM, group, whole},
            formats::{COLORS, OWN_DEPTH, codes},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CUT_CITY, LENSES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, kept_depth, scissor},
            synced::Synced,
        },
    },
    scene::Technique,
    shader::{Bends, Module, Program},
};

/// Group 3: cities, and the triangles of their meshes.
pub static RAYS: GroupLayout = GroupLayout { label: "rays", entries: &[(0, S::FRAGMENT, UNIFORM), (1, S::FRAGMENT, STORAGE)] };

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
}

impl RayKey {
    fn new(plan: &FramePlan, programs: &Programs) -> Self {
        Self {
            hidden: programs.picture.clone(),
            bends: plan.input.operations.bends,
            colored: plan.colored,
            smooth: plan.smooth,
            measured: plan.input.measured,
        }
    }
}

impl PipelineKey for RayKey {
    fn name(&self) -> String {
        let flags = words(&[(self.colored, "colored"), (self.smooth, "smooth"), (self.measured, "measured")]);
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
                    None,
                    None,
                ]),
                depth: Some(depth_test(wgpu::CompareFunction::Always, true)),
                ..Draw::new("vertex", Some("follow"))
            }),
        }
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

impl Pass for Rays {
    /// Where in the picture.
    type Input<'a> = Vec<PictureTile>;

    const LIST: &'static [Line] = &[("bent rays", "what lenses that bend rays show, in place of what was drawn there")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Vec<PictureTile>> {
        let input = plan.input;
        let parts = bent::parts(input.rays, &input.view, input.tile);
        let is_asked = !parts.is_empty() && input.technique == Technique::Accumulate;
        is_asked.then(|| parts.iter().map(|part| part.rectangle()).collect())
    }

    fn add_keys(&self, input: Option<&Vec<PictureTile>>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        if input.is_some() {
            keys.add_programs(24, [RayKey::new(plan, programs)]);
        }
    }

    fn prepare(&mut self, _: &Vec<PictureTile>, stage: &mut Preparing) -> Result<(), GpuError> {
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
        parts: &Vec<PictureTile>,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(kept) = &self.0 else { return Ok(()) };
        board.put(Followed { parts: parts.clone(), group: kept.group.clone() });
        let FrameContext { targets, groups, plan, .. } = *frame;
        let targeted = in_order([
            Some(&targets.codes),
            plan.colored.then_some(&targets.colors),
            plan.input.measured.then_some(&targets.own_depth),
            None,
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
        Ok(())
    }
}
