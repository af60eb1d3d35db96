//! `veduta effects`: what lenses can do to what they show.

use std::path::Path;

use clap::Args;
use serde_json::{Value, json};

use crate::{
    cli::{GlobalArguments, Outcome, output, report::wrap, terminal::Paint},
    lens::effect::{EFFECTS, EffectDefinition, ParameterDefinition},
};

const EXAMPLES: &str = "\
Examples:
  veduta effects
  veduta effects thematic
  veduta effects --json | jq '.[].name'";

/// Arguments of `veduta effects`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Only these effects
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Write a JSON array instead of text
    #[arg(long)]
    pub json: bool,
}

/// Lists the effects.
pub fn run(arguments: &Arguments, _: &GlobalArguments) -> Outcome {
    if let Some(unknown) = arguments.names.iter().find(|name| crate::lens::effect::find(name).is_none()) {
        let message = crate::lens::effect::unknown_effect(unknown);
        return Err(crate::cli::Failure::usage(format!("effects: {message}")));
    }
    let is_asked = |effect: &&EffectDefinition| {
        arguments.names.is_empty() || arguments.names.iter().any(|name| name == effect.name)
    };
    let effects = EFFECTS.iter().filter(is_asked);
    if arguments.json {
        let list: Vec<Value> = effects.map(json_of).collect();
        return output::write(Path::new("-"), |out| {
            serde_json::to_writer_pretty(&mut *out, &list)?;
            writeln!(out)
        });
    }
    let paint = Paint::for_stdout();
    let texts: Vec<String> = effects.map(|effect| text_of(effect, paint)).collect();
    output::print(&texts.join("\n"))
}

fn json_of(effect: &EffectDefinition) -> Value {
    let parameter = |p: &ParameterDefinition| {
        json!({
            "name": p.name,
            "takes": p.kind.describe(),
            "default": if p.required { Value::Null } else { p.default.into() },
            "required": p.required,
            "unit": p.unit,
            "doc": p.doc,
        })
    };
    json!({
        "name": effect.name,
        "kind": effect.kind.name(),
        "spec": effect.spec,
        "doc": effect.doc,
        "parameters": effect.parameters.iter().map(parameter).collect::<Vec<_>>(),
    })
}

fn text_of(effect: &EffectDefinition, paint: Paint) -> String {
    const WIDTH: usize = 96;
    let kind = format!("{}, {}", effect.kind.name(), effect.spec);
    let mut text = format!("{}  {}\n  {}\n", paint.heading(effect.name), paint.faint(&kind), effect.doc);
    for p in effect.parameters {
        let unit = if p.unit.is_empty() { String::new() } else { format!(", unit: {}", p.unit) };
        let default = if p.required { "required".to_owned() } else { format!("default {}", p.default) };
        let takes = format!("{}{unit}; {default}", p.kind.describe());
        text += &format!("    {}\n", paint.strong(p.name));
        for line in wrap(p.doc, WIDTH - 8) {
            text += &format!("        {line}\n");
        }
        for line in wrap(&takes, WIDTH - 8) {
            text += &format!("        {}\n", paint.faint(&line));
        }
    }
    text
}
