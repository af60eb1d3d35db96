//! Layers that are the shown surface take the place of what is opaque, where AOVs are asked for.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            layering::{LayerPrograms, Layering, shows_layers},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{FLOATS, GroupLayout, NUMBERS, all_of, group},
            formats::{OWN_DEPTH, codes},
            key::{Draw, Parts, PipelineKey, Stage},
            recording::{Counted, DrawnPass, Recording, Shaded, kept},
        },
    },
    shader::Module,
};

/// Group 0: which layers are the shown surface, and their depth.
static SHOWN_LAYERS: GroupLayout =
    GroupLayout { label: "shown layers", entries: &[(0, S::FRAGMENT, NUMBERS), (1, S::FRAGMENT, FLOATS)] };

/// Layers that are the shown surface.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ShownKey {
    /// Normals are in the target.
    smooth: bool,
    /// Depth is written, for the AOV.
    measured: bool,
}

impl ShownKey {
    fn of(plan: &FramePlan) -> Self {
        Self { smooth: plan.smooth, measured: plan.input.measured }
    }
}

impl PipelineKey for ShownKey {
    fn name(&self) -> String {
        Module::ShownLayers.name()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let own_depth = self.measured.then(|| Some(OWN_DEPTH.into()));
        Parts {
            module: Module::ShownLayers,
            groups: vec![Some(&SHOWN_LAYERS)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                targets: std::iter::once(Some(codes(self.smooth).into())).chain(own_depth).collect(),
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// It keeps nothing.
#[derive(Debug)]
pub struct ShownLayers;

impl Pass for ShownLayers {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[("shown layers", "where AOVs are asked for")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self)
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        (shows_layers(plan) && Layering::of(plan).is_some()).then_some(())
    }

    fn add_keys(&self, input: Option<&()>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let is_asked = input.is_some() && LayerPrograms::of(programs).is_some();
        keys.add_programs(28, is_asked.then(|| ShownKey::of(plan)));
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        if LayerPrograms::of(frame.programs).is_none() {
            return Ok(());
        }
        let targets = frame.targets;
        let entries = [(0, all_of(&targets.shown_code)), (1, all_of(&targets.shown_depth))];
        let shown = group(frame.gpu, "shown layers", &frame.pipelines.layout(&SHOWN_LAYERS), &entries);
        let colors = [&targets.codes, &targets.own_depth].map(|target| Some(kept(&target.view)));
        let pass = DrawnPass {
            name: "shown layers",
            view: "main",
            lenses: &[],
            shaded: Shaded::Unmeasured,
            colors: &colors[..if frame.plan.input.measured { 2 } else { 1 }],
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(frame.pipelines.get(&ShownKey::of(frame.plan)));
            pass.set_bind_group(0, &shown, &[]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
        Ok(())
    }
}
