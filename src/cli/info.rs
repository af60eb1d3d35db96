//! `veduta info`: the first thing one runs on an unknown file.

mod place;
mod sights;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::{
    city::{
        CityModel,
        facts::{self, Facts},
        shown::shown_geometries,
        spatial::SpatialIndex,
    },
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        load, output, report,
        terminal::Paint,
    },
    lens::nearest::did_you_mean,
    view::Field,
    visibility,
};

pub use place::{Place, PlaceFacts};
pub use sights::{LandmarkFacts, ViewFacts};

const EXAMPLES: &str = "\
Examples:
  veduta info city.city.json                    a summary to read
  veduta info --list tiles/*.city.jsonl         several files as one city, every object by name
  veduta info --landmarks 10 city.city.json     what stands out in it
  veduta info --landmarks 5 --scene sights.toml city.city.json
                                                the same as a scene: each in an overlay, tied to its place
  veduta info --best-views church city.city.json
                                                from where one object is seen best, as cameras for scenes
  veduta info --at 85010.5,447320 city.city.json
                                                the height of ground and roof at a place, and whose it is
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
    /// List the views from which this object (with its parts) is seen best, best first
    #[arg(long, value_name = "ID")]
    pub best_views: Option<String>,
    /// With --landmarks: also write a scene in which each of them has a best-view lens
    #[arg(long, value_name = "FILE.toml", requires = "landmarks")]
    pub scene: Option<PathBuf>,
    /// Say what is at a place in plan: the height of the ground, what stands highest there, and how high above the ground
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub at: Option<Place>,
    /// List the N objects that stand out most: by height, footprint, isolation and what their attributes say
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub landmarks: Option<u32>,
}

/// The answer: facts, and what was asked for beside them.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// The facts about the city.
    #[serde(flatten)]
    pub facts: Facts,
    /// What is at the place asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<PlaceFacts>,
    /// The best views of the object asked for, best first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_views: Option<Vec<ViewFacts>>,
    /// The landmarks, those that stand out most first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub landmarks: Option<Vec<LandmarkFacts>>,
}

/// Loads the files and says what is in them.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let (city, _) = load::load(&arguments.files, global)?;
    let best_views = arguments.best_views.as_ref().map(|id| best_views(&city, id)).transpose()?;
    let landmarks = arguments.landmarks.map(|n| landmarks(&city, n));
    let at = arguments.at.map(|Place(at)| PlaceFacts::new(&city, at));
    if let Some(file) = &arguments.scene {
        output::check([file], arguments.files.iter().chain(&city.files_beside()))?;
        let text = sights::scene(&arguments.files, landmarks.iter().flatten(), file);
        output::write(file, |out| out.write_all(text.as_bytes()))?;
    }
    let answer = Answer { facts: facts::facts(&city, arguments.list), at, best_views, landmarks };
    if arguments.json {
        return output::print(&(serde_json::to_string_pretty(&answer).map_err(Failure::failed)? + "\n"));
    }
    output::print(&report::text(&answer, &city.sources, Paint::for_stdout()))
}

fn best_views(city: &CityModel, id: &str) -> Outcome<Vec<ViewFacts>> {
    let object = city.find_object(id).ok_or_else(|| {
        let hint = did_you_mean(id, city.objects.iter().map(|object| &*object.id));
        Failure::failed(format!("--best-views: the city has no object \"{id}\"{hint}"))
    })?;
    let shown = shown_geometries(city, None);
    let index = SpatialIndex::build(city, &shown);
    let views = visibility::best_views(city, &shown, &index, object, &Field::default());
    let views = views.map_err(|e| Failure::failed(format!("--best-views: {e}")))?;
    Ok(views.iter().map(ViewFacts::new).collect())
}

fn landmarks(city: &CityModel, n: u32) -> Vec<LandmarkFacts> {
    let found = visibility::landmarks(city, &shown_geometries(city, None), n as usize);
    found.into_iter().map(|landmark| LandmarkFacts::new(city, landmark)).collect()
}
