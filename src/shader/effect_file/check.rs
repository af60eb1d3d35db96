//! Users' effect files checked: that they can do no harm, and that their WGSL is right.

use std::sync::Arc;

use crate::shader::{
    deforming::{DeformPlan, PlanControl, PlanDeformer, PlanStep},
    effect::{
        definition::EffectDefinition,
        prototype::{AskedBy, EffectKind, Mode, Prototype, Stage},
    },
    effect_file::{
        bounds::check_bounds,
        cost::check_cost,
        error::{File, FileError},
        flow::check_control_flow,
        read::{body_of, read_with_names, signature},
        redefined::check_types,
    },
    host::HostProgram,
    library::MOMENT,
    module::Module,
    plan::{
        Plan, RAY_NUMBERS,
        program::Program,
        step::{Scope, Step},
    },
    wgsl::token,
};

/// Lines of a user's file: more than any effect needs, few enough to compile in no time.
const MOST_LINES: usize = 2000;
/// Bytes of a user's file.
const MOST_BYTES: usize = 128 * 1024;

/// Reads a user's effect file and checks that it can do no harm: its size, that its loops end, and its WGSL.
pub fn checked(path: &str, text: &str) -> Result<EffectDefinition, FileError> {
    let file = File { path, text };
    if text.len() > MOST_BYTES || text.lines().count() > MOST_LINES {
        let message = format!("an effect file has at most {MOST_LINES} lines and {MOST_BYTES} bytes");
        return Err(file.error(0, message));
    }
    let (mut effect, renamed) = read_with_names(path, text, true)?;
    if effect.objects.is_some() || effect.parameters.iter().any(|p| p.kind.is_ramp()) {
        let message = "objects, and parameters of type shares and colors, are for effects of the program";
        return Err(file.error(0, message));
    }
    check_types(&effect, &file)?;
    check_bounds(&file)?;
    check_control_flow(&file)?;
    check_cost(&file)?;
    let row = effect.kind.prototype();
    // Deformations alone have an order that one may be left out of.
    let has_mode = effect.mode == Mode::Local || (row.stage == Stage::Vertex && effect.mode != Mode::Global);
    if !has_mode || effect.has_derivative || !row.is_for_users() {
        let message = format!(
            "mode (but of deformations), derivative, and {}, are for handlers of the program; expected kind = {}",
            Prototype::words_not_for_users(),
            Prototype::words_for_users()
        );
        return Err(file.error(0, message));
    }
    if effect.kind == EffectKind::Ray && effect.slots() as usize > RAY_NUMBERS {
        let message = format!("a ray handler has at most {} numbers of parameters", 4 * RAY_NUMBERS);
        return Err(file.error(0, message));
    }
    let source = module_of(&effect);
    let body = body_of(&renamed.text).trim_end();
    let Some(own) = source.find(effect.source.trim_end()) else { unreachable!("a module without its only effect") };
    let begin = own + effect.parameters_end;
    let before = renamed.text.len() - body_of(&renamed.text).len();
    let place = |at: Option<usize>| match at {
        Some(at) if (begin..=begin + body.len()).contains(&at) => renamed.original(at - begin + before),
        // Beside the file: where it is called. Its signature is not what the caller expects.
        _ => token::declarations(text, &token::tokens(text))
            .iter()
            .find(|d| d.name == "effect")
            .map_or(0, |d| d.span.start),
    };
    let prefix = effect.own("");
    // Names in a message are the author's. Beside the file is the call: then the signature is wrong, whatever the parser makes of it.
    let own = |at: Option<usize>, message: String| match at {
        Some(at) if (begin..=begin + body.len()).contains(&at) => message.replace(&prefix, ""),
        _ => format!("expected `{}`", signature(&effect)),
    };
    let parsed = wgpu::naga::front::wgsl::parse_str(&source).map_err(|error| {
        let at = error.labels().next().and_then(|(span, _)| span.to_range()).map(|range| range.start);
        file.error(place(at), own(at, error.message().to_owned()))
    })?;
    let capabilities =
        wgpu::naga::valid::Capabilities::default() | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let mut validator = wgpu::naga::valid::Validator::new(wgpu::naga::valid::ValidationFlags::all(), capabilities);
    validator.validate(&parsed).map_err(|error| {
        let at = error.spans().next().and_then(|(span, _)| span.to_range()).map(|range| range.start);
        file.error(place(at), own(at, in_words(error.as_inner())))
    })?;
    if !matches!(row.asked_by, AskedBy::Effects | AskedBy::Program) {
        let program = HostProgram::new(&effect).map_err(|unknown| {
            let at = unknown.at.map(|range| begin + range.start.saturating_sub(effect.parameters_end));
            file.error(place(at), unknown.message)
        })?;
        effect.host = Some(Arc::new(program));
    }
    Ok(effect)
}

