//! City files as the commands load them: with a progress line on a terminal and readable failures.

use std::path::{Path, PathBuf};

use crate::{
    city::{
        CityModel,
        crs::Frames,
        load::{self, LoadOptions, LoadStats, Stage},
    },
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        terminal,
    },
    field,
    scene::CitySpec,
    text::one_line,
};

/// Shows which file loading is at.
struct Shown {
    line: terminal::Progress,
}

impl load::Progress for Shown {
    fn enter(&self, stage: Stage, file: usize, files: usize, path: &Path) {
        let verb = match stage {
            Stage::Read => "reading",
            Stage::Parse => "parsing",
            Stage::Build => "triangulating",
        };
        let which = if files > 1 && file < files { format!(" ({}/{files})", file + 1) } else { String::new() };
        let message = format!("{verb} {}{which}", path.display());
        log::debug!("{message}");
        self.line.says(message);
    }
}

/// Loads `files` as one city, with how long each stage took.
pub fn load(files: &[PathBuf], global: &GlobalArguments) -> Outcome<(CityModel, LoadStats)> {
    let options =
        LoadOptions { allow_outside: global.allow_outside, roots: named_folders(files), ..LoadOptions::default() };
    load_with(files, &options, global)
}

/// Loads the city that a scene, or a command, means, in the frames of another city where it has any.
pub fn load_city(spec: &CitySpec, frames: Frames, global: &GlobalArguments) -> Outcome<(CityModel, LoadStats)> {
    let options = LoadOptions {
        allow_outside: global.allow_outside,
        roots: named_folders(&spec.files),
        up: spec.up,
        materials: spec.materials,
        joins: spec.joins.clone(),
        changes: (spec.changes.clone(), spec.dating.clone()),
        timetables: spec.timetables.clone(),
        frames,
        ..LoadOptions::default()
    };
    load_with(&spec.files, &options, global)
}

/// [`load()`], with folders that paths inside the files may lead to, those of the files themselves always among them, and with what
/// files leave open.
pub fn load_with(
    files: &[PathBuf],
    options: &LoadOptions,
    global: &GlobalArguments,
) -> Outcome<(CityModel, LoadStats)> {
    let shown = Shown { line: terminal::Progress::spinning("loading", global) };
    if let Some(file) = files.iter().find(|file| field::is_field(file)) {
        let name = one_line(&file.display().to_string());
        let message =
            format!("{name}: is a volume, not a city model; in a scene, [[volume]] file = \"{name}\" would be right");
        return Err(Failure::failed(message));
    }
    let (city, stats) = load::load_with_stats(files, options, &shown).map_err(Failure::failed)?;
    drop(shown);
    log::info!(
        "{} objects, {} triangles: read {:.0?}, parsed {:.0?}, built {:.0?}",
        city.objects.len(),
        city.indices.len() / 3,
        stats.read,
        stats.parse,
        stats.build
    );
    Ok((city, stats))
}

/// Folders among what was named on the command line: paths in models may lead anywhere inside them.
fn named_folders(files: &[PathBuf]) -> Vec<PathBuf> {
    files.iter().filter(|path| path.is_dir()).cloned().collect()
}
