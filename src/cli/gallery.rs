//! `veduta gallery`: every figure of the docs, from the scenes that ship with the program.

use std::path::PathBuf;

use clap::Args;

use crate::{
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        quality::Smoothness,
        render, sheet, terminal,
    },
    figure::{
        self, picture,
        scene_file::{self, Options},
    },
    render::picture::{Request, Studio},
    scene::{CitySpec, Scene},
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
    "bent-city"
    "call-outs"
    "carbon-dioxide"
    "changed"
    "delft-age"
    "delft-detail"
    "delft-heights"
    "delft-route"
    "delft-streets"
    "den-haag-district"
    "den-haag-feature"
    "den-haag-magnified"
    "den-haag-sphere"
    "den-haag-x-ray"
    "first-lens"
    "flattened"
    "houses-on-the-way"
    "in-the-way"
    "lowered"
    "market-square"
    "near-and-far"
    "old-town-in-time"
    "one-house"
    "out-of-sight"
    "panorama"
    "planned-quarter"
    "rooms"
    "ropinski-1"
    "ropinski-3"
    "ropinski-5"
    "ropinski-6"
    "ropinski-7"
    "ropinski-8"
    "rotterdam-textures"
    "sections"
    "see-inside"
    "semantic-zoom"
    "shown-as"
    "sights"
    "sights-of-the-hague"
    "storm"
    "street-in-the-hague"
    "street-in-vienna"
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
    "trapp-3-3-1-a"
    "trapp-3-3-1-b"
    "trapp-3-3-1-c"
    "trapp-3-3-1-d"
    "trapp-3-3-2-a"
    "trapp-3-3-2-b"
    "trapp-3-3-2-c"
    "trapp-3-4-1"
    "trapp-3-4-3-a"
    "trapp-3-4-3-b"
    "trapp-3-5-1"
    "trapp-3-5-2-a"
    "trapp-3-5-2-b"
    "trapp-3-5-2-c"
    "trapp-3-5-3-a"
    "trapp-3-5-3-b"
    "trapp-3-5-3-c"
    "trapp-3-6-3-a"
    "trapp-3-6-3-b"
    "trapp-5-3-1"
    "trapp-5-3-3"
    "vienna-roofs"
    "vienna-shapes"
    "visitor"
    "wang-12"
    "wang-3"
    "wang-frog"
    "who-hides-the-church"
    "window"
};

/// The sheets that ship with it, by the names of their pictures; each varies one of the scenes.
pub const SHEETS: &[(&str, &str)] = &[
    ("colour-styles", include_str!("../../scenes/colour-styles.sheet.toml")),
    ("looks", include_str!("../../scenes/looks.sheet.toml")),
    ("occlusion-styles", include_str!("../../scenes/occlusion-styles.sheet.toml")),
    ("opened", include_str!("../../scenes/opened.sheet.toml")),
    ("trapp-3-3-3", include_str!("../../scenes/trapp-3-3-3.sheet.toml")),
    ("trapp-3-3-4", include_str!("../../scenes/trapp-3-3-4.sheet.toml")),
    ("trapp-3-3-5", include_str!("../../scenes/trapp-3-3-5.sheet.toml")),
    ("trapp-3-3-6", include_str!("../../scenes/trapp-3-3-6.sheet.toml")),
    ("trapp-3-4-5", include_str!("../../scenes/trapp-3-4-5.sheet.toml")),
    ("trapp-3-4-8", include_str!("../../scenes/trapp-3-4-8.sheet.toml")),
    ("trapp-3-6-1", include_str!("../../scenes/trapp-3-6-1.sheet.toml")),
    ("trapp-3-6-2", include_str!("../../scenes/trapp-3-6-2.sheet.toml")),
    ("trapp-5-3-2", include_str!("../../scenes/trapp-5-3-2.sheet.toml")),
];

/// Images that scenes show or deform by, by their names in the folder.
pub const IMAGES: &[(&str, &[u8])] = &[
    ("trapp-3-6-3-b.png", include_bytes!("../../scenes/trapp-3-6-3-b.png")),
    ("trapp-5-3-3-a.png", include_bytes!("../../scenes/trapp-5-3-3-a.png")),
    ("trapp-5-3-3-b.png", include_bytes!("../../scenes/trapp-5-3-3-b.png")),
];

/// The folder that scenes find their images in: where the program was cloned, that of the scenes; else one for now.
struct ImageFolder {
    folder: PathBuf,
    is_own: bool,
}

impl ImageFolder {
    fn new() -> Outcome<Self> {
        let scenes = PathBuf::from("scenes");
        if IMAGES.iter().all(|(name, _)| scenes.join(name).is_file()) {
            return Ok(Self { folder: scenes, is_own: false });
        }
        let folder = std::env::temp_dir().join(format!("veduta-gallery-{}", std::process::id()));
        let failed = |error| Failure::io(&folder.display().to_string(), &error);
        std::fs::create_dir_all(&folder).map_err(failed)?;
        for (name, bytes) in IMAGES {
            std::fs::write(folder.join(name), bytes).map_err(failed)?;
        }
        Ok(Self { folder, is_own: true })
    }
}

