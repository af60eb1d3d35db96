//! `veduta render`: one picture, no window.

pub mod arguments;
pub mod sprites;

use std::{
    path::PathBuf,
    sync::{Arc, Once},
};

use arguments::{AovFormat, AovKind, AovRequest, Arguments};

use crate::{
    city::{facts, load::LoadOptions},
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        load, output, terminal,
    },
    figure::{
        paper::{self, Format, Target},
        picture::{self, AovFile},
        scene_file::{self, Options},
    },
    gpu::Gpu,
    lens::nearest::did_you_mean,
    render::{
        bands::Band,
        diagnostics,
        picture::{Aovs, RenderError, Request, Studio},
        stats,
    },
    scene::{Command, History, Scene, SceneProblem, check_against},
    view::Camera,
};

/// Lenses that a PNG mask holds.
const PNG_LENSES: usize = 16;

/// Draws the picture and everything that comes with it.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    arguments.check()?;
    let options = options_of(arguments.scene(), global);
    let (mut scene, of_camera) = scene_of(&arguments.files, &arguments.settings, &options)?;
    if let Some(size) = arguments.size {
        scene.figure.set_pixels(size.0);
    }
    arguments.smoothness.put_into(&mut scene)?;
    let written: Vec<PathBuf> = arguments.outputs().cloned().collect();
    output::keep(&written, &scene_file::files_of(&scene))?;
    check_masks(&arguments.aovs, &scene)?;
    for sprite in &arguments.sprites {
        sprite.lens(&scene)?;
    }
    let (mut studio, warnings) = open(&scene, &options, &written, global)?;
    studio.renderer.settings.tile = arguments.tile;
    let mut scene = with_camera(scene, &of_camera, &studio)?;
    if let Some(name) = &arguments.through {
        let from = studio.camera(&*studio.on_ground(&scene).map_err(Failure::failed)?, scene.figure.pixels());
        portal(&scene, name, from)?.redo(&mut scene);
    }
    // Notes say what the file says; what is drawn has heights of the model.
    let said = scene;
    let scene = studio.on_ground(&said).map_err(|error| in_file(arguments, error))?;
    if let Some(object) = studio.building_around(&scene) {
        log::warn!(
            "the eye is in building \"{}\": what is seen are its walls from inside",
            studio.model.objects[object as usize].id
        );
    }
    if let Some(metres) = studio.eye_below_ground(&scene) {
        log::warn!(
            "the eye is {metres:.1} m below the ground: what is seen are undersides; `veduta info --at X,Y` tells how high the ground is"
        );
    }
    let has = |kind| arguments.aovs.iter().any(|aov| aov.kind == kind);
    let request = Request {
        samples: scene.figure.samples(),
        transparent: arguments.transparent,
        aovs: Aovs {
            depth: has(AovKind::Depth),
            object_id: has(AovKind::ObjectId),
            normal: has(AovKind::Normal),
            lens_mask: has(AovKind::LensMask),
        },
        statistics: arguments.stats.is_some(),
        backend: arguments.shaders.into(),
        ..Request::plain(scene.figure.pixels())
    };
    let progress = terminal::Progress::spinning("drawing", global);
    let format = Format::of(&arguments.output).map_err(Failure::usage)?;
    let notes = picture::notes_of(&said, &options);
    // Image-space lenses do not exist in this version: displayed and shown surface are one.
    let file = |aov: &AovRequest| AovFile::new(&aov.file, aov.kind.content(&scene), request.size, &notes);
    let mut aovs: Vec<AovFile> =
        arguments.aovs.iter().map(file).collect::<Result<_, _>>().map_err(output::unwritten)?;
    let target = Target { path: &arguments.output, format, notes: &notes };
    let mut also = |band: &Band| aovs.iter_mut().try_for_each(|aov| aov.take(band));
    let drawn = paper::draw(&mut studio, &scene, &request, target, &mut also);
    let (mut picture, drawn) = drawn.map_err(|error| in_file(arguments, error))?;
    drop(progress);
    aovs.into_iter().try_for_each(AovFile::finish).map_err(output::unwritten)?;
    for sprite in &arguments.sprites {
        sprites::write(&mut studio, &scene, sprite)?;
    }
    if let Some(file) = &arguments.stats {
        with_warnings(&mut picture.statistics, &warnings);
        output::write(file, |out| {
            serde_json::to_writer_pretty(&mut *out, &picture.statistics)?;
            writeln!(out)
        })?;
    }
    // Last, so that a picture that is there means that everything is there.
    drawn.finish().map_err(output::unwritten)
}

