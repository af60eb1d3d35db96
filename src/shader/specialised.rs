//! The specialised back end: a plan written out, with nothing in it that the scene does not ask for.

use std::fmt::Write as _;

use crate::shader::{
    bodies, effect::definition::EffectDefinition, epochs, masks, plan::Plan, regions, shading::Shading, writer::Writer,
};

/// `shade`, `styled`, `outlines`, `write_classes` and what they call, for `pass/shade.wgsl`. `names` of the plan's lenses
/// become comments.
pub(super) fn source(plan: &Plan, handlers: &[EffectDefinition], names: &[&str], shading: &Shading) -> String {
    let writer = Writer { plan, handlers, names };
    let mut text = writer.bindings(shading.slots, shading.room.is_some());
    for effect in writer.used() {
        let _ = write!(text, "// ==== effect {}\n\n{}\n", effect.name, effect.source.trim_end());
        text.push('\n');
    }
    text.push_str("// ==== this scene\n\n");
    text.push_str(&writer.classes());
    text.push_str(&if plan.varies { writer.moments() } else { String::new() });
    text.push_str(epochs::is_lit_here(plan.lit));
    match &plan.regions {
        None => {
            text.push_str(&writer.shade(""));
            text.push_str(&writer.styled(""));
        }
        Some(regions) => text.push_str(&regions::branches(plan, regions, handlers)),
    }
    text.push_str(&bodies::outlines(plan));
    text.push_str(&masks::write_classes(plan, shading.is_of_surfaces));
    text
}

/// `opacity_at`, for `pass/composite.wgsl`.
pub(super) fn opacity(plan: &Plan, handlers: &[EffectDefinition]) -> String {
    Writer { plan, handlers, names: &[] }.opacity()
}

/// `kept_of_field`, for the fields of `pass/composite.wgsl`.
pub(super) fn kept(plan: &Plan, handlers: &[EffectDefinition]) -> String {
    Writer { plan, handlers, names: &[] }.kept()
}

/// A filter's kernel, for `pass/filter.wgsl`.
pub(super) fn kernel(filter: &EffectDefinition) -> String {
    // Its radius, if nothing else, is a parameter.
    format!(
        "var<private> parameters: array<vec4f, {}>;\n\n{}\n\nalias Own = {};\n\n\
         fn own_parameters() -> Own {{\n    return {}(0u);\n}}\n\nfn kernel(offset: f32, own: Own) -> f32 {{\n    return {}(offset, own);\n}}\n",
        filter.slots(),
        filter.source.trim_end(),
        filter.own("Parameters"),
        filter.own("parameters"),
        filter.wgsl_name()
    )
}
