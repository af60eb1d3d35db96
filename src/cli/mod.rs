//! Commands, options, messages and exit codes (contract.md, "The program").
//!
//! One file per command: a clap struct of its arguments and a `run` that gives `Ok` or one readable [`Failure`].
//! What a command prints goes through [`output`], what it says meanwhile through [`terminal`].

pub mod failure;
pub mod info;
pub mod load;
pub mod output;
pub mod report;
pub mod synth;
pub mod terminal;

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, Parser, Subcommand};

pub use failure::{Failure, Outcome};

/// The command line.
#[derive(Debug, Parser)]
#[command(
    name = "veduta",
    version,
    about = "Looks at 3D city models through information lenses",
    after_help = EXAMPLES,
    disable_help_subcommand = true,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    subcommand_value_name = "COMMAND",
    override_usage = "veduta COMMAND [OPTIONS]\n       veduta [FILE...]"
)]
pub struct Cli {
    /// What to do; nothing means `view`.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// What to view when no command is named.
    #[command(flatten)]
    pub view: ViewArguments,
    /// What holds for every command.
    #[command(flatten)]
    pub global: GlobalArguments,
}

const EXAMPLES: &str = "\
Examples:
  veduta info city.city.json                     what is in a file
  veduta synth --buildings 1000 --seed 7 -o town.city.json

FILE is CityJSON (.json), CityJSONSeq (.jsonl), glTF (.gltf, .glb) or OBJ (.obj), the JSON ones also .gz,
or a folder of them. Several files make one city.
Exit code: 0 done, 1 failed, 2 wrong usage.";

/// Options that every command takes.
#[derive(Args, Clone, Debug, Default)]
pub struct GlobalArguments {
    /// Say more on stderr; twice: even more
    #[arg(short, long, global = true, action = clap::ArgAction::Count, conflicts_with = "quiet", display_order = 100)]
    pub verbose: u8,
    /// Say nothing on stderr but errors
    #[arg(short, long, global = true, display_order = 100)]
    pub quiet: bool,
    /// Follow paths in models and scenes that leave the folders named on the command line
    #[arg(long, global = true, display_order = 100)]
    pub allow_outside: bool,
}

/// The commands of this version.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Opens a window on city files or a scene
    View(ViewArguments),
    /// Says what is in city files
    Info(info::Arguments),
    /// Makes a synthetic city
    Synth(synth::Arguments),
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
            let code = u8::from(error.use_stderr()) * 2;
            return match error.print() {
                Ok(()) => ExitCode::from(code),
                Err(_) => ExitCode::from(code),
            };
        }
    };
    terminal::start_log(&cli.global);
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(cli: Cli) -> Outcome {
    let global = &cli.global;
    match cli.command {
        Some(Command::View(arguments)) => view(&arguments),
        Some(Command::Info(arguments)) => info::run(&arguments, global),
        Some(Command::Synth(arguments)) => synth::run(&arguments, global),
        None => no_command(&cli.view),
    }
}

fn view(arguments: &ViewArguments) -> Outcome {
    let file = match (&arguments.scene, arguments.files.first()) {
        (Some(file), _) | (None, Some(file)) => file.display().to_string(),
        _ => "FILE".to_owned(),
    };
    Err(Failure::failed(format!(
        "view: this version ({}) has no window yet; `veduta render {file} -o picture.png` makes a picture",
        env!("CARGO_PKG_VERSION")
    )))
}

/// `veduta WORD...`: files to view, or a command that is spelt wrong or that this version lacks.
fn no_command(arguments: &ViewArguments) -> Outcome {
    use clap::CommandFactory;
    let Some(word) = arguments.files.first() else { return view(arguments) };
    if word.exists() || word.extension().is_some() || word.as_os_str() == "-" {
        return view(arguments);
    }
    let word = word.display().to_string();
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let near = names
        .iter()
        .map(|name| (strsim::osa_distance(name, &word), *name))
        .min()
        .filter(|(distance, name)| *distance <= 2 && *distance < name.len());
    let hint = match near {
        Some((_, name)) => format!("did you mean `veduta {name}`?"),
        None => format!("the commands are {}", names.join(", ")),
    };
    Err(Failure::usage(format!(
        "{word}: no such file, and no command of version {}; {hint}",
        env!("CARGO_PKG_VERSION")
    )))
}