/// A module in which a handler alone does something.
pub(super) fn module_of(effect: &EffectDefinition) -> String {
    let steps = vec![Step { effect: 0, scope: Scope::Everywhere, parameters: 0, blend: None }];
    let plan = Plan { steps, ..Plan::default() };
    let handlers = std::slice::from_ref(effect);
    let module = match effect.kind {
        EffectKind::Filter => Module::Filter(0),
        EffectKind::Hide => Module::Geometry(Some(Program::Specialised(plan))),
        EffectKind::Opacity => Module::Composite(Program::Specialised(plan)),
        EffectKind::Deform => {
            let steps = vec![PlanStep::new(0, handlers)];
            let deformer = PlanDeformer { control: PlanControl::Everywhere, has_band: false, steps };
            Module::Refine(DeformPlan(vec![deformer]))
        }
        EffectKind::Region | EffectKind::Transform | EffectKind::Ray => return called_alone(effect),
        EffectKind::Epoch => return chained_alone(effect),
        _ => Module::Shade(Program::Specialised(plan)),
    };
    module.source_with(handlers)
}

/// A handler with a caller, and nothing else.
fn called_alone(effect: &EffectDefinition) -> String {
    let row = effect.kind.prototype();
    let parameters = if effect.slots() > 0 { format!(", {}(0u)", effect.own("parameters")) } else { String::new() };
    format!(
        "{}\n{}\nfn call(place: {}, size: vec3f) -> {} {{\n    return {}(place, size{parameters});\n}}\n",
        effect.array_of_parameters(),
        effect.source,
        row.subject.1,
        row.result,
        effect.wgsl_name(),
    )
}

/// A time operator with a caller, and nothing else.
fn chained_alone(effect: &EffectDefinition) -> String {
    let parameters = if effect.slots() > 0 { format!(", {}(0u)", effect.own("parameters")) } else { String::new() };
    format!(
        "{}var<private> object_values: array<u32, {}>;\n\n{}\nfn call(moment: Moment) -> Moment {{\n    return {}(moment{parameters});\n}}\n",
        MOMENT.paragraph(),
        effect.floats().max(1),
        effect.source,
        effect.wgsl_name(),
    )
}

/// The message of a validator, without the numbers by which it knows things.
fn in_words(error: &dyn std::error::Error) -> String {
    let mut innermost = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    let message = innermost.to_string();
    if message.contains("expression None does not match") {
        return "not every way through the function returns a value".to_owned();
    }
    // `[7] (of type Vector { size: Tri, ... })` is a vec3f; other handles are left out.
    let mut text = String::new();
    let mut rest = message.as_str();
    while let Some((before, after)) = rest.split_once('[') {
        let (number, tail) = after.split_once(']').unwrap_or(("", after));
        text.push_str(before);
        if !number.bytes().all(|b| b.is_ascii_digit()) || number.is_empty() {
            text.push('[');
            rest = after;
            continue;
        }
        rest = tail.trim_start();
        if let Some((kind, tail)) = rest.strip_prefix("(of type ").and_then(|r| r.split_once("})")) {
            let size = [("Bi", "vec2"), ("Tri", "vec3"), ("Quad", "vec4")]
                .into_iter()
                .find(|(word, _)| kind.contains(&format!("size: {word},")));
            text.push_str(size.map_or("another type", |(_, name)| name));
            rest = tail.strip_prefix(')').unwrap_or(tail);
        }
    }
    text.push_str(rest);
    text
}
