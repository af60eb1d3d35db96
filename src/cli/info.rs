//! `veduta info`: the first thing one runs on an unknown file.

mod compare;
mod place;
mod sights;
mod volume;

use std::{path::PathBuf, str::FromStr};

use clap::Args;
use serde::Serialize;

use crate::{
    city::{
        CityModel,
        crs::Frames,
        facts::{self, Facts, TimeFacts},
        shown::shown_geometries,
        side_table::Join,
        spatial::SpatialIndex,
    },
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        load, output,
        render::{self, arguments::scene_among},
        report,
        terminal::Paint,
    },
    lens::{
        chosen::{Choice, members, unknown_names},
        nearest::did_you_mean,
    },
    query,
    scene::CitySpec,
    view::Field,
    visibility,
};

pub use compare::{CompareFacts, ListedChange, StateFacts};
pub use place::{Place, PlaceFacts};
pub use sights::{LandmarkFacts, ViewFacts};
pub use volume::{FieldFacts, VolumeFacts};

const EXAMPLES: &str = "\
Examples:
  veduta info city.city.json                    a summary to read
  veduta info --list tiles/*.city.jsonl         several files as one city, every object by name
  veduta info --where 'height > 25 and not function = church' city.city.json
                                                the objects of which that is true
  veduta info --landmarks 10 city.city.json     what stands out in it
  veduta info --landmarks 5 --scene sights.toml city.city.json
                                                the same as a scene: each in an overlay, tied to its place
  veduta info --best-views church city.city.json
                                                from where one object is seen best, as cameras for scenes
  veduta info --at 85010.5,447320 city.city.json
                                                the height of ground and roof at a place, and whose it is
  veduta info --join register.csv,pand city.city.json
                                                with the attributes of a side table, and what was joined
  veduta info --compare 2019.city.json 2024.city.json --list
                                                what was added, removed and changed between two states
  veduta info --compare --key identificatie old.city.jsonl new.city.jsonl
                                                the same where ids were given anew: matched by an attribute
  veduta info --json city.glb | jq .objects.total
  veduta info wind.nrrd                         what is in a volume: arrays, ranges, its grid
  zcat city.json.gz | veduta info -             from a pipe

The keys of --json are documented in docs/info.md, warning codes in docs/warnings.md.";

/// Arguments of `veduta info`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// City files or folders of them, `-` for stdin; several make one city. Or a scene (.toml), whose city is meant, with its side tables. Or volumes
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Compare two states of a city, the earlier FILE first, the later second: what was added, removed and changed
    #[arg(long, conflicts_with_all = ["from", "until", "best_views", "scene", "at", "landmarks"])]
    pub compare: bool,
    /// With --compare: match objects by this attribute, not by their ids
    #[arg(long, value_name = "ATTRIBUTE", requires = "compare")]
    pub key: Option<String>,
    /// Join a side table, CSV or GeoJSON, by its column KEY (else the first, or `id`) and the objects' ids, or their ATTRIBUTE
    #[arg(long, value_name = "FILE[,KEY[,ATTRIBUTE]]")]
    pub join: Vec<SideTable>,
    /// The attribute that says since when an object is there
    #[arg(long, value_name = "ATTRIBUTE")]
    pub from: Option<String>,
    /// The attribute that says until when, not included
    #[arg(long, value_name = "ATTRIBUTE")]
    pub until: Option<String>,
    /// Write one JSON object instead of text
    #[arg(long)]
    pub json: bool,
    /// Name every object, with type, parents, levels of detail, and where it is; with --compare each that is not the same, and why
    #[arg(long)]
    pub list: bool,
    /// Name the objects of which this is true, and their parts: "height > 25 and yearOfConstruction < 1900" (docs/scene.md, Expressions)
    #[arg(long = "where", value_name = "EXPRESSION", conflicts_with = "compare")]
    pub expression: Option<String>,
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

/// A side table as the command line names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SideTable(pub Join);

impl FromStr for SideTable {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').collect();
        let (file, key, attribute) = match parts[..] {
            [file] => (file, "", None),
            [file, key] => (file, key, None),
            [file, key, attribute] => (file, key, Some(attribute.to_owned()).filter(|name| !name.is_empty())),
            _ => return Err("FILE, FILE,KEY or FILE,KEY,ATTRIBUTE would be right".to_owned()),
        };
        match file.is_empty() {
            true => Err("FILE is missing".to_owned()),
            false => Ok(Self(Join { file: file.into(), key: key.to_owned(), attribute, ..Join::default() })),
        }
    }
}

/// The city that is meant: that of a scene, or files.
fn spec(files: &[PathBuf], arguments: &Arguments, global: &GlobalArguments) -> Outcome<CitySpec> {
    let scene = scene_among(files);
    if scene.is_some() && files.len() > 1 {
        return Err(Failure::usage(
            "info: one scene (.toml) or any number of city files; a scene names its files itself",
        ));
    }
    let (scene, _) = render::scene_of(files, &[], &render::options_of(scene, global))?;
    let mut spec = scene.city;
    spec.joins.extend(arguments.join.iter().map(|table| table.0.clone()));
    spec.dating.from = arguments.from.clone().or(spec.dating.from);
    spec.dating.until = arguments.until.clone().or(spec.dating.until);
    Ok(spec)
}

/// Loads the files and says what is in them.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    if arguments.compare {
        return compare::run(arguments, global);
    }
    if volume::are_volumes(&arguments.files) {
        return volume::run(&arguments.files, arguments.json);
    }
    let spec = spec(&arguments.files, arguments, global)?;
    let (city, _) = load::load_city(&spec, Frames::default(), global)?;
    let best_views = arguments.best_views.as_ref().map(|id| best_views(&city, id)).transpose()?;
    let landmarks = arguments.landmarks.map(|n| landmarks(&city, n));
    let at = arguments.at.map(|Place(at)| PlaceFacts::new(&city, at));
    if let Some(file) = &arguments.scene {
        output::check([file], arguments.files.iter().chain(&city.files_beside()))?;
        let text = sights::scene(&spec.files, landmarks.iter().flatten(), file);
        output::write(file, |out| out.write_all(text.as_bytes()))?;
    }
    let meant = arguments.expression.as_deref().map(|text| meant(&city, text)).transpose()?;
    let mut facts = facts::facts(&city, arguments.list || meant.is_some());
    if let (Some(list), Some(meant)) = (&mut facts.objects.list, meant) {
        let mut each = meant.into_iter();
        list.retain(|_| each.next().unwrap_or(false));
    }
    facts.time = TimeFacts::new(&city, &spec.dating).map_err(|message| {
        Failure::failed(message.replacen(
            "city.",
            if scene_among(&arguments.files).is_some() { "city." } else { "--" },
            1,
        ))
    })?;
    let answer = Answer { facts, at, best_views, landmarks };
    if arguments.json {
        return output::print(&(serde_json::to_string_pretty(&answer).map_err(Failure::failed)? + "\n"));
    }
    output::print(&report::text(&answer, &city.sources, Paint::for_stdout()))
}

/// One per object of a city, whether an expression means it.
fn meant(city: &CityModel, text: &str) -> Outcome<Vec<bool>> {
    let expression = query::parse(text).map_err(|error| Failure::usage(format!("--where: {error}")))?;
    if let Some(message) = unknown_names(city, &expression).into_iter().next() {
        return Err(Failure::failed(format!("--where: {message}")));
    }
    Ok(members(city, &Choice { expression: Some(text.to_owned()), ..Choice::default() }))
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
