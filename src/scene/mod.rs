//! A scene: plain data that says what to look at, from where, through which lenses.
//!
//! Everything is in model coordinates, metres and radians; edits are commands.

pub mod check;
pub mod command;

use std::path::PathBuf;

use glam::DVec3;

use crate::{
    lens::{EffectUse, Lens},
    view::Camera,
};

pub use check::{SceneProblem, check_against};
pub use command::{Command, History};

/// All of a scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// The city to load.
    pub city: CitySpec,
    /// The eye; `None`: a good first view is chosen.
    pub camera: Option<Camera>,
    /// Light.
    pub sun: Sun,
    /// How the context looks.
    pub style: Style,
    /// Points of interest.
    pub pois: Vec<Poi>,
    /// Lenses, bottom to top.
    pub lenses: Vec<Lens>,
    /// How a picture is made of it.
    pub figure: Figure,
}

/// Which city, and how much of it.
#[derive(Clone, Debug, PartialEq)]
pub struct CitySpec {
    /// Files or folders, resolved against the scene file.
    pub files: Vec<PathBuf>,
    /// No LoD finer than this, canonical (`1.3`).
    pub lod: Option<String>,
    /// Whether a plain ground is put under a city without terrain.
    pub ground: bool,
}

impl Default for CitySpec {
    fn default() -> Self {
        Self { files: Vec::new(), lod: None, ground: true }
    }
}

/// The sun and its shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where the light comes from: radians clockwise from north.
    pub azimuth: f64,
    /// Radians above the horizon, -π/2..π/2.
    pub elevation: f64,
    /// Whether it casts shadows.
    pub shadows: bool,
}

impl Default for Sun {
    fn default() -> Self {
        Self { azimuth: 215_f64.to_radians(), elevation: 48_f64.to_radians(), shadows: true }
    }
}

/// How the context looks.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Style {
    /// The colours surfaces start from.
    pub base: BaseStyle,
    /// Effects on everything outside (and under) the lenses, in order.
    pub effects: Vec<EffectUse>,
    /// What is behind the city.
    pub background: Background,
}

/// The colours surfaces start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BaseStyle {
    /// The file's materials and textures; where it has none, quiet colours by kind of surface.
    #[default]
    Natural,
    /// One clay colour for everything.
    Clay,
}

/// What is behind the city.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Background {
    /// A quiet sky.
    #[default]
    Sky,
    /// One colour, sRGB 0..1.
    Color([f32; 3]),
}

/// A point of interest.
#[derive(Clone, Debug, PartialEq)]
pub struct Poi {
    /// Its name, unique.
    pub name: String,
    /// What it is.
    pub place: PoiPlace,
}

/// Where a point of interest is.
#[derive(Clone, Debug, PartialEq)]
pub enum PoiPlace {
    /// A city object, by id.
    Object(String),
    /// A point, metres.
    At(DVec3),
}

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Width and height, pixels, 1..=16384.
    pub size: [u32; 2],
    /// Samples per pixel, 1..=1024.
    pub samples: u32,
}

impl Default for Figure {
    fn default() -> Self {
        Self { size: [1280, 720], samples: 1 }
    }
}
