//! Screen-space ambient occlusion of a picture of one sample: how much of the sky each place sees, as far as the picture tells, at half the
//! resolution. Pictures of several samples have the sky's own maps.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            geometry::Drawing,
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{DEPTHS, GroupLayout, KeptGroup, NUMBERS, all_of, group},
            formats::OCCLUSION,
            key::{Draw, Parts, PipelineKey, Stage, flag, target},
            layouts::VIEW,
            recording::{Counted, DrawnPass, Recording, Shaded, kept},
            targets::Needs,
        },
    },
    shader::Module,
};

/// Group 1: surfaces, and the targets of what is opaque.
static SEEN: GroupLayout = GroupLayout {
    label: "ambient occlusion",
    entries: &[(0, S::FRAGMENT, NUMBERS), (6, S::FRAGMENT, NUMBERS), (7, S::FRAGMENT, DEPTHS)],
};

/// The share of the sky that is seen.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct OcclusionKey {
    /// Normals are in the target.
    smooth: bool,
}

impl PipelineKey for OcclusionKey {
    fn name(&self) -> String {
        Module::AmbientOcclusion.name()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::AmbientOcclusion,
            groups: vec![Some(&VIEW), Some(&SEEN)],
            constants: vec![("SMOOTH", flag(self.smooth))],
            stage: Stage::Draw(Draw {
                targets: vec![target(OCCLUSION, None)],
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// What the pass keeps.
#[derive(Debug)]
pub struct AmbientOcclusion {
    group: KeptGroup,
    /// Of which drawing of the city the target holds it.
    held: Option<(Drawing, wgpu::Texture)>,
}

impl Pass for AmbientOcclusion {
    type Input<'a> = ();

    const LIST: &'static [Line] =
        &[("ambient occlusion", "of one sample, where it is asked for: how much of the sky the picture's places see")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { group: KeptGroup::default(), held: None })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        plan.has_screen_occlusion().then_some(())
    }

    fn forget(&mut self) {
        self.held = None;
    }

    fn add_needs((): &(), _: &FramePlan, needs: &mut Needs) {
        needs.occlusion = true;
    }

    fn add_keys(&self, input: Option<&()>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        keys.add(15, input.map(|()| OcclusionKey { smooth: plan.smooth }));
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { gpu, pipelines, shared, groups, targets, cities, plan, .. } = *frame;
        let wanted = board.get::<Drawing>().map(|drawing| (*drawing, targets.occlusion.texture.clone()));
        if wanted.is_some() && self.held == wanted {
            return Ok(());
        }
        self.held = wanted;
        self.group.fit(shared.stamp, || {
            let entries = [
                (0, wgpu::BindingResource::TextureView(cities.surfaces())),
                (6, all_of(&targets.codes)),
                (7, all_of(&targets.depth)),
            ];
            group(gpu, SEEN.label, &pipelines.layout(&SEEN), &entries)
        });
        let pass = DrawnPass {
            name: "ambient occlusion",
            view: "main",
            lenses: &[],
            shaded: Shaded::Unmeasured,
            colors: &[Some(kept(&targets.occlusion.view))],
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(pipelines.get(&OcclusionKey { smooth: plan.smooth }));
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, self.group.get(), &[]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
        Ok(())
    }
}
