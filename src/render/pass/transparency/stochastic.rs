//! Layers that are there by chance (`lib/chance.wgsl`), into the targets of what is opaque.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        layers::LayerFigures,
        layout,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            layering::{LayerPrograms, Layering},
            opaque::in_order,
            translucent::draw_translucent,
            transparency::fragments::{FORWARD, FragmentKey, FragmentPass, Slots},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{group, one_of, whole},
            layouts::SHADE,
            recording::{DrawnPass, Recording, Shaded, kept, kept_depth},
            targets::Needs,
        },
        shared::ShadedTargets,
    },
    scene::Transparency,
};

/// What the pass keeps: what the last frame had of layers.
#[derive(Debug)]
pub struct StochasticLayers {
    pub figures: LayerFigures,
}

impl StochasticLayers {
    /// Where the fragments are shaded: nothing is bound that is drawn into.
    fn groups(frame: &FrameContext) -> [wgpu::BindGroup; 2] {
        let FrameContext { gpu, pipelines, shared, targets, cities, .. } = *frame;
        let no_band = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: shared.view.buffer(),
            offset: 0,
            size: wgpu::BufferSize::new(16),
        });
        let entries = [
            (0, whole(shared.view.buffer())),
            (2, whole(shared.object_values.buffer())),
            (4, no_band),
            (5, one_of::<layout::City>(&shared.cities)),
        ];
        let view = group(gpu, "fragments", &pipelines.layout(&FORWARD), &entries);
        let colors = &targets.transparency.view;
        let read = ShadedTargets { codes: cities.surfaces(), depth: &targets.shadow.view, colors, emissions: colors };
        let shading = shared.shading(&cities, targets, read);
        [view, group(gpu, "shade without targets", &pipelines.layout(&SHADE), &shading)]
    }
}

impl Pass for StochasticLayers {
    type Input<'a> = Layering<'a>;

    const LIST: &'static [Line] = &[("stochastic", "layers that are there by chance, in place of lists")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { figures: LayerFigures::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Layering<'a>> {
        Layering::of(plan).filter(|_| plan.input.transparency == Transparency::Stochastic)
    }

    fn begin(&mut self, _: &FramePlan) {
        self.figures = LayerFigures::default();
    }

    fn add_needs(_: &Layering, plan: &FramePlan, needs: &mut Needs) {
        Layering::add_needs(plan, needs);
    }

    fn add_keys(&self, input: Option<&Layering>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        let (Some(_), Some(programs)) = (input, LayerPrograms::of(programs)) else { return };
        let key = |s: &crate::render::city_facts::SectionFacts| {
            FragmentKey::new(plan, programs, FragmentPass::Chance, Slots::NONE, s.kind.into(), s.is_smooth)
        };
        keys.add(30, plan.sections.iter().map(key));
    }

    fn record(
        &mut self,
        layering: &Layering,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(programs) = LayerPrograms::of(frame.programs) else { return Ok(()) };
        layering.clear(frame, recording)?;
        if layering.region.is_none() {
            return Ok(());
        }
        let FrameContext { targets, groups, plan, .. } = *frame;
        let [view, shade] = Self::groups(frame);
        let colors = in_order([
            Some(kept(&targets.codes.view)),
            plan.colored.then(|| kept(&targets.colors.view)),
            plan.input.measured.then(|| kept(&targets.own_depth.view)),
            None,
            plan.texels_emit.then(|| kept(&targets.emissions.view)),
        ]);
        let pass = DrawnPass {
            name: FragmentPass::Chance.name(),
            view: "main",
            lenses: layering.lenses(),
            shaded: Shaded::Counted,
            colors: &colors,
            depth: Some(kept_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            pass.set_bind_group(1, &shade, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            draw_translucent(
                frame,
                pass,
                layering.cut,
                false,
                |s, _| FragmentKey::new(plan, programs, FragmentPass::Chance, Slots::NONE, s.kind.into(), s.is_smooth),
                |pass, offset| pass.set_bind_group(0, &view, &[0, offset]),
            )
        });
        self.figures.bands = 1;
        Ok(())
    }
}
