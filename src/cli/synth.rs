//! `veduta synth`: the synthetic city generator.

use std::{io::Write, path::PathBuf};

use clap::{Args, ValueEnum};
use flate2::{Compression, write::GzEncoder};

use crate::{
    city::synth::{self, SynthOptions},
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        terminal::Progress,
    },
};

const EXAMPLES: &str = "\
Examples:
  veduta synth --buildings 1000 --seed 7 -o town.city.json
  veduta synth --buildings 100000 --seed 1 -o city.city.jsonl.gz
  veduta synth --buildings 50 --seed 2 -o - | veduta info -
  veduta synth --detail full --buildings 2000 --seed 4 --timetable day.csv -o town.city.json

The ending of FILE chooses the format: .json is CityJSON 2.0, .jsonl CityJSONSeq, each also .gz;
`-` writes CityJSON to stdout. The same numbers give the same bytes on every machine.";

/// Arguments of `veduta synth`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// How many buildings
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=SynthOptions::MAX_BUILDINGS))]
    pub buildings: u64,
    /// Which of all such cities, any whole number
    #[arg(long, value_name = "S")]
    pub seed: u64,
    /// How much each building has
    #[arg(long, value_enum, default_value = "plain")]
    pub detail: Detail,
    /// Also write where trams and boats are through a day, as CSV (with --detail full)
    #[arg(long, value_name = "FILE")]
    pub timetable: Option<PathBuf>,
    /// The file to write, `-` for stdout
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// The detail of each building.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Detail {
    /// LoD2 shells, three attributes, streets
    Plain,
    /// Terrain, a river, streets, houses in two or three levels of detail with 600 years of history, rooms, trees
    Full,
}

/// Writes the city.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let is_full = arguments.detail == Detail::Full;
    check(arguments)?;
    let options = SynthOptions { buildings: arguments.buildings, seed: arguments.seed };
    let name = arguments.output.to_string_lossy().to_lowercase();
    let (plain_name, is_compressed) = match name.strip_suffix(".gz") {
        Some(inner) => (inner, true),
        None => (&*name, false),
    };
    let is_sequence = plain_name.ends_with(".jsonl");
    if !is_sequence && !plain_name.ends_with(".json") && plain_name != "-" {
        return Err(Failure::usage(format!(
            "{}: this ending names no format that synth writes; .json, .jsonl, .json.gz or .jsonl.gz would be right",
            arguments.output.display()
        )));
    }
    let progress = Progress::counting(options.buildings, "building", "buildings", global);
    let city = |out: &mut dyn Write| {
        let mut at = |done| progress.at(done);
        match (is_full, is_sequence) {
            (false, false) => synth::write_cityjson(&options, out, &mut at),
            (false, true) => synth::write_cityjsonseq(&options, out, &mut at),
            (true, false) => synth::full::write_cityjson(&options, out, &mut at),
            (true, true) => synth::full::write_cityjsonseq(&options, out, &mut at),
        }
    };
    if let Some(file) = &arguments.timetable {
        output::write(file, |out| synth::full::write_timetable(&options, out))?;
    }
    output::write(&arguments.output, |out| {
        if !is_compressed {
            return city(out);
        }
        // Small writes are gathered before they are compressed.
        let mut gathered = std::io::BufWriter::with_capacity(1 << 16, GzEncoder::new(out, Compression::default()));
        city(&mut gathered)?;
        gathered.into_inner().map_err(std::io::IntoInnerError::into_error)?.finish().map(drop)
    })
}

/// What a full city cannot be.
fn check(arguments: &Arguments) -> Result<(), Failure> {
    let is_full = arguments.detail == Detail::Full;
    let range = synth::full::BUILDINGS;
    if is_full && !range.contains(&arguments.buildings) {
        let (least, most, asked) = (range.start(), range.end(), arguments.buildings);
        return Err(Failure::usage(format!(
            "--buildings {asked}: a city in full has {least} to {most} buildings; --detail plain has any number"
        )));
    }
    if !is_full && arguments.timetable.is_some() {
        return Err(Failure::usage(
            "--timetable: only a city in full has trams and boats; --detail full would be right",
        ));
    }
    Ok(())
}
