//! `veduta animate`: the frames of a scene along its paths.

use std::{
    path::{Path, PathBuf},
    str::FromStr,
};

use clap::Args;
use serde::Serialize;

use crate::{
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        film::{self, Film},
        output,
        quality::Smoothness,
        render::{self, arguments::Size},
        terminal,
    },
    figure::{
        self,
        animation::{self, FilmError},
        overlays::Standing,
        picture,
    },
    render::{picture::Request, stats::Statistics},
    scene::Scene,
};

const EXAMPLES: &str = "\
Examples:
  veduta animate scene.toml -o frames
  veduta animate scene.toml -o frames --size 1920x1080 --quality draft
  veduta animate scene.toml -o frames --frames 0..49      frames 0 to 49, both included
  veduta animate scene.toml -o frames --set animation.fps=60
  veduta animate scene.toml -o frames --stats walk.jsonl  what each frame cost and did, a line of JSON each
  veduta animate scene.toml -o frames --film walk.mp4     and a film of them, where ffmpeg is there

The scene has a table [animation] (docs/scene.md). DIR gets 0000.png, 0001.png, ...; each frame is the picture that
`veduta render` makes of the scene at its moment, but that occluders come and go gradually (`margin` and `fade` of
occlusion lenses). Frames that are there already are replaced, one by one.";

/// Arguments of `veduta animate`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// A scene with a table `[animation]`; `-` for stdin
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The folder to write to; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Only these frames, from 0, both included: 0..49, 50.., ..49, 7
    #[arg(long, value_name = "A..B")]
    pub frames: Option<Frames>,
    /// Width and height in pixels [default: the scene's, else 1280x720]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// How smooth pictures are.
    #[command(flatten)]
    pub smoothness: Smoothness,
    /// Also make a film of the frames, .mp4 or .gif; repeatable. Without ffmpeg the line to run is told
    #[arg(long, value_name = "FILE")]
    pub film: Vec<Film>,
    /// Write statistics: of each frame a line, the JSON object of `veduta render --stats` with its `number` and `at_s`
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Change the scene: lens.0.shape.radius=80, animation.frames=30; repeatable, in order
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub settings: Vec<String>,
}

/// Which frames: first and last, where they are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    first: Option<u32>,
    last: Option<u32>,
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let usage = || "A..B would be right, first and last frame from 0, as 0..49, 50.., ..49 or 7".to_owned();
        let number = |text: &str| -> Result<Option<u32>, String> {
            if text.is_empty() { Ok(None) } else { text.parse().map(Some).map_err(|_| usage()) }
        };
        let Some((first, last)) = text.split_once("..") else {
            let only = number(text)?.ok_or_else(usage)?;
            return Ok(Self { first: Some(only), last: Some(only) });
        };
        let frames = Self { first: number(first)?, last: number(last)? };
        match (frames.first, frames.last) {
            (Some(first), Some(last)) if first > last => {
                Err(format!("the first frame is {first} and the last {last}: {last}..{first} would be right"))
            }
            _ => Ok(frames),
        }
    }
}

impl Frames {
    /// First and last of an animation of so many frames.
    fn of(self, count: u32) -> Result<[u32; 2], String> {
        let [first, last] = [self.first.unwrap_or(0), self.last.unwrap_or(count - 1)];
        match first.max(last) {
            beyond if beyond >= count => {
                Err(format!("--frames: there is no frame {beyond}: the animation has {count}, 0 to {}", count - 1))
            }
            _ => Ok([first, last]),
        }
    }
}

