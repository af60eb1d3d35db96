//! What is drawn: one run of the program each.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

use toml::{Table, Value};

/// Size and samples of what is drawn beside a scene's own picture.
const SMALL: [&str; 4] = ["--size", "480x270", "--samples", "1"];
/// AOVs, and the files they go to; masks as EXR hold any number of lenses.
const AOVS: [&str; 6] = [
    "depth=depth.exr",
    "depth=depth.png",
    "object-id=id.png",
    "normal=normal.exr",
    "normal=normal.png",
    "lens-mask=mask.exr",
];

/// One run.
#[derive(Debug)]
pub struct Job {
    /// What it is called; the folder it writes to.
    pub name: String,
    /// The name of its scene, sheet or animation.
    pub scene: String,
    /// Whether it reads the folder of data.
    pub needs_data: bool,
    command: &'static str,
    file: PathBuf,
    /// Further arguments, and with them the names of files in the folder that is written to: `(option, name)`.
    options: Vec<String>,
    outputs: Vec<(&'static str, String)>,
}

impl Job {
    /// Whether this name, of a scene or of the run itself, means it.
    pub fn is_of(&self, name: &str) -> bool {
        self.scene == name || self.name == name
    }

    /// The arguments of the program when it writes to `folder`.
    pub fn arguments(&self, folder: &Path) -> Vec<OsString> {
        let mut arguments = vec![OsString::from(self.command), self.file.clone().into()];
        arguments.extend(self.options.iter().map(OsString::from));
        for (option, name) in &self.outputs {
            arguments.push(option.into());
            arguments.push(match name.split_once('=') {
                // KIND=FILE
                Some((kind, file)) => format!("{kind}={}", folder.join(file).display()).into(),
                None => folder.join(name).into(),
            });
        }
        arguments
    }

    fn of(command: &'static str, name: String, scene: &str, file: &Path) -> Self {
        let (scene, file) = (scene.to_owned(), file.to_owned());
        Self { name, scene, needs_data: false, command, file, options: Vec::new(), outputs: Vec::new() }
    }

    fn with_options<S: Into<String>>(mut self, options: impl IntoIterator<Item = S>) -> Self {
        self.options.extend(options.into_iter().map(Into::into));
        self
    }

    fn with_outputs<S: Into<String>>(mut self, option: &'static str, names: impl IntoIterator<Item = S>) -> Self {
        self.outputs.extend(names.into_iter().map(|name| (option, name.into())));
        self
    }
}

/// All runs: of the scenes and sheets in one folder, and of the animations in another; by name.
pub fn of_folders(scenes: &Path, animations: &Path) -> Result<Vec<Job>, String> {
    let mut jobs = Vec::new();
    for (name, file) in toml_files(scenes)? {
        let text = read(&file)?;
        let of_file = match name.strip_suffix(".sheet") {
            Some(sheet) => of_sheet(sheet, &file, &text)?,
            None => of_scene(&name, &file, &text)?,
        };
        jobs.extend(with_data(of_file, text.contains("VEDUTA_DATA")));
    }
    for (name, file) in toml_files(animations)? {
        let text = read(&file)?;
        let job = Job::of("animate", name.clone(), &name, &file)
            .with_options(SMALL)
            .with_outputs("-o", ["frames"])
            .with_outputs("--stats", ["frames.jsonl"]);
        jobs.extend(with_data(vec![job], text.contains("VEDUTA_DATA")));
    }
    Ok(jobs)
}

fn with_data(mut jobs: Vec<Job>, needs_data: bool) -> Vec<Job> {
    jobs.iter_mut().for_each(|job| job.needs_data |= needs_data);
    jobs
}

fn read(file: &Path) -> Result<String, String> {
    std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))
}

/// Names without `.toml` and paths, sorted.
fn toml_files(folder: &Path) -> Result<Vec<(String, PathBuf)>, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        files.extend(name.strip_suffix(".toml").map(|name| (name.to_owned(), path.clone())));
    }
    files.sort();
    Ok(files)
}

fn parsed(file: &Path, text: &str) -> Result<Table, String> {
    text.parse::<Table>().map_err(|error| format!("{}: {error}", file.display()))
}

/// The picture of a scene as it is asked for, by the other back end, transparent, and the sprites of lenses that are tested by one.
fn of_scene(name: &str, file: &Path, text: &str) -> Result<Vec<Job>, String> {
    let table = parsed(file, text)?;
    let drawn = |kind: &str| {
        Job::of("render", format!("{name}{kind}"), name, file)
            .with_outputs("-o", ["picture.png"])
            .with_outputs("--stats", ["statistics.json"])
            .with_outputs("--aov", AOVS)
    };
    let mut jobs = vec![
        drawn(""),
        drawn(".uber").with_options(SMALL).with_options(["--shaders", "uber"]),
        drawn(".transparent").with_options(SMALL).with_options(["--transparent"]),
    ];
    let none = Vec::new();
    let lenses = table.get("lens").and_then(Value::as_array).unwrap_or(&none);
    for (i, _) in lenses.iter().enumerate().filter(|(_, lens)| lens.get("sprite").is_some()) {
        jobs.push(
            Job::of("render", format!("{name}.sprite-{i}"), name, file)
                .with_options(SMALL)
                .with_outputs("-o", ["picture.png"])
                .with_outputs("--sprite", [format!("{i}=sprite.exr")]),
        );
    }
    Ok(jobs)
}

/// A sheet with its cells and figures, and each cell by itself with AOVs.
fn of_sheet(name: &str, file: &Path, text: &str) -> Result<Vec<Job>, String> {
    let table = parsed(file, text)?;
    let mut jobs = vec![
        Job::of("sheet", format!("{name}.sheet"), name, file)
            .with_outputs("-o", ["sheet.png"])
            .with_outputs("--cells", ["cells"])
            .with_outputs("--figures", ["figures.json"]),
    ];
    let scene = table.get("scene").and_then(Value::as_str).ok_or_else(|| format!("{}: no scene", file.display()))?;
    let scene = file.with_file_name(scene);
    let needs_data = read(&scene)?.contains("VEDUTA_DATA");
    let settings = |table: &Table| -> Vec<String> {
        let list = table.get("set").and_then(Value::as_array).into_iter().flatten();
        list.filter_map(|setting| setting.as_str().map(str::to_owned)).collect()
    };
    let lists = ["row", "column"].map(|axis| -> Vec<Vec<String>> {
        let list = table.get(axis).and_then(Value::as_array).into_iter().flatten();
        let all: Vec<_> = list.filter_map(Value::as_table).map(&settings).collect();
        if all.is_empty() { vec![Vec::new()] } else { all }
    });
    for (row, of_row) in lists[0].iter().enumerate() {
        for (column, of_column) in lists[1].iter().enumerate() {
            let settings = [settings(&table), of_row.clone(), of_column.clone()].concat();
            let options = settings.into_iter().flat_map(|setting| ["--set".to_owned(), setting]);
            jobs.push(
                Job::of("render", format!("{name}.cell-{row}-{column}"), name, &scene)
                    .with_options(SMALL)
                    .with_options(options)
                    .with_outputs("-o", ["picture.png"])
                    .with_outputs("--stats", ["statistics.json"])
                    .with_outputs("--aov", AOVS),
            );
        }
    }
    Ok(with_data(jobs, needs_data))
}
