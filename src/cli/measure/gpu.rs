//! `veduta measure gpu`: what the graphics adapter does.

use std::{path::Path, time::Duration};

use crate::{
    cli::{
        Failure, GlobalArguments, Outcome,
        measure::{Arguments, quoted, today},
        output, terminal,
    },
    figure::file::write_whole,
    lens::nearest::did_you_mean,
    measure::topics::gpu::{self, Plan, markdown::markdown, patience::Watch, report::Report},
};

/// Its name.
pub const NAME: &str = "gpu";
/// Its purpose, as it is listed.
pub const ABOUT: &str = "What the graphics adapter does: hard cases, pictures against references, and frames.";

/// The number of times that frames are timed, unless told otherwise.
const ROUNDS: u32 = 31;
/// Width and height of frames, unless told otherwise.
const SIZE: [u32; 2] = [1280, 720];

/// Probes the adapter, or draws the references anew.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let known = gpu::names();
    if let Some(wrong) = arguments.only.iter().find(|name| !known.contains(name)) {
        let near = did_you_mean(wrong, known.iter().map(String::as_str));
        let hint = if near.is_empty() { format!("; there are {}", known.join(", ")) } else { near };
        return Err(Failure::usage(format!("measure gpu: --only: there is no \"{wrong}\"{hint}")));
    }
    if arguments.write_references {
        return write_references(arguments, global);
    }
    let Some(folder) = &arguments.output else {
        return Err(Failure::usage("measure gpu: where to? -o DIR would be right"));
    };
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    let report = watched(global, |watch| {
        gpu::probe(&plan(arguments, folder), watch).map_err(|error| Failure::failed(format!("measure gpu: {error}")))
    })?;
    if report.is_software && !global.quiet {
        terminal::say(&format!("note: {} is a software adapter: no GPU was probed", report.adapter.name));
    }
    write(&report, folder, arguments.json)?;
    let failures = report.failures();
    match failures.len() {
        0 => Ok(()),
        n => Err(Failure::failed(format!("measure gpu: {n} of {} fail\n{}", report.count(), failures.join("\n")))),
    }
}

fn plan(arguments: &Arguments, folder: &Path) -> Plan {
    let size = arguments.size.map_or(SIZE, |size| size.0);
    let rounds = arguments.pairs.unwrap_or(ROUNDS);
    let mut command = format!("veduta measure gpu --size {}x{} --pairs {rounds}", size[0], size[1]);
    command += &format!(" --minutes {}", arguments.minutes);
    if !arguments.city.is_empty() {
        let files: Vec<String> = arguments.city.iter().map(|file| quoted(&file.display().to_string())).collect();
        command += &format!(" --city {}", files.join(" "));
    }
    for name in &arguments.only {
        command += &format!(" --only {}", quoted(name));
    }
    command += &format!(" -o {}", quoted(&folder.display().to_string()));
    Plan {
        limit: Duration::from_secs_f64(60.0 * arguments.minutes),
        only: arguments.only.clone(),
        scenes: arguments.scenes.clone(),
        city: arguments.city.clone(),
        size,
        rounds: rounds as usize,
        command,
        date: today(),
    }
}

/// Works with a progress line.
fn watched<T>(global: &GlobalArguments, work: impl FnOnce(Watch<'_>) -> T) -> T {
    let mut shown: Option<(String, terminal::Progress)> = None;
    work(&mut |what, done, total| {
        if shown.as_ref().is_none_or(|(at, _)| at != what) {
            log::info!("gpu: {what}");
            // The old line goes before the new one comes.
            shown = None;
            shown = Some((what.to_owned(), terminal::Progress::counting(total as u64, what, "done", global)));
        }
        if let Some((_, line)) = &shown {
            line.at(done as u64);
        }
    })
}

/// Both files are made before the first is written; the one to read comes last, so that where it is both are.
fn write(report: &Report, folder: &Path, to_stdout: bool) -> Outcome {
    let mut json = serde_json::to_string_pretty(&report.json()).map_err(Failure::failed)?;
    json.push('\n');
    let text = markdown(report);
    let file = |extension: &str| folder.join(format!("{NAME}.{extension}"));
    for (extension, text) in [("json", &json), ("md", &text)] {
        write_whole(&file(extension), |out| out.write_all(text.as_bytes())).map_err(output::unwritten)?;
    }
    if to_stdout {
        return output::print(&json);
    }
    output::print(&["md", "json"].map(|extension| format!("{}\n", file(extension).display())).concat())
}

fn write_references(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let folder = gpu::pictures::reference(&arguments.scenes, "");
    let folder = folder.parent().unwrap_or(&arguments.scenes);
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    let files = watched(global, |watch| gpu::write_references(&arguments.scenes, &arguments.only, watch))
        .map_err(|error| Failure::failed(format!("measure gpu: {error}")))?;
    output::print(&files.iter().map(|file| format!("{}\n", file.display())).collect::<String>())
}
