//! `veduta measure`: what accuracy costs in time.

mod gpu;

use std::{
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use clap::Args;

use crate::{
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        render::{self, arguments::Size},
        terminal,
    },
    figure::{file::write_whole, picture, scene_file::Options},
    lens::nearest::did_you_mean,
    measure::{
        Measurement, Setup, Step, TOPICS, Topic,
        plot::{self, raster},
        report::{self, Origin},
    },
    render::parts::TILE,
    scene::Scene,
};

const EXAMPLES: &str = "\
Examples:
  veduta measure                                what can be measured
  veduta measure samples -o out
  veduta measure sprites -o out --city city.city.json --size 1280x720 --pairs 101
  veduta measure samples -o out --json | jq '.variants[] | select(.is_pareto) | .label'
  veduta measure gpu -o out                     hard cases, pictures and frames on this GPU

DIR gets TOPIC.md (a table), TOPIC.json (all figures), TOPIC.svg and TOPIC.png (the plot). docs/measure.md says how to
read them. Run it while nothing else runs.";

/// The city that is measured on, where none is named.
const TOWN: &str = "builtin:town";

/// Arguments of `veduta measure`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// What to measure; without it, the topics are listed
    #[arg(value_name = "TOPIC")]
    pub topic: Option<String>,
    /// The folder to write to; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// How often all variants are timed in turn [default: 15; gpu: 31]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub pairs: Option<u32>,
    /// Width and height of the pictures in pixels [default: 640x360; gpu: 1280x720]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// City files to measure on [default: the built-in town; gpu: 36,000 synthetic buildings]
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub city: Vec<PathBuf>,
    /// Write the JSON to stdout as well; without TOPIC, the list of topics
    #[arg(long)]
    pub json: bool,
    /// gpu: how long it may take at most; what does not fit is left out
    #[arg(long, value_name = "N", default_value_t = 10.0, value_parser = minutes)]
    pub minutes: f64,
    /// gpu: only this check, scene or frame; repeatable
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// gpu: the folder of the scenes and of their references
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub scenes: PathBuf,
    /// gpu: draw the references of the scenes anew on a software adapter, OVERWRITING those that are there; measures nothing
    #[arg(long)]
    pub write_references: bool,
}

impl Arguments {
    /// Width and height of the pictures of topics, pixels.
    fn size(&self) -> [u32; 2] {
        self.size.map_or(SIZE, |size| size.0)
    }

    /// The number of times that the variants of topics are timed.
    fn pairs(&self) -> u32 {
        self.pairs.unwrap_or(PAIRS)
    }
}

/// The size that topics are measured with, unless told otherwise.
const SIZE: [u32; 2] = [640, 360];
const PAIRS: u32 = 15;

/// A length of time, minutes.
fn minutes(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n| (0.0..=1e6).contains(n));
    number.ok_or_else(|| "minutes from 0 to 1,000,000 would be right".to_owned())
}

/// Lists the topics, or measures one.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let Some(name) = &arguments.topic else { return list(arguments.json) };
    if arguments.size().iter().any(|side| *side > TILE) {
        return Err(Failure::usage(format!("measure: --size: at most {TILE} pixels on a side can be measured")));
    }
    if name == gpu::NAME {
        return gpu::run(arguments, global);
    }
    if arguments.write_references || !arguments.only.is_empty() {
        return Err(Failure::usage(format!("measure {name}: --only and --write-references are for `measure gpu`")));
    }
    let topic = TOPICS.iter().find(|topic| topic.name == name).ok_or_else(|| unknown(name))?;
    let Some(folder) = &arguments.output else {
        return Err(Failure::usage(format!("measure {name}: where to? -o DIR would be right")));
    };
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    let written = ["json", "svg", "png", "md"].map(|extension| folder.join(format!("{name}.{extension}")));
    output::check(&written, [])?;
    let mut scene = Scene::default();
    scene.city.files = if arguments.city.is_empty() { vec![TOWN.into()] } else { arguments.city.clone() };
    let options = Options { allow_outside: global.allow_outside, ..Options::for_command_line() };
    let (mut studio, _) = render::open(&scene, &options, &written, global)?;
    let mut setup =
        Setup { studio: &mut studio, city: &scene.city, size: arguments.size(), pairs: arguments.pairs() as usize };
    let measured = watched(topic, &mut setup, global)?;
    let origin = origin(arguments, topic, &scene);
    write(&measured, &origin, folder, arguments.json)
}

