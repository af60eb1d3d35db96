//! The shader programs of a frame, by the back end that they are made by.

use crate::{
    render::{cut::Cuts, frame::FrameInput, plans::Plans},
    shader::Program,
};

/// What the passes of a frame run.
#[derive(Clone, Debug)]
pub(super) struct Programs {
    /// Shading outside of where lenses are and rays are bent, and inside.
    pub context: Program,
    pub lenses: Program,
    /// What hides something in the picture, and from the sun, where something may be hidden in this frame.
    pub picture: Option<Program>,
    pub sun: Option<Program>,
    /// The same for which pipelines are made, whether or not something is in view: a lens that moves compiles nothing.
    pub made_for_picture: Option<Program>,
    pub made_for_sun: Option<Program>,
    /// What lines go through.
    pub lining: Option<Program>,
    /// What is made of translucent layers.
    pub layering: Option<Program>,
    /// Whether they are the uber back end's.
    pub is_uber: bool,
}

/// What the city has, in view or not, that modules of the uber back end are made for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    pub has_shadows: bool,
    /// Whether some materials are translucent.
    pub clear_materials: bool,
}

impl Programs {
    /// Written out.
    pub fn specialised(plans: &Plans, cuts: &Cuts) -> Self {
        let program = |plan: &crate::shader::Plan| Program::Specialised(plan.clone());
        let picture = cuts.picture.as_ref().map(|cut| program(&cut.plan));
        let sun = cuts.sun.as_ref().map(|cut| program(&cut.plan));
        Self {
            context: program(&plans.context).with_straight_rays(),
            lenses: program(&plans.lenses),
            made_for_picture: picture.clone(),
            made_for_sun: sun.clone(),
            picture,
            sun,
            lining: plans.lining.as_ref().map(program),
            layering: plans.layering.as_ref().map(program),
            is_uber: false,
        }
    }

    /// From the invoker table.
    pub fn uber(input: &FrameInput, plans: &Plans, cuts: &Cuts, made: Made) -> Self {
        let Made { has_shadows, clear_materials } = made;
        let (haze, masks) = (input.haze_per_radius() > 0.0, input.wants_masks());
        let shading = match input.operations.looks_like_context() && !masks {
            true => Program::Specialised(plans.context.clone()),
            false => Program::Uber(input.operations.uber(haze, masks, clear_materials)),
        };
        let [picture, sun] = input.operations.uber_hiding(clear_materials).map(|uber| uber.map(Program::Uber));
        let layering = input.operations.uber_layering(haze, masks, clear_materials);
        let layering = layering.filter(|_| plans.layering.is_some());
        Self {
            context: shading.clone().with_straight_rays(),
            lenses: shading,
            picture: cuts.picture.as_ref().and(picture.clone()),
            sun: cuts.sun.as_ref().and(sun.clone()),
            made_for_picture: picture,
            made_for_sun: sun.filter(|_| has_shadows),
            lining: input.operations.uber_lining().map(Program::Uber),
            layering: layering.map(Program::Uber),
            is_uber: true,
        }
    }
}