/// Draws the frames.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let file = &arguments.scene;
    if arguments.output.as_os_str() == "-" {
        return Err(Failure::usage("animate: frames are files, and cannot go to stdout; -o DIR would be right"));
    }
    let films = arguments.film.iter().map(|film| &film.file);
    output::check(arguments.stats.iter().chain(films.clone()), [file])?;
    let options = render::options_of(Some(file), global);
    let scene = figure::scene_file::read(file, &options).map_err(Failure::failed)?;
    let mut scene = render::changed(scene, &arguments.settings)?;
    output::keep(&arguments.stats, &figure::scene_file::files_of(&scene))?;
    if let Some(size) = arguments.size {
        scene.figure.set_pixels(size.0);
    }
    arguments.smoothness.put_into(&mut scene)?;
    let failed = |error: FilmError| Failure::failed(format!("{}: {error}", file.display()));
    let film = animation::Film::new(&scene).map_err(failed)?;
    let all = Frames { first: None, last: None };
    let [first, last] = arguments.frames.unwrap_or(all).of(film.frames()).map_err(Failure::usage)?;
    // Before anything is drawn: a frame without a scene may be the last.
    let first_scene = film.scene(first).map_err(failed)?;
    // Occluders and overlays have a history, which begins with frame 0 whichever frames are drawn.
    let has_history =
        first_scene.lenses.iter().any(|lens| lens.enabled && (lens.occluders().is_some() || lens.kind.has_overlay()));
    let begin = if has_history { 0 } else { first };
    (begin..=last).try_for_each(|frame| film.scene(frame).map(|_| ())).map_err(failed)?;
    let folder = Folder::new(&arguments.output, film.frames())?;
    let mut written: Vec<PathBuf> = (first..=last).map(|frame| folder.file(frame)).collect();
    written.extend(arguments.stats.iter().chain(films).cloned());
    output::keep(&written, [file])?;
    let (mut studio, warnings) = render::open(&first_scene, &options, &written, global)?;
    let count = u64::from(last - first) + 1;
    log::info!("{count} frames, {} per second", film.fps());
    let progress = terminal::Progress::counting(count, "drawing", "frames", global);
    let (mut lines, mut is_warned, mut standing) = (Vec::new(), false, Standing::default());
    for frame in begin..=last {
        let said = film.scene(frame).map_err(failed)?;
        let at_frame = |error: String| Failure::failed(format!("{}: frame {frame}: {error}", file.display()));
        let scene = studio.on_ground(&said).map_err(|error| at_frame(error.to_string()))?;
        studio.pass(&scene, scene.figure.pixels(), 1.0 / film.fps()).map_err(|error| at_frame(error.to_string()))?;
        if frame < first {
            figure::pass(&mut studio, &scene, scene.figure.pixels(), &mut standing)
                .map_err(|error| at_frame(error.to_string()))?;
            continue;
        }
        if !is_warned && studio.is_fading() && scene.figure.samples() < SMOOTH {
            is_warned = true;
            log::warn!(
                "frame {frame}: occluders fade by a pattern of pixels, which is seen with {} per pixel; figure.samples = {SMOOTH} \
                 (--samples {SMOOTH}) smooths it",
                if scene.figure.samples() == 1 {
                    "1 sample".to_owned()
                } else {
                    format!("{} samples", scene.figure.samples())
                }
            );
        }
        let asked = request(&scene, arguments.stats.is_some());
        let mut drawn = figure::draw_next(&mut studio, &scene, &asked, &mut standing)
            .map_err(|error| at_frame(error.to_string()))?;
        if arguments.stats.is_some() {
            render::with_warnings(&mut drawn.statistics, &warnings);
            let line = FrameLine { number: frame, at_s: f64::from(frame) / film.fps(), statistics: &drawn.statistics };
            serde_json::to_writer(&mut lines, &line).map_err(|error| at_frame(error.to_string()))?;
            lines.push(b'\n');
        }
        let notes = picture::notes_of(&said, &options);
        picture::save_picture(&folder.file(frame), drawn.size, &drawn.rgba, true, &notes).map_err(output::unwritten)?;
        progress.at(u64::from(frame - first) + 1);
    }
    if let Some(file) = &arguments.stats {
        output::write(file, |out| out.write_all(&lines))?;
    }
    drop(progress);
    let pattern = folder.pattern();
    let frames = film::Frames { pattern: &pattern, first, count, fps: film.fps() };
    arguments.film.iter().try_for_each(|film| film.make(&frames))
}

/// Samples from which on a fade looks smooth: with fewer its pattern stands out on large faces.
const SMOOTH: u32 = 8;

/// A line of statistics.
#[derive(Serialize)]
struct FrameLine<'a> {
    number: u32,
    at_s: f64,
    #[serde(flatten)]
    statistics: &'a Statistics,
}

fn request(scene: &Scene, statistics: bool) -> Request {
    Request { samples: scene.figure.samples(), statistics, ..Request::plain(scene.figure.pixels()) }
}

/// Where frames go.
struct Folder {
    path: PathBuf,
    digits: usize,
}

impl Folder {
    /// Makes it where it is missing, and warns of what looks like frames of a longer animation: a film made of the folder
    /// would have them at its end.
    fn new(path: &Path, frames: u32) -> Outcome<Self> {
        let named = format!("-o {}", path.display());
        if path.is_file() {
            let message = format!("{named}: is a file, and frames go to a folder; -o DIR would be right");
            return Err(Failure::usage(message));
        }
        std::fs::create_dir_all(path)
            .map_err(|error| Failure::io(&format!("{named}: the folder cannot be made"), &error))?;
        let digits = (frames - 1).max(1).ilog10() as usize + 1;
        let folder = Self { path: path.to_owned(), digits: digits.max(4) };
        let entries = std::fs::read_dir(path).map_err(|error| Failure::io(&path.display().to_string(), &error))?;
        let mut others: Vec<String> = entries
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| folder.number(name).is_some_and(|number| number >= u64::from(frames)))
            .collect();
        others.sort();
        if let Some(other) = others.first() {
            let more = if others.len() > 1 { format!(" and {} more", others.len() - 1) } else { String::new() };
            log::warn!(
                "{}: {other}{more} stay: this animation has {frames} frames, and they are of another one",
                path.display()
            );
        }
        Ok(folder)
    }

    /// Names of the frames, as ffmpeg has them.
    fn pattern(&self) -> PathBuf {
        self.path.join(format!("%0{}d.png", self.digits))
    }

    fn file(&self, frame: u32) -> PathBuf {
        self.path.join(format!("{frame:0digits$}.png", digits = self.digits))
    }

    /// The number of what is named like a frame.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_suffix(".png")?;
        let is_number = digits.len() >= 4 && digits.bytes().all(|b| b.is_ascii_digit());
        if is_number { digits.parse().ok() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_first_and_last() {
        let of = |text: &str| text.parse::<Frames>().and_then(|frames| frames.of(100));
        assert_eq!(of("0..49"), Ok([0, 49]));
        assert_eq!(of("50.."), Ok([50, 99]));
        assert_eq!(of("..49"), Ok([0, 49]));
        assert_eq!(of(".."), Ok([0, 99]));
        assert_eq!(of("7"), Ok([7, 7]));
        for wrong in ["", "a..b", "0...4", "-1..3", "9..3", "0..100", "100", "100..", "1..2..3"] {
            assert!(of(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn files_have_four_digits_or_as_many_as_it_takes() {
        let name = |frames, frame| {
            let digits = Folder::new(&std::env::temp_dir(), frames).unwrap().file(frame);
            digits.file_name().unwrap().to_str().unwrap().to_owned()
        };
        assert_eq!(name(1, 0), "0000.png");
        assert_eq!(name(10_000, 9999), "9999.png");
        assert_eq!(name(10_001, 7), "00007.png");
    }
}