/// An error of what a scene says names its file; one of what is written says what would be right.
fn in_file(arguments: &Arguments, error: RenderError) -> Failure {
    match (error, arguments.scene()) {
        (RenderError::Scene(message), Some(file)) => Failure::failed(format!("{}: {message}", file.display())),
        (RenderError::Taken(error), _) => match error.downcast() {
            Ok(error) => output::unwritten(*error),
            Err(error) => Failure::failed(error),
        },
        (error, _) => Failure::failed(error),
    }
}

/// The step through the portal of this name.
fn portal(scene: &Scene, name: &str, from: Camera) -> Outcome<Command> {
    let found = scene.lenses.iter().position(|lens| lens.name == name);
    let step = found.and_then(|index| Command::step_through(scene, index, from));
    step.ok_or_else(|| {
        let portals = scene.lenses.iter().filter(|lens| lens.kind.row().is_door);
        let hint = did_you_mean(name, portals.map(|lens| lens.name.as_str()));
        Failure::usage(format!("--through: the scene has no portal \"{name}\"{hint}"))
    })
}

/// Puts what is to be warned of into statistics: of the files as it is worded for the command line, the rest about this picture.
pub fn with_warnings(statistics: &mut stats::Statistics, warnings: &[serde_json::Value]) {
    let is_of_picture =
        |w: &serde_json::Value| w["code"].as_str().is_some_and(|code| diagnostics::CODES.contains(&code));
    let of_picture = std::mem::take(&mut statistics.warnings).into_iter().filter(is_of_picture);
    statistics.warnings = warnings.iter().cloned().chain(of_picture).collect();
}

/// The rules by which paths of a scene file, or of the command line, are read.
pub fn options_of(scene: Option<&PathBuf>, global: &GlobalArguments) -> Options {
    match scene {
        Some(file) => Options { allow_outside: global.allow_outside, must_exist: true, ..Options::for_file(file) },
        None => Options::for_command_line(),
    }
}

/// The scene that is drawn: the file's, or one of the city files alone, then every `--set` in order; and those of them that change a
/// camera which the scene leaves to the program, for [`with_camera`].
pub fn scene_of(files: &[PathBuf], settings: &[String], options: &Options) -> Outcome<(Scene, Vec<String>)> {
    let scene = match arguments::scene_among(files) {
        Some(file) => scene_file::read(file, options).map_err(Failure::failed)?,
        None => {
            let mut scene = Scene::default();
            scene.city.files = files.to_vec();
            scene
        }
    };
    let (of_camera, others): (Vec<String>, Vec<String>) =
        settings.iter().cloned().partition(|setting| setting.trim_start().starts_with("camera."));
    // One that sets the whole camera may stand among them.
    let sets_camera = others.iter().any(|setting| setting.trim_start().starts_with("camera"));
    if scene.camera.is_some() || sets_camera {
        return Ok((changed(scene, settings)?, Vec::new()));
    }
    Ok((changed(scene, &others)?, of_camera))
}

/// The scene after what changes the camera that it leaves to the program: a good first view of the city.
pub fn with_camera(mut scene: Scene, of_camera: &[String], studio: &Studio) -> Outcome<Scene> {
    if !of_camera.is_empty() {
        scene.camera = Some(studio.camera(&scene, scene.figure.pixels()));
    }
    changed(scene, of_camera)
}

/// The scene after every `--set`, in order.
pub fn changed(scene: Scene, settings: &[String]) -> Outcome<Scene> {
    let mut history = History::new(scene);
    for assignment in settings {
        let command = scene_file::set(history.scene(), assignment).map_err(Failure::usage)?;
        history.apply(command);
    }
    Ok(history.scene().clone())
}

