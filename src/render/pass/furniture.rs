//! Titles, captions and legends over the finished picture. Straight alpha cannot be blended by fixed function: over a transparent picture
//! they are drawn into a layer first.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        furniture::Furniture,
        furniture_on_gpu::{FurnitureKey, FurnitureOnGpu, FurnitureOverKey, Over},
        pass::context::{Board, FrameContext, Keys, Line, Pass, Preparing},
        plan::FramePlan,
        programs::Programs,
        resource::recording::{Counted, DrawnPass, Recording, Shaded, cleared, kept},
    },
};

/// What the pass keeps, once a picture had some.
#[derive(Debug)]
pub struct FurniturePass(Option<FurnitureOnGpu>);

impl Pass for FurniturePass {
    type Input<'a> = &'a Furniture;

    const LIST: &'static [Line] = &[
        ("furniture", "title, caption, legends: over the last sample"),
        ("furniture over", "its layer, where the picture is transparent"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a Furniture> {
        plan.input.wants_furniture().then_some(plan.input.furniture)
    }

    fn add_keys(&self, input: Option<&&Furniture>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        let Some(furniture) = input else { return };
        let layered = plan.input.transparent;
        keys.add(33, furniture.parts().map(|part| FurnitureKey { layered, part }));
        keys.add(33, layered.then_some(FurnitureOverKey));
    }

    fn prepare(&mut self, furniture: &&Furniture, stage: &mut Preparing) -> Result<(), GpuError> {
        let own = match &mut self.0 {
            Some(own) => own,
            none => none.insert(FurnitureOnGpu::new(stage.gpu)?),
        };
        let input = stage.plan.input;
        let over = Over { whole: input.view.size, tile: input.tile, layered: input.transparent };
        own.fit(stage.gpu, stage.pipelines, stage.images, furniture, over)
    }

    fn record(
        &mut self,
        _: &&Furniture,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(own) = self.0.as_ref().filter(|own| own.counts().draws > 0) else { return Ok(()) };
        let FrameContext { gpu, pipelines, images, targets, .. } = *frame;
        let picture = &targets.picture;
        let color = match own.layer() {
            Some(layer) => cleared(layer, wgpu::Color::TRANSPARENT),
            None => kept(&picture.view),
        };
        let pass = DrawnPass {
            name: "furniture",
            view: "main",
            lenses: &[],
            shaded: Shaded::Counted,
            colors: &[Some(color)],
            depth: None,
        };
        recording.draw(pass, |pass| {
            own.draw(pass, gpu, pipelines, images, frame.plan.input.transparent);
            own.counts()
        });
        let Some(over) = own.copied(&mut recording.encoder, &picture.texture) else { return Ok(()) };
        let pass = DrawnPass {
            name: "furniture over",
            view: "main",
            lenses: &[],
            shaded: Shaded::Unmeasured,
            colors: &[Some(cleared(&picture.view, wgpu::Color::TRANSPARENT))],
            depth: None,
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(pipelines.get(&FurnitureOverKey));
            pass.set_bind_group(0, over, &[]);
            pass.draw(0..3, 0..1);
            Counted::ONE
        });
        Ok(())
    }
}
