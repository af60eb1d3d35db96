//! Commands, options, messages and exit codes.
//!
//! One file per command: a clap struct of its arguments and a `run` that gives `Ok` or one readable [`Failure`].
//! Output of a command goes through [`output`], messages meanwhile go through [`terminal`].

pub mod animate;
pub mod arguments;
pub mod effects;
pub mod failure;
mod film;
pub mod gallery;
pub mod info;
pub mod load;
pub mod measure;
mod memory;
pub mod output;
pub mod quality;
pub mod render;
pub mod report;
pub mod shader;
pub mod sheet;
mod synth;
pub mod terminal;

use std::{ffi::OsString, path::PathBuf, process::ExitCode};

use clap::{Args, CommandFactory, Parser, Subcommand};

pub use arguments::GlobalArguments;
pub use failure::{Failure, Outcome};

use crate::{app, city::builtin, figure::file::remove_parts};

/// The command line.
#[derive(Debug, Parser)]
#[command(
    name = "veduta",
    version,
    about = "Looks at 3D city models through information lenses",
    after_help = EXAMPLES,
    disable_help_subcommand = true,
    allow_external_subcommands = true,
    override_usage = "veduta COMMAND [OPTIONS]\n       veduta [FILE...] [--scene S.toml]"
)]
pub struct Cli {
    /// The command; none means `view`.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// A scene to view, when no command is named
    #[arg(long, value_name = "S.toml", hide = true)]
    pub scene: Option<PathBuf>,
    /// Arguments of every command.
    #[command(flatten)]
    pub global: GlobalArguments,
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

const EXAMPLES: &str = "\
Examples:
  veduta info city.city.json                     what is in a file
  veduta render city.city.json -o city.png       a picture of it
  veduta render scene.toml -o figure.png --set lens.0.shape.radius=80
  veduta synth --buildings 1000 --seed 7 -o town.city.json

FILE is CityJSON (.json), CityJSONSeq (.jsonl), glTF (.gltf, .glb) or OBJ (.obj), the JSON ones also .gz,
or a folder of them. Several files make one city.
Exit code: 0 done, 1 failed, 2 wrong usage.";

/// The commands of this version.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Opens a window on city files or a scene
    View(ViewArguments),
    /// Draws one picture of a scene or of city files
    Render(render::arguments::Arguments),
    /// Draws a scene's variations side by side
    Sheet(sheet::Arguments),
    /// Draws the frames of a scene along its paths
    Animate(animate::Arguments),
    /// Says what is in city files
    Info(info::Arguments),
    /// Makes a synthetic city
    Synth(synth::Arguments),
    /// Draws every figure of the docs
    Gallery(gallery::Arguments),
    /// Measures what accuracy costs in time
    Measure(measure::Arguments),
    /// Lists what lenses can do to what they show
    Effects(effects::Arguments),
    /// Prints the WGSL that a scene is shaded with
    Shader(shader::Arguments),
    /// Files to view, or a word that is no command.
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

/// `veduta view`.
#[derive(Args, Clone, Debug, Default)]
pub struct ViewArguments {
    /// City files
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Scene file
    #[arg(long, value_name = "S.toml")]
    pub scene: Option<PathBuf>,
}

/// Runs the program on the process' arguments: 0 done, 1 failed, 2 wrong usage.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors, and a closed pipe is none either.
            let _ = error.print();
            return ExitCode::from(u8::from(error.use_stderr()) * 2);
        }
    };
    terminal::start_log(&cli.global);
    terminal::tell_faults_in_a_line();
    ends_cleanly();
    // A window has work in it that nobody saved: there loading and drawing are bounded, and nothing else.
    if !matches!(cli.command, None | Some(Command::View(_) | Command::Other(_))) || cli.global.memory.is_some() {
        memory::watch(cli.global.memory);
    }
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Has half-written files removed where the program is asked to end.
#[cfg(unix)]
fn ends_cleanly() {
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator::Signals,
        low_level::emulate_default_handler,
    };
    let Ok(mut signals) = Signals::new([SIGHUP, SIGINT, SIGTERM]) else { return };
    let wait = move || {
        for signal in &mut signals {
            remove_parts();
            let _ = emulate_default_handler(signal);
        }
    };
    // Without the thread signals end the program as they do.
    if let Err(error) = std::thread::Builder::new().name("signals".into()).spawn(wait) {
        log::debug!("no thread waits for signals: {error}");
    }
}