/// Measures with a progress line.
fn watched(topic: &'static Topic, setup: &mut Setup<'_>, global: &GlobalArguments) -> Outcome<Measurement> {
    let mut shown: Option<(Step, terminal::Progress)> = None;
    let mut watch = |step: Step, done: usize, total: usize| {
        let (what, unit) = match step {
            Step::Comparing => ("comparing pictures", "pictures"),
            Step::Starting => ("starting afresh", "starts"),
            Step::Timing => ("timing", "frames"),
        };
        if shown.as_ref().is_none_or(|(at, _)| *at != step) {
            log::info!("{}: {what}, {total} {unit}", topic.name);
            // The old line goes before the new one comes.
            shown = None;
            shown = Some((step, terminal::Progress::counting(total as u64, what, unit, global)));
        }
        if let Some((_, line)) = &shown {
            line.at(done as u64);
        }
    };
    crate::measure::measure(topic, setup, &mut watch)
        .map_err(|error| Failure::failed(format!("measure {}: {error}", topic.name)))
}

/// Table, JSON and plot; the table last, so that where it is everything is.
fn write(measured: &Measurement, origin: &Origin, folder: &Path, to_stdout: bool) -> Outcome {
    let name = measured.topic.name;
    let file = |extension: &str| folder.join(format!("{name}.{extension}"));
    let mut json = serde_json::to_string_pretty(&report::json(measured, origin)).map_err(Failure::failed)?;
    json.push('\n');
    let drawing = plot::svg(measured, origin);
    let (size, pixels) = raster::pixels(&drawing, plot::PNG_SCALE)
        .map_err(|error| Failure::failed(format!("{}: {error}", file("png").display())))?;
    let text = |extension: &str, text: &str| {
        write_whole(&file(extension), |out| out.write_all(text.as_bytes())).map_err(output::unwritten)
    };
    text("json", &json)?;
    text("svg", &drawing)?;
    picture::save_picture(&file("png"), size, &pixels, true, &picture::notes(None)).map_err(output::unwritten)?;
    text("md", &report::markdown(measured, origin))?;
    if to_stdout {
        return output::print(&json);
    }
    let paths = ["md", "json", "svg", "png"].map(|extension| format!("{}\n", file(extension).display()));
    output::print(&paths.concat())
}

fn origin(arguments: &Arguments, topic: &Topic, scene: &Scene) -> Origin {
    let [width, height] = arguments.size();
    let mut command = format!("veduta measure {} --size {width}x{height} --pairs {}", topic.name, arguments.pairs());
    let city: Vec<String> = scene.city.files.iter().map(|file| file.display().to_string()).collect();
    if !arguments.city.is_empty() {
        let quoted: Vec<String> = city.iter().map(|file| quoted(file)).collect();
        command += &format!(" --city {}", quoted.join(" "));
    }
    if let Some(folder) = &arguments.output {
        command += &format!(" -o {}", quoted(&folder.display().to_string()));
    }
    Origin { command, city, date: today() }
}

/// The day, UTC, `2026-11-21`.
fn today() -> String {
    report::date(SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO))
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=+,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

fn unknown(name: &str) -> Failure {
    let known = || TOPICS.iter().map(|topic| topic.name).chain([gpu::NAME]);
    let near = did_you_mean(name, known());
    let hint = if near.is_empty() { format!("; there are {}", known().collect::<Vec<_>>().join(", ")) } else { near };
    Failure::usage(format!("measure: no topic \"{name}\"{hint}"))
}

fn list(as_json: bool) -> Outcome {
    if as_json {
        let topic = |t: &Topic| {
            serde_json::json!({
                "name": t.name, "title": t.title, "about": t.about, "sources": t.sources, "reference": t.reference,
                "knobs": t.knobs,
            })
        };
        let list: Vec<_> = TOPICS.iter().map(topic).collect();
        let mut text = serde_json::to_string_pretty(&list).map_err(Failure::failed)?;
        text.push('\n');
        return output::print(&text);
    }
    let paint = terminal::Paint::for_stdout();
    let widest = TOPICS.iter().map(|topic| topic.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for topic in TOPICS {
        let space = " ".repeat(widest - topic.name.len());
        text += &format!(
            "{}{space}  {} {}\n",
            paint.strong(topic.name),
            topic.about,
            paint.faint(&topic.sources.join(", "))
        );
    }
    let space = " ".repeat(widest.saturating_sub(gpu::NAME.len()));
    text += &format!("{}{space}  {}\n", paint.strong(gpu::NAME), gpu::ABOUT);
    output::print(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_can_be_pasted() {
        assert_eq!(quoted("out/a-b_1.json"), "out/a-b_1.json");
        assert_eq!(quoted("two words"), "'two words'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
