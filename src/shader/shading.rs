//! Shading written out: `shade`, `styled`, `outlines`, `write_classes` and what they call, for the passes that shade, by either back
//! end.

use crate::shader::{
    carried::{self, Carried},
    effect::EffectDefinition,
    plan::Program,
    specialised, uber,
};

/// What differs between the passes that shade.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    /// How many vectors are carried from vertices to fragments; `None`: uniforms are read where they stand.
    pub(super) room: Option<u32>,
    /// Whether all stands in one target, of which a shader sees the surface and another the background.
    pub(super) is_of_surfaces: bool,
    /// How many `vec4f` of the parameters other parts of the module read; 0: there are none.
    pub(super) slots: u32,
}

impl Shading {
    /// Of the shown surfaces, and of what is behind the city.
    pub(super) fn of_surfaces(room: u32) -> Self {
        Self { room: Some(room), is_of_surfaces: true, slots: 0 }
    }

    /// Of translucent layers. Their pixels are no other shader's, whatever is opaque behind them.
    pub(super) fn of_layers(room: u32) -> Self {
        Self { room: Some(room), is_of_surfaces: false, slots: 0 }
    }

    /// Of fragments where they are drawn, by a module that reads so many `vec4f` of the parameters for other ends.
    pub(super) fn of_fragments(slots: u32) -> Self {
        Self { room: None, is_of_surfaces: false, slots }
    }
}

/// What shading says, and what is carried for it. `names` of a plan's lenses become comments.
pub(super) fn written(program: &Program, handlers: &[EffectDefinition], names: &[&str], shading: &Shading) -> Carried {
    let (own, of_scene) = match program {
        Program::Specialised(plan) => {
            let own = shading.room.map_or_else(carried::nothing, |room| carried::of_plan(plan, handlers, room));
            (own, specialised::source(plan, handlers, names, shading))
        }
        Program::Uber(uber) => (carried::nothing(), uber::source(uber, handlers, shading)),
    };
    Carried { functions: own.functions + &of_scene, ..own }
}

/// `opacity_at`, for translucent layers.
pub(super) fn opacity(program: &Program, handlers: &[EffectDefinition]) -> String {
    match program {
        Program::Specialised(plan) => specialised::opacity(plan, handlers),
        Program::Uber(uber) => uber::opacity(uber, handlers),
    }
}
