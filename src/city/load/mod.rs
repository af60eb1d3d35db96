//! From paths to one city: finds out what each file is, reads it into one [`ModelBuilder`], builds.
//!
//! ```text
//! path ─ input (read, gunzip, BOM) ─ sniff (what is it?) ─ cityjson | gltf | obj ─> ModelBuilder ─ finish ─> CityModel
//! ```

pub mod error;
pub mod input;
pub mod options;
pub mod progress;
mod sniff;

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

pub use error::LoadError;
pub use input::Input;
pub use options::{LFS_POINTER, LoadOptions, Sibling, Up};
pub use progress::{Progress, Quiet, Stage};

use crate::{
    city::{
        build::ModelBuilder,
        change::{Between, CityChange},
        join::{join_all, read_timetables},
        load::sniff::Format,
        model::CityModel,
        texture,
        warning::WarningCode,
    },
    geom::Aabb,
};

/// The time that loading took, by stage, over all files; `load.ms` of `--stats`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadStats {
    /// Reading and decompressing.
    pub read: Duration,
    /// Parsing.
    pub parse: Duration,
    /// Triangulation, tiles, planes.
    pub build: Duration,
    /// Bytes parsed, after decompression.
    pub bytes: u64,
}

/// Loads files and folders as one city.
pub fn load(paths: &[PathBuf], options: &LoadOptions, progress: &dyn Progress) -> Result<CityModel, LoadError> {
    load_with_stats(paths, options, progress).map(|(model, _)| model)
}