#[cfg(not(unix))]
fn ends_cleanly() {}

fn run(cli: Cli) -> Outcome {
    let global = &cli.global;
    effects::add_folders(&global.effects, global)?;
    match cli.command {
        Some(Command::View(arguments)) => view(&arguments, global),
        Some(Command::Render(arguments)) => render::run(&arguments, global),
        Some(Command::Sheet(arguments)) => sheet::run(&arguments, global),
        Some(Command::Animate(arguments)) => animate::run(&arguments, global),
        Some(Command::Gallery(arguments)) => gallery::run(&arguments, global),
        Some(Command::Info(arguments)) => info::run(&arguments, global),
        Some(Command::Synth(arguments)) => synth::run(&arguments, global),
        Some(Command::Measure(arguments)) => measure::run(&arguments, global),
        Some(Command::Effects(arguments)) => effects::run(&arguments, global),
        Some(Command::Shader(arguments)) => shader::run(&arguments, global),
        Some(Command::Other(words)) => other(&words, global),
        None => view(&ViewArguments { files: Vec::new(), scene: cli.scene.clone() }, global),
    }
}

fn view(arguments: &ViewArguments, global: &GlobalArguments) -> Outcome {
    let files: Vec<PathBuf> = arguments.scene.iter().chain(&arguments.files).cloned().collect();
    let is_scene = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if files.iter().any(|path| is_scene(&path)) && files.len() > 1 {
        return Err(Failure::usage(
            "view: one scene (.toml) or any number of city files; a scene names its files itself",
        ));
    }
    for file in &files {
        let is_builtin = file.to_string_lossy().starts_with(builtin::PREFIX);
        match is_builtin {
            true => builtin::check(&file.to_string_lossy()).map_err(Failure::failed)?,
            false if !file.exists() => {
                return Err(Failure::failed(format!("{}: there is no such file", file.display())));
            }
            false => {}
        }
    }
    if !app::has_display() {
        let file = files.first().map_or_else(|| app::BUILTIN.to_owned(), |file| file.display().to_string());
        return Err(Failure::failed(format!(
            "view: there is no display to open a window on; `veduta render {file} -o picture.png` makes a picture without one"
        )));
    }
    let memory = app::Start::user_memory();
    let effects = global.effects.clone();
    app::run(app::Start { files, allow_outside: global.allow_outside, memory, effects }).map_err(Failure::failed)
}

/// `veduta WORD...`: files to view, or a command that is spelt wrong or that this version lacks.
fn other(words: &[OsString], global: &GlobalArguments) -> Outcome {
    let Some(first) = words.first().map(PathBuf::from) else { return view(&ViewArguments::default(), global) };
    let is_builtin = first.to_string_lossy().starts_with(builtin::PREFIX);
    if is_builtin || first.exists() || first.extension().is_some() || first.as_os_str() == "-" {
        let files = words.iter().map(PathBuf::from).collect();
        return view(&ViewArguments { files, scene: None }, global);
    }
    let word = first.display().to_string();
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let near = names.iter().map(|name| (strsim::osa_distance(name, &word), *name)).min();
    let hint = match near.filter(|(distance, _)| *distance <= 2) {
        Some((_, name)) => format!("did you mean `veduta {name}`?"),
        None => format!("the commands are {}", names.join(", ")),
    };
    Err(Failure::usage(format!("{word}: no such file, and no command of version {VERSION}; {hint}")))
}
