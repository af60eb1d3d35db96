//! Clearing the lens masks, which shading then writes.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::context::{Board, FrameContext, Line, Pass},
        plan::FramePlan,
        resource::{
            recording::{Counted, DrawnPass, Recording, Shaded, cleared},
            targets::Needs,
        },
    },
};

/// Name of the pass that empties the lens masks; where it ran, they hold this frame's classes.
pub const CLEAR_MASKS: &str = "clear lens masks";

/// It keeps nothing.
#[derive(Debug)]
pub struct ClearMasks;

impl Pass for ClearMasks {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[(CLEAR_MASKS, "where AOVs or statistics ask for them")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self)
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        (plan.has_lenses() && plan.input.wants_masks()).then_some(())
    }

    fn add_needs((): &(), plan: &FramePlan, needs: &mut Needs) {
        needs.mask_layers = plan.input.mask_layers();
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let layers = frame.plan.input.mask_layers() as usize;
        for some in frame.targets.masks.layers[..layers].chunks(4) {
            let colors: Vec<_> = some.iter().map(|view| Some(cleared(view, wgpu::Color::TRANSPARENT))).collect();
            let pass = DrawnPass {
                name: CLEAR_MASKS,
                view: "main",
                lenses: &[],
                shaded: Shaded::Unmeasured,
                colors: &colors,
                depth: None,
            };
            recording.draw(pass, |_| Counted::NONE);
        }
        Ok(())
    }
}