/// Refuses, before anything is drawn, what could not be written afterwards.
fn check_masks(aovs: &[AovRequest], scene: &Scene) -> Outcome {
    let is_mask = |aov: &&AovRequest| (aov.kind, aov.format) == (AovKind::LensMask, AovFormat::Png);
    match aovs.iter().find(is_mask) {
        Some(aov) if scene.lenses.len() > PNG_LENSES => Err(Failure::usage(format!(
            "{}: a PNG mask holds {PNG_LENSES} lenses and the scene has {}; .exr would be right",
            aov.file.display(),
            scene.lenses.len()
        ))),
        _ => Ok(()),
    }
}

/// Loads the scene's city and puts it on the GPU; with what is to be warned of. `outputs`: all files that will be written; one that is read by
/// the scene, or by a file that it reads, is refused before anything is drawn.
pub fn open(
    scene: &Scene,
    options: &Options,
    outputs: &[PathBuf],
    global: &GlobalArguments,
) -> Outcome<(Studio, Vec<serde_json::Value>)> {
    output::keep(outputs, &scene_file::files_of(scene))?;
    if scene.is_empty() {
        return Err(Failure::failed("the scene names no city; [city] files = [\"FILE\"] would be right"));
    }
    let mut roots: Vec<PathBuf> = options.roots.clone();
    roots.push(options.base.clone());
    let reading = LoadOptions {
        allow_outside: global.allow_outside,
        roots,
        up: scene.city.up,
        materials: scene.city.materials,
        joins: scene.city.joins.clone(),
        changes: (scene.city.changes.clone(), scene.city.dating.clone()),
        timetables: scene.city.timetables.clone(),
        ..LoadOptions::default()
    };
    let (model, load) = load::load_with(&scene.city.files, &reading, global)?;
    output::keep(outputs, &model.files_beside())?;
    let mut warnings: Vec<serde_json::Value> =
        facts::warning_facts(&model).iter().filter_map(|warning| serde_json::to_value(warning).ok()).collect();
    if !warnings.is_empty() {
        log::info!("{} kinds of warnings about the city; `veduta info` lists them", warnings.len());
    }
    let missing = model.textures.iter().filter(|texture| texture.image.is_missing()).count();
    if missing > 0 {
        log::warn!("{missing} of {} textures cannot be read; their materials' colours are used", model.textures.len());
    }
    for problem in told(check_against(scene, &model), "scene")? {
        let message = problem.to_string();
        warnings.push(serde_json::json!({"code": "scene", "count": 1, "objects": [], "message": message}));
    }
    let gpu = Gpu::open().map_err(Failure::failed)?;
    static SAID: Once = Once::new();
    if gpu.is_software() && !global.quiet {
        SAID.call_once(|| terminal::say(&format!("note: there is no graphics hardware; {} draws, slowly", gpu.name())));
    }
    let mut studio = Studio::new(gpu, Arc::new(model), &scene.city).map_err(Failure::failed)?;
    studio.reading = reading;
    output::keep(outputs, &studio.volume_files(scene).map_err(Failure::failed)?)?;
    let why = facts::nothing_drawn(&studio.model, &studio.geometries);
    if let Some(why) = why.filter(|_| !scene.city.files.is_empty()) {
        log::warn!("nothing of the city is drawn: {why}");
        warnings.push(serde_json::json!({"code": "nothing-drawn", "count": 1, "objects": [], "message": why}));
    }
    let ms = |stage: &str, time: std::time::Duration| (stage.to_owned(), time.as_secs_f64() * 1e3);
    studio.load = stats::Load {
        ms: [ms("read", load.read), ms("parse", load.parse), ms("build", load.build)].into_iter().collect(),
        peak_bytes: stats::peak_memory(),
    };
    Ok((studio, warnings))
}

/// Tells what a scene names and its city does not have, after `whose`; those that can be lived with.
///
/// # Errors
/// The last of those that cannot; the others are told as errors, too.
pub fn told(problems: Vec<SceneProblem>, whose: &str) -> Outcome<Vec<SceneProblem>> {
    let (mut errors, others): (Vec<_>, Vec<_>) = problems.into_iter().partition(|problem| problem.is_error);
    if let Some(last) = errors.pop() {
        errors.iter().for_each(|problem| log::error!("{whose}: {problem}"));
        return Err(Failure::failed(format!("{whose}: {last}")));
    }
    others.iter().for_each(|problem| log::warn!("{whose}: {problem}"));
    Ok(others)
}
