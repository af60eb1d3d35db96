//! `veduta gallery`: every figure of the docs, from the scenes that ship with the program.

use std::path::PathBuf;

use clap::Args;

use crate::{
    cli::{Failure, GlobalArguments, Outcome, output, render, terminal},
    figure::{
        self, picture,
        scene_file::{self, Options},
    },
    render::picture::{Request, Studio},
    scene::CitySpec,
};

const EXAMPLES: &str = "\
Examples:
  veduta gallery -o out
  veduta gallery -o out first-lens              only this one
  VEDUTA_DATA=/data veduta gallery -o out       also scenes of shared data sets";

/// Name and text of scenes below `scenes/`.
macro_rules! scenes {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("../../scenes/", $name, ".toml")))),*] };
}

/// The scenes that ship with the program, by name; a test holds the list against the folder.
pub const SCENES: &[(&str, &str)] = scenes! {
    "delft-age"
    "delft-detail"
    "delft-route"
    "delft-streets"
    "den-haag-district"
    "den-haag-sphere"
    "first-lens"
    "houses-on-the-way"
    "in-the-way"
    "market-square"
    "out-of-sight"
    "planned-quarter"
    "ropinski-1"
    "ropinski-3"
    "ropinski-5"
    "ropinski-6"
    "ropinski-7"
    "ropinski-8"
    "rotterdam-textures"
    "sections"
    "see-inside"
    "shown-as"
    "three-lenses"
    "tiesel-3-12-a"
    "tiesel-3-12-b"
    "tiesel-3-22"
    "tiesel-3-7"
    "tiesel-3-9"
    "town"
    "trapp-3-1-3"
    "trapp-3-2-3-a"
    "trapp-3-2-3-b"
    "trapp-3-2-3-c"
    "trapp-3-5-1"
    "trapp-3-5-2-a"
    "trapp-3-5-2-b"
    "trapp-3-5-2-c"
    "trapp-3-5-3-a"
    "trapp-3-5-3-b"
    "trapp-3-5-3-c"
    "vienna-roofs"
    "vienna-shapes"
    "window"
};

/// Arguments of `veduta gallery`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Only these scenes
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// The folder to write to; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Draws the scenes, one picture each.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    for name in &arguments.names {
        if !SCENES.iter().any(|(known, _)| known == name) {
            let known: Vec<&str> = SCENES.iter().map(|(known, _)| *known).collect();
            return Err(Failure::usage(format!("gallery: no scene {name}; there are {}", known.join(", "))));
        }
    }
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    let is_asked = |name: &str| arguments.names.is_empty() || arguments.names.iter().any(|asked| asked == name);
    let mut scenes = Vec::new();
    for (name, text) in SCENES.iter().filter(|(name, _)| is_asked(name)) {
        let options = Options::for_file(&PathBuf::from("scenes").join(name));
        match scene_file::parse(text, &format!("scenes/{name}.toml"), &options) {
            Ok(scene) => scenes.push((name, scene, options)),
            Err(error) if error.is_data_absent => {
                output::print(&format!("{name}: skipped: data absent (VEDUTA_DATA is not set)\n"))?;
            }
            Err(error) => return Err(Failure::failed(error)),
        }
    }
    // Scenes of one city follow each other: it is loaded once.
    scenes.sort_by(|(_, a, _), (_, b, _)| a.city.files.cmp(&b.city.files));
    let mut last: Option<(CitySpec, Studio)> = None;
    for (name, scene, options) in scenes {
        let mut studio = match last.take() {
            Some((city, studio)) if city == scene.city => studio,
            _ => render::open(&scene, &options, global)?.0,
        };
        let request = Request {
            size: scene.figure.size,
            samples: scene.figure.samples,
            transparent: false,
            aovs: Default::default(),
            statistics: false,
            backend: Default::default(),
        };
        let progress = terminal::Progress::spinning(&format!("drawing {name}"), global);
        let drawn =
            figure::draw(&mut studio, &scene, &request).map_err(|error| Failure::failed(format!("{name}: {error}")))?;
        drop(progress);
        let file = folder.join(format!("{name}.png"));
        picture::save_picture(&file, drawn.size, &drawn.rgba, true, &render::notes(&scene, &options))
            .map_err(output::unwritten)?;
        output::print(&format!("{}\n", file.display()))?;
        last = Some((scene.city, studio));
    }
    Ok(())
}