impl Drop for ImageFolder {
    fn drop(&mut self) {
        if self.is_own {
            // What is left there the system clears.
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }
}

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
    /// How smooth pictures are.
    #[command(flatten)]
    pub smoothness: Smoothness,
}

/// Draws the scenes, one picture each.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    for name in &arguments.names {
        if !SCENES.iter().chain(SHEETS).any(|(known, _)| known == name) {
            let known: Vec<&str> = SCENES.iter().chain(SHEETS).map(|(known, _)| *known).collect();
            return Err(Failure::usage(format!("gallery: no scene {name}; there are {}", known.join(", "))));
        }
    }
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    let is_asked = |name: &str| arguments.names.is_empty() || arguments.names.iter().any(|asked| asked == name);
    let images = ImageFolder::new()?;
    let mut scenes = Vec::new();
    for (name, text) in SCENES.iter().filter(|(name, _)| is_asked(name)) {
        let options = Options::for_file(&images.folder.join(name));
        if let Some(mut scene) = parsed(name, name, text, &options)? {
            arguments.smoothness.put_into(&mut scene)?;
            scenes.push((name, scene, options));
        }
    }
    // Scenes of one city follow each other: it is loaded once.
    scenes.sort_by(|(_, a, _), (_, b, _)| a.city.files.cmp(&b.city.files));
    let names = SCENES.iter().chain(SHEETS).map(|(name, _)| name).filter(|name| is_asked(name));
    let written: Vec<PathBuf> = names.map(|name| folder.join(format!("{name}.png"))).collect();
    for (_, scene, _) in &scenes {
        output::keep(&written, &scene_file::files_of(scene))?;
    }
    let mut last: Option<(CitySpec, Studio)> = None;
    for (name, scene, options) in scenes {
        let mut studio = match last.take() {
            Some((city, studio)) if city == scene.city => studio,
            _ => render::open(&scene, &options, &written, global)?.0,
        };
        let request = Request { samples: scene.figure.samples(), ..Request::plain(scene.figure.pixels()) };
        let progress = terminal::Progress::spinning(&format!("drawing {name}"), global);
        let drawn =
            figure::draw(&mut studio, &scene, &request).map_err(|error| Failure::failed(format!("{name}: {error}")))?;
        drop(progress);
        let file = folder.join(format!("{name}.png"));
        picture::save_picture(&file, drawn.size, &drawn.rgba, true, &picture::notes_of(&scene, &options))
            .map_err(output::unwritten)?;
        output::print(&format!("{}\n", file.display()))?;
        last = Some((scene.city, studio));
    }
    for (name, text) in SHEETS.iter().filter(|(name, _)| is_asked(name)) {
        let Some(mut task) = task_of(name, text, &images)? else { continue };
        arguments.smoothness.put_into(&mut task.scene)?;
        if arguments.smoothness.is_told() {
            task.sheet.samples = None;
        }
        task.written.clone_from(&written);
        let file = folder.join(format!("{name}.png"));
        sheet::save(&file, &sheet::draw(&task, &mut last, global)?)?;
        output::print(&format!("{}\n", file.display()))?;
    }
    Ok(())
}

/// A scene that ships; `None`, and said for what is called `name`, where it is of a data set that is not there.
fn parsed(name: &str, scene: &str, text: &str, options: &Options) -> Outcome<Option<Scene>> {
    match scene_file::parse(text, &format!("scenes/{scene}.toml"), options) {
        Ok(scene) => Ok(Some(scene)),
        Err(error) if error.is_data_absent => {
            output::print(&format!("{name}: skipped: data absent (VEDUTA_DATA is not set)\n"))?;
            Ok(None)
        }
        Err(error) => Err(Failure::failed(error)),
    }
}

/// A sheet that ships, with its scene.
fn task_of(name: &str, text: &str, images: &ImageFolder) -> Outcome<Option<sheet::Task>> {
    let file = format!("scenes/{name}.sheet.toml");
    let sheet = figure::sheet::file::parse(text, &file).map_err(Failure::failed)?;
    let stem = sheet.scene.trim_end_matches(".toml");
    let Some((known, text)) = SCENES.iter().find(|(known, _)| *known == stem) else {
        return Err(Failure::failed(format!("{file}: scene: there is no {} in the gallery", sheet.scene)));
    };
    let options = Options::for_file(&images.folder.join(known));
    let scene = parsed(name, known, text, &options)?;
    Ok(scene.map(|scene| sheet::Task { name: file, sheet, scene, options, written: Vec::new() }))
}