/// [`load`], and how long it took.
pub fn load_with_stats(
    paths: &[PathBuf],
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(CityModel, LoadStats), LoadError> {
    let (builder, mut stats) = load_raw(paths, options, progress)?;
    still_wanted(progress, paths)?;
    progress.enter(Stage::Build, paths.len(), paths.len(), Path::new(""));
    let start = Instant::now();
    let mut model = builder.finish();
    model.shown_materials = options.materials;
    texture::settle(&mut model);
    join_all(&mut model, &options.joins)?;
    read_timetables(&mut model, &options.timetables)?;
    add_changes(&mut model, options, progress)?;
    tell_degrees(&mut model, paths);
    stats.build = start.elapsed();
    Ok((model, stats))
}

/// Adds the attributes that say what became of objects.
fn add_changes(model: &mut CityModel, options: &LoadOptions, progress: &dyn Progress) -> Result<(), LoadError> {
    let (changes, dating) = &options.changes;
    for CityChange { attribute, between } in changes {
        match between {
            Between::Moments(moments) => model.add_change(attribute, *moments, dating).map_err(|message| {
                let file = model.sources.first().map_or(PathBuf::new(), |source| source.path.clone());
                LoadError::new(&file, message)
            })?,
            Between::Files { files, key } => {
                let own = LoadOptions { changes: Default::default(), frames: model.frames, ..options.clone() };
                let before = load(files, &own, progress)?;
                let file = files.first().cloned().unwrap_or_default();
                let gone = model.add_change_since(&file, attribute, &before, key.as_deref())?;
                log::info!("{}: {gone} objects of it are gone", file.display());
            }
        }
    }
    Ok(())
}

/// Warns of a city that is a needle: degrees east and north, metres up, and no reference system that says so.
fn tell_degrees(model: &mut CityModel, paths: &[PathBuf]) {
    let Aabb { min, max } = model.extent();
    let size = max - min;
    let across = size.x.max(size.y);
    let are_degrees = |low: f64, high: f64, most: f64| low >= -most && high <= most;
    let is_needle = across > 0.0 && across < 10.0 && size.z > 1000.0 * across;
    if model.crs.is_none() && is_needle && are_degrees(min.x, max.x, 180.0) && are_degrees(min.y, max.y, 180.0) {
        let file = paths.first().map_or(Path::new(""), PathBuf::as_path).display();
        model.warnings.add(WarningCode::UnknownCrs, "", || {
            format!("{file}: {across:.1e} across and {:.0} high, these coordinates look like degrees; a reference system in the file (EPSG:4979, latitude first, or OGC:CRS84h) makes metres of them", size.z)
        });
    }
}

fn still_wanted(progress: &dyn Progress, paths: &[PathBuf]) -> Result<(), LoadError> {
    match progress.is_cancelled() {
        true => Err(LoadError::new(paths.first().map_or(Path::new(""), PathBuf::as_path), "loading was cancelled")),
        false => Ok(()),
    }
}

/// Everything up to [`ModelBuilder::finish`].
pub fn load_raw(
    paths: &[PathBuf],
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(ModelBuilder, LoadStats), LoadError> {
    let files = expand(paths)?;
    let mut options = options.clone();
    options.roots.extend(files.iter().map(|f| folder_of(&f.path).to_owned()));
    options.roots.extend(std::env::var_os("VEDUTA_DATA").filter(|v| !v.is_empty()).map(PathBuf::from));
    options.roots.sort();
    options.roots.dedup();
    let mut builder = ModelBuilder::default();
    (builder.zone, builder.frame) = (options.frames.zone, options.frames.local);
    let mut stats = LoadStats::default();
    let mut refusals = Vec::new();
    for (i, file) in files.iter().enumerate() {
        still_wanted(progress, paths)?;
        let enter = |stage| progress.enter(stage, i, files.len(), &file.path);
        match read_file(&mut builder, &file.path, &options, &enter, &mut stats) {
            Ok(()) => {}
            Err(error) if file.from_folder => {
                builder.model.warnings.add(WarningCode::Unsupported, "", || format!("{error}; skipped"));
                refusals.push(error.to_string());
            }
            Err(error) => return Err(error),
        }
    }
    if builder.model.sources.is_empty() && !paths.is_empty() {
        let folder = paths.first().map(PathBuf::as_path).unwrap_or(Path::new(""));
        let more = if refusals.len() > 1 { format!("; {} more", refusals.len() - 1) } else { String::new() };
        let why = refusals.first().map(|first| format!(" ({first}{more})")).unwrap_or_default();
        return Err(LoadError::new(folder, format!("no city model that can be read{why}; {}", sniff::READABLE)));
    }
    Ok((builder, stats))
}

/// Reads and parses one file.
fn read_file(
    builder: &mut ModelBuilder,
    path: &Path,
    options: &LoadOptions,
    enter: &dyn Fn(Stage),
    stats: &mut LoadStats,
) -> Result<(), LoadError> {
    enter(Stage::Read);
    let start = Instant::now();
    let input = input::read(path);
    stats.read += start.elapsed();
    let input = input?;
    stats.bytes += input.bytes.len() as u64;
    enter(Stage::Parse);
    let start = Instant::now();
    let result = read_input(builder, input, options);
    stats.parse += start.elapsed();
    result
}

/// Gives bytes to the loader of their format; what a fuzzer calls.
pub fn read_input(builder: &mut ModelBuilder, input: Input, options: &LoadOptions) -> Result<(), LoadError> {
    if input.is_cut {
        builder.model.warnings.add(WarningCode::TruncatedFile, "", || {
            format!("{}: the compressed file ends early; is the download complete?", input.path.display())
        });
    }
    if input.passed_over > 0 {
        builder.model.warnings.add(WarningCode::Malformed, "", || {
            let (file, count) = (input.path.display(), input.passed_over);
            format!("{file}: {count} bytes behind the compressed file are passed over")
        });
    }
    match sniff::format(&input) {
        Format::Known(name) => Err(LoadError::new(&input.path, format!("{name} cannot be read yet"))),
        Format::Not(what) => Err(LoadError::new(&input.path, what)),
        Format::CityJson => crate::city::cityjson::read(builder, input, options),
        Format::Gltf => crate::city::gltf::read(builder, &input, options),
        Format::Obj => crate::city::obj::read(builder, &input, options),
    }
}

/// A file to load, and whether the user named it or its folder.
struct Found {
    path: PathBuf,
    from_folder: bool,
}

/// Files as named; folders as their files that look like city models, by name.
fn expand(paths: &[PathBuf]) -> Result<Vec<Found>, LoadError> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(Found { path: path.clone(), from_folder: false });
            continue;
        }
        let failed = |e: std::io::Error| LoadError::new(path, format!("this folder cannot be listed: {e}"));
        let entries: Result<Vec<_>, _> = std::fs::read_dir(path).map_err(failed)?.collect();
        let mut inside: Vec<PathBuf> = entries.map_err(failed)?.into_iter().map(|e| e.path()).collect();
        inside.retain(|p| p.is_file() && sniff::looks_like_a_city(p));
        inside.sort();
        files.extend(inside.into_iter().map(|path| Found { path, from_folder: true }));
    }
    Ok(files)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_no_name_is_the_current_one_and_no_other() {
        let options = LoadOptions { roots: vec![PathBuf::new()], ..LoadOptions::default() };
        assert!(options.allows(Path::new("Cargo.toml")) && options.allows(Path::new("citydata/cube.city.json")));
        assert!(!options.allows(Path::new("../elsewhere.city.json")) && !options.allows(&std::env::temp_dir()));
        assert!(matches!(options.sibling(Path::new("Cargo.toml"), "../elsewhere.png"), Sibling::Outside(_)));
    }
}
