//! `veduta effects`: what lenses can do to what they show.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use crate::{
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        report::wrap,
        terminal::{self, Paint},
    },
    lens::{
        measures::{MEASURES, Measure},
        ramp::{RAMPS, Ramp, RampKind},
    },
    shader::{
        effect::{self, EffectDefinition, ParameterDefinition, PerObject},
        effect_file::{checked, redefined},
    },
};

const EXAMPLES: &str = "\
Examples:
  veduta effects
  veduta effects thematic
  veduta effects --json | jq '.[].name'
  veduta effects --check my-effect.wgsl
  veduta effects --effects my-effects/";

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
    /// Say whether effect files of your own are right, and do nothing else
    #[arg(long, value_name = "FILE.wgsl", num_args = 1.., conflicts_with_all = ["names", "json"])]
    pub check: Vec<PathBuf>,
}

/// Adds the effects in a user's folders. A broken file is reported and left out; the rest works.
pub fn add_folders(folders: &[PathBuf], global: &GlobalArguments) -> Outcome {
    for folder in folders {
        let name = format!("--effects {}", folder.display());
        let unread = |error| Failure::io(&format!("{name}: cannot be read"), &error);
        let entries = std::fs::read_dir(folder).map_err(unread)?;
        let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        files.retain(|path| path.extension().is_some_and(|e| e == "wgsl"));
        files.sort();
        if files.is_empty() {
            return Err(Failure::failed(format!("{name}: there is no effect (*.wgsl) in this folder")));
        }
        for file in files {
            let name = file.display().to_string();
            let text = text_of_file(&file)?;
            match effect::add(&name, &text) {
                _ if global.quiet => {}
                Ok(_) => tell_redefined(&name, &text),
                Err(error) => {
                    let paint = Paint::for_stderr();
                    terminal::say(&format!("{} {error}; this effect is left out", paint.warning("warning:")));
                }
            }
        }
    }
    Ok(())
}

/// Tells which names of a file are those of what effects are given.
fn tell_redefined(name: &str, text: &str) {
    redefined(name, text).iter().for_each(|note| terminal::say(&format!("note: {note}")));
}

fn text_of_file(file: &Path) -> Outcome<String> {
    let name = file.display().to_string();
    let bytes = std::fs::read(file).map_err(|error| Failure::io(&name, &error))?;
    String::from_utf8(bytes).map_err(|_| Failure::failed(format!("{name}: expected WGSL, which is UTF-8 text")))
}

/// Checks files; the first broken one fails the command after all were reported.
fn check(files: &[PathBuf]) -> Outcome {
    let mut broken = Vec::new();
    for file in files {
        let name = file.display().to_string();
        let text = text_of_file(file)?;
        match checked(&name, &text) {
            Ok(effect) if effect::handlers().iter().any(|h| h.name == effect.name) => broken
                .push(format!("{name}:1:1: there is an effect \"{}\" already; expected another name", effect.name)),
            Ok(effect) => {
                output::print(&format!("{name}: \"{}\" is right\n", effect.name))?;
                tell_redefined(&name, &text);
            }
            Err(error) => broken.push(error.to_string()),
        }
    }
    if broken.is_empty() { Ok(()) } else { Err(Failure::failed(broken.join("\n"))) }
}

/// Lists the effects.
pub fn run(arguments: &Arguments, _: &GlobalArguments) -> Outcome {
    if !arguments.check.is_empty() {
        return check(&arguments.check);
    }
    if let Some(unknown) = arguments.names.iter().find(|name| !effect::named().any(|handler| handler.name == **name)) {
        let message = crate::lens::effect::unknown_effect(unknown);
        return Err(crate::cli::failure::Failure::usage(format!("effects: {message}")));
    }
    let is_asked = |effect: &&EffectDefinition| arguments.names.is_empty() || arguments.names.contains(&effect.name);
    let effects = effect::named().filter(is_asked);
    if arguments.json {
        let list: Vec<Value> = effects.map(json_of).collect();
        return output::print(&(serde_json::to_string_pretty(&list).map_err(Failure::failed)? + "\n"));
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
            "default": if p.is_required() { Value::Null } else { p.default_text().into() },
            "required": p.is_required(),
            "unit": p.unit,
            "doc": p.doc,
        })
    };
    let mut all = json!({
        "name": effect.name,
        "kind": effect.kind.name(),
        "spec": effect.spec,
        "doc": effect.doc,
        "parameters": effect.parameters.iter().map(parameter).collect::<Vec<_>>(),
    });
    if effect.objects == Some(PerObject::Colors) {
        let ramp = |row: &Ramp| json!({ "name": row.name, "kind": row.kind.name(), "by": row.source });
        let measure = |row: &Measure| json!({ "name": row.name, "unit": row.unit, "doc": row.doc });
        all["ramps"] = RAMPS.iter().map(ramp).collect();
        all["measures"] = MEASURES.iter().map(measure).collect();
    }
    all
}

/// The ramps by kind, and what is measured, for terminals.
fn text_of_colors(paint: Paint, width: usize) -> String {
    let mut text = String::new();
    for kind in RampKind::ALL {
        let names: Vec<&str> = RAMPS.iter().filter(|row| row.kind == kind).map(|row| row.name).collect();
        text += &format!("    {}\n", paint.strong(&format!("{} ramps", kind.name())));
        wrap(&names.join(", "), width).iter().for_each(|line| text += &format!("        {line}\n"));
    }
    text += &format!("    {}\n", paint.strong("measures, as attributes"));
    for measure in &MEASURES {
        let line = format!("{} ({}): {}", measure.name, measure.unit, measure.doc);
        wrap(&line, width).iter().for_each(|line| text += &format!("        {line}\n"));
    }
    text
}

fn text_of(effect: &EffectDefinition, paint: Paint) -> String {
    const WIDTH: usize = 96;
    let kind = format!("{}, {}", effect.kind.name(), effect.spec);
    let mut text = format!("{}  {}\n  {}\n", paint.heading(&effect.name), paint.faint(&kind), effect.doc);
    for p in &effect.parameters {
        let unit = if p.unit.is_empty() { String::new() } else { format!(", unit: {}", p.unit) };
        let default = if p.is_required() { "required".to_owned() } else { format!("default {}", p.default_text()) };
        let takes = format!("{}{unit}; {default}", p.kind.describe());
        text += &format!("    {}\n", paint.strong(&p.name));
        for line in wrap(&p.doc, WIDTH - 8) {
            text += &format!("        {line}\n");
        }
        for line in wrap(&takes, WIDTH - 8) {
            text += &format!("        {}\n", paint.faint(&line));
        }
    }
    if effect.objects == Some(PerObject::Colors) {
        text += &text_of_colors(paint, WIDTH - 8);
    }
    text
}
