//! Shading by either back end: `shade`, `styled`, `outlines`, `write_classes` and what they call, for the passes that shade.

use crate::shader::{
    carried::{self, Carried},
    effect::definition::EffectDefinition,
    plan::{Bends, program::Program},
    shading::Shading,
    specialised, uber,
};

/// Shading written out, with what is carried for it. `names` of a plan's lenses become comments.
pub(super) fn shading(program: &Program, handlers: &[EffectDefinition], names: &[&str], pass: &Shading) -> Carried {
    let room = pass.room.unwrap_or_default();
    // Modules that carry nothing bend no rays.
    let bends = if pass.room.is_some() { program.has().bends } else { Bends::default() };
    let (own, of_scene) = match program {
        Program::Specialised(plan) => {
            let own = match pass.room {
                Some(room) => carried::of_plan(plan, handlers, room),
                None => carried::nothing(bends, room),
            };
            (own, specialised::source(plan, handlers, names, pass))
        }
        Program::Uber(uber) => (carried::nothing(bends, room), uber::source(uber, handlers, pass)),
    };
    Carried { functions: own.functions + &of_scene, ..own }
}

/// `kept_of_field`: how much lenses leave of a field at a place, where the scene has some.
pub(super) fn kept(program: &Program, handlers: &[EffectDefinition]) -> String {
    match program {
        _ if !program.has().fields => String::new(),
        Program::Specialised(plan) => specialised::kept(plan, handlers),
        Program::Uber(uber) => uber::kept(uber, handlers),
    }
}

/// `opacity_at`, for translucent layers.
pub(super) fn opacity(program: &Program, handlers: &[EffectDefinition]) -> String {
    match program {
        Program::Specialised(plan) => specialised::opacity(plan, handlers),
        Program::Uber(uber) => uber::opacity(uber, handlers),
    }
}
