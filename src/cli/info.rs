//! `veduta info`: the first thing one runs on an unknown file.

use std::path::PathBuf;

use clap::Args;

use crate::{
    city::facts,
    cli::{GlobalArguments, Outcome, load, output, report, terminal::Paint},
};

const EXAMPLES: &str = "\
Examples:
  veduta info city.city.json                    a summary to read
  veduta info --list tiles/*.city.jsonl         several files as one city, every object by name
  veduta info --json city.glb | jq .objects.total
  zcat city.json.gz | veduta info -             from a pipe

The keys of --json are documented in docs/info.md, warning codes in docs/warnings.md.";

/// Arguments of `veduta info`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// City files or folders of them, `-` for stdin; several make one city
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Write one JSON object instead of text
    #[arg(long)]
    pub json: bool,
    /// Name every object, with type, parents, levels of detail, and where it is
    #[arg(long)]
    pub list: bool,
}

/// Loads the files and says what is in them.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let (city, _) = load::load(&arguments.files, global)?;
    let facts = facts::facts(&city, arguments.list);
    if arguments.json {
        return output::write(std::path::Path::new("-"), |out| {
            serde_json::to_writer_pretty(&mut *out, &facts)?;
            writeln!(out)
        });
    }
    output::print(&report::text(&facts, &city.sources, Paint::for_stdout()))
}
