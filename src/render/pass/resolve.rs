//! The mean of samples, after the last of several.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::context::{Board, FrameContext, Keys, Line, Pass},
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{FLOATS, GroupLayout, KeptGroup, UNIFORM, all_of, group, whole},
            formats::PICTURE,
            key::{Draw, Parts, PipelineKey, Stage, target},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared},
        },
    },
    shader::Module,
};

/// Group 0: how many samples, and their sum.
static RESOLVE: GroupLayout =
    GroupLayout { label: "resolve", entries: &[(0, S::FRAGMENT, UNIFORM), (1, S::FRAGMENT, FLOATS)] };

/// The only one.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ResolveKey;

impl PipelineKey for ResolveKey {
    fn name(&self) -> String {
        "resolve".to_owned()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Resolve,
            groups: vec![Some(&RESOLVE)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw { targets: vec![target(PICTURE, None)], ..Draw::new("vertex", Some("fragment")) }),
        }
    }
}

/// What the pass keeps.
#[derive(Debug)]
pub struct Resolve {
    group: KeptGroup,
}

impl Pass for Resolve {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[("resolve", "the mean of the samples, after the last of several")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { group: KeptGroup::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        let input = plan.input;
        (input.is_summed() && input.is_last()).then_some(())
    }

    fn add_keys(&self, _: Option<&()>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        keys.add(32, plan.input.is_summed().then_some(ResolveKey));
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let targets = frame.targets;
        self.group.fit(frame.shared.stamp, || {
            let entries = [(0, whole(frame.shared.samples.buffer())), (1, all_of(&targets.sums))];
            group(frame.gpu, "resolve", &frame.pipelines.layout(&RESOLVE), &entries)
        });
        let pass = DrawnPass {
            name: "resolve",
            view: "main",
            lenses: &[],
            shaded: Shaded::Uncounted,
            colors: &[Some(cleared(&targets.picture.view, wgpu::Color::TRANSPARENT))],
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(frame.pipelines.get(&ResolveKey));
            pass.set_bind_group(0, self.group.get(), &[]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
        Ok(())
    }
}
