//! Arguments of `veduta render`, and how each value is spelt.

use std::{path::PathBuf, str::FromStr};

use clap::Args;

use crate::{
    cli::{
        failure::{Failure, Outcome},
        output,
        quality::Smoothness,
        render::sprites::SpriteRequest,
    },
    figure::{paper::Format, picture::Aov},
    render::{
        frame::Backend,
        parts::{LEAST_TILE, TILE},
    },
    scene::Scene,
};

const EXAMPLES: &str = "\
Examples:
  veduta render city.city.json -o city.png
  veduta render tiles/*.city.jsonl -o city.png --size 1920x1080 --quality draft
  veduta render scene.toml -o figure.png --set lens.0.shape.radius=80 --set lens.b.enabled=false
  veduta render scene.toml -o figure.pdf --set figure.size_mm=[120,80] --set figure.scale_bar=auto
  veduta render scene.toml -o figure.png --sprite hall=hall.exr
  veduta render scene.toml -o beyond.png --through gate      what is seen after stepping through a portal
  veduta render scene.toml -o figure.png --aov depth=depth.exr --aov object-id=ids.png --stats stats.json

A FILE that ends in .toml is a scene (docs/scene.md); city files get a good first view. PDF and SVG hold the picture as pixels, and text, legends and
lines over it as such; they are as large on paper as [figure] says, at 96 dots per inch where it says nothing.
AOVs: depth (.exr metres, .png 16 bit), object-id (.png), normal (.exr, .png), lens-mask (.png, .exr); KIND:displayed
includes image-space lenses. The same input on the same adapter gives the same bytes.";

/// Pixels on a side at most.
const MAX_SIDE: u32 = 16_384;
/// Arguments of `veduta render`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// One scene (.toml), or city files
    #[arg(required = true, value_name = "SCENE|FILE")]
    pub files: Vec<PathBuf>,
    /// The picture to write: PNG, PDF or SVG by its name; `-` for stdout, as PNG
    #[arg(short, long, value_name = "OUT.png|pdf|svg")]
    pub output: PathBuf,
    /// Width and height in pixels [default: the scene's, else 1280x720]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// How smooth pictures are.
    #[command(flatten)]
    pub smoothness: Smoothness,
    /// Change the scene: lens.0.shape.radius=80, lens.NAME.enabled=false; repeatable, in order
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub settings: Vec<String>,
    /// Write what it cost and what the lenses did, as one JSON object
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Write what each pixel shows: depth, object-id, normal or lens-mask; repeatable
    #[arg(long = "aov", value_name = "KIND=FILE")]
    pub aovs: Vec<AovRequest>,
    /// Write the depth sprite that a lens is tested by (docs/sprites.md); repeatable
    #[arg(long = "sprite", value_name = "LENS=FILE.exr")]
    pub sprites: Vec<SpriteRequest>,
    /// Step through a portal first: the picture is of where it leads, and it leads back
    #[arg(long, value_name = "LENS")]
    pub through: Option<String>,
    /// Leave out sky and background: straight alpha
    #[arg(long)]
    pub transparent: bool,
    /// Draw in tiles of at most so many pixels a side, 64 to 4096: less memory, and slower; the picture is the same [default: 4096]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(i64::from(LEAST_TILE)..=i64::from(TILE)))]
    pub tile: Option<u32>,
    /// How shaders are made; the picture is the same
    #[arg(long, value_name = "HOW", value_enum, default_value_t)]
    pub shaders: Shaders,
}

/// Back ends of the shader handlers.
#[derive(clap::ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shaders {
    /// Made for this scene
    #[default]
    Specialised,
    /// One for all that the scene may ask for
    Uber,
}

impl From<Shaders> for Backend {
    fn from(shaders: Shaders) -> Self {
        match shaders {
            Shaders::Specialised => Self::Specialised,
            Shaders::Uber => Self::Uber,
        }
    }
}

impl Arguments {
    /// Whether what is asked fits together and can be written; clap has checked each value by itself.
    pub fn check(&self) -> Outcome {
        let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if self.files.iter().any(is_scene) && self.files.len() > 1 {
            return Err(Failure::usage(
                "render: one scene (.toml) or any number of city files; a scene names its files itself",
            ));
        }
        Format::of(&self.output).map_err(Failure::usage)?;
        let streams = self.outputs().filter(|file| file.as_os_str() == "-").count();
        if streams > 1 {
            return Err(Failure::usage("-: two results cannot go to one file"));
        }
        output::check(self.outputs(), &self.files)
    }

    /// All files to write, the picture first.
    pub fn outputs(&self) -> impl Iterator<Item = &PathBuf> {
        let aovs = self.aovs.iter().map(|aov| &aov.file);
        let sprites = self.sprites.iter().map(|sprite| &sprite.file);
        std::iter::once(&self.output).chain(&self.stats).chain(aovs).chain(sprites)
    }

    /// The scene file, when one is named; else `files` are city files.
    pub fn scene(&self) -> Option<&PathBuf> {
        scene_among(&self.files)
    }
}

/// The scene file, when the first is one.
pub fn scene_among(files: &[PathBuf]) -> Option<&PathBuf> {
    files.first().filter(|path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")))
}

/// A picture's size, `1280x720`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |side: &str| side.parse().ok().filter(|n| (1..=MAX_SIDE).contains(n));
        text.split_once('x')
            .and_then(|(width, height)| Some(Self([side(width)?, side(height)?])))
            .ok_or_else(|| format!("width and height of 1 to {MAX_SIDE} pixels would be right, as 1280x720"))
    }
}

/// The content of an AOV.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AovKind {
    /// Metres along the view axis.
    Depth,
    /// Object index + 1.
    ObjectId,
    /// Unit normals.
    Normal,
    /// Membership in each lens.
    LensMask,
}

impl AovKind {
    const NAMES: [(&'static str, Self); 4] = [
        ("depth", Self::Depth),
        ("object-id", Self::ObjectId),
        ("normal", Self::Normal),
        ("lens-mask", Self::LensMask),
    ];

    /// What is written of a picture of this scene.
    pub fn content(self, scene: &Scene) -> Aov {
        match self {
            Self::Depth => Aov::Depth,
            Self::ObjectId => Aov::ObjectId,
            Self::Normal => Aov::Normal,
            Self::LensMask => Aov::LensMask(scene.lenses.len()),
        }
    }

    fn formats(self) -> &'static [AovFormat] {
        match self {
            Self::ObjectId => &[AovFormat::Png],
            _ => &[AovFormat::Png, AovFormat::Exr],
        }
    }
}

/// The format of an AOV.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AovFormat {
    /// Integers.
    Png,
    /// Floats or 32-bit integers.
    Exr,
}

/// One `--aov`: `depth=depth.exr`, `object-id:displayed=ids.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AovRequest {
    /// The content.
    pub kind: AovKind,
    /// Whether image-space lenses are included.
    pub is_displayed: bool,
    /// The format.
    pub format: AovFormat,
    /// Where to.
    pub file: PathBuf,
}

impl FromStr for AovRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = AovKind::NAMES.map(|(name, _)| name).join(", ");
        let usage = || format!("KIND=FILE would be right, with KIND one of {names}");
        let (kind, file) = text.split_once('=').filter(|(_, file)| !file.is_empty()).ok_or_else(usage)?;
        let (kind, is_displayed) = match kind.split_once(':') {
            Some((kind, "displayed")) => (kind, true),
            Some((_, other)) => return Err(format!("':{other}' is unknown; ':displayed' would be right")),
            None => (kind, false),
        };
        let (name, kind) = *AovKind::NAMES.iter().find(|(name, _)| *name == kind).ok_or_else(usage)?;
        let file = PathBuf::from(file);
        let format = match file.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some("png") => AovFormat::Png,
            Some("exr") => AovFormat::Exr,
            _ => return Err(format!("{}: .png or .exr would be right", file.display())),
        };
        if !kind.formats().contains(&format) {
            return Err(format!("{name} is written as .png only"));
        }
        Ok(Self { kind, is_displayed, format, file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("1280x720".parse(), Ok(Size([1280, 720])));
        for wrong in ["", "1280", "0x5", "5x0", "16385x1", "-1x5", "axb", "1x2x3", "1280X720", "4294967297x1"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn aovs_name_kind_format_and_file() {
        let aov: AovRequest = "depth:displayed=a/b=c.EXR".parse().unwrap();
        let expected =
            AovRequest { kind: AovKind::Depth, is_displayed: true, format: AovFormat::Exr, file: "a/b=c.EXR".into() };
        assert_eq!(aov, expected);
        for wrong in ["depth", "depth=", "depht=a.png", "depth=a.jpg", "object-id=a.exr", "depth:shown=a.png"] {
            assert!(wrong.parse::<AovRequest>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let check = |files: &[&str], output: &str, aov: &str| {
            let aovs = vec![aov.parse().unwrap()];
            let files = files.iter().map(PathBuf::from).collect();
            Arguments { files, output: output.into(), aovs, ..Default::default() }.check()
        };
        assert!(check(&["a.json", "b.json"], "a.png", "depth=d.png").is_ok());
        assert!(check(&["a.toml", "b.json"], "a.png", "depth=d.png").is_err());
        assert!(check(&["a.json"], "a.jpg", "depth=d.png").is_err());
        assert!(check(&["a.json"], "a", "depth=d.png").is_err());
        assert!(check(&["a.json"], "a.PDF", "depth=d.png").is_ok());
        assert!(check(&["a.json"], "a.svg", "depth=d.png").is_ok());
        assert!(check(&["a.json"], "d.png", "depth=d.png").is_err());
        assert!(check(&["a.json"], "-", "depth=d.png").is_ok());
    }
}
