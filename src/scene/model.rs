//! What a scene is made of.

use std::path::PathBuf;

use glam::DVec3;

use crate::{
    city::{Materials, load::Up},
    lens::{
        EffectUse, Lens,
        best_view::{Background, BaseStyle, StyleLook},
    },
    scene::{
        animation::Animation,
        overlay::{Layout, Overlay},
        technique::Technique,
        trajectory::Trajectory,
        transparency::Transparency,
    },
    view::Camera,
};

/// All of a scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// The city to load.
    pub city: CitySpec,
    /// The eye; `None`: a good first view is chosen.
    pub camera: Option<Camera>,
    /// Light.
    pub sun: Sun,
    /// The moment that is shown, seconds: where what moves is.
    pub time_s: f64,
    /// How the context looks.
    pub style: Style,
    /// The ways of what moves.
    pub trajectories: Vec<Trajectory>,
    /// Points of interest.
    pub pois: Vec<Poi>,
    /// Lenses, bottom to top.
    pub lenses: Vec<Lens>,
    /// How the pictures of best-view lenses stand over the main one; those without have one with every value at its default.
    pub overlays: Vec<Overlay>,
    /// Where overlays stand.
    pub layout: Layout,
    /// How a picture is made of it.
    pub figure: Figure,
    /// How it changes over time; a picture shows nothing of it.
    pub animation: Option<Animation>,
}

/// Which city, and how much of it.
#[derive(Clone, Debug, PartialEq)]
pub struct CitySpec {
    /// Files or folders, resolved against the scene file.
    pub files: Vec<PathBuf>,
    /// No LoD finer than this, canonical (`1.3`).
    pub lod: Option<String>,
    /// What is up in OBJ files, which do not say so.
    pub up: Up,
    /// How colours of materials are shown.
    pub materials: Materials,
    /// Whether a plain ground is put under a city without terrain.
    pub ground: bool,
}

impl Default for CitySpec {
    fn default() -> Self {
        Self { files: Vec::new(), lod: None, up: Up::default(), materials: Materials::Tamed, ground: true }
    }
}

/// Sun and sky, and their shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where the light comes from: radians clockwise from north.
    pub azimuth: f64,
    /// Radians above the horizon, -π/2..π/2.
    pub elevation: f64,
    /// Whether it casts shadows.
    pub shadows: bool,
    /// Angular diameter of its disc, radians, 0..0.35: 0 is a point. Pictures of several samples show it as the softness of shadows.
    pub size: f64,
    /// Whether the city hides parts of the sky from itself, where the sun casts shadows; in pictures of several samples.
    pub ambient_occlusion: bool,
}

impl Default for Sun {
    fn default() -> Self {
        Self {
            azimuth: 215_f64.to_radians(),
            elevation: 48_f64.to_radians(),
            shadows: true,
            // As from the Earth.
            size: 0.53_f64.to_radians(),
            ambient_occlusion: true,
        }
    }
}

/// How the context looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// What it starts from.
    pub look: StyleLook,
    /// The colours surfaces start from.
    pub base: BaseStyle,
    /// Effects on everything outside (and under) the lenses, in order.
    pub effects: Vec<EffectUse>,
    /// What is behind the city; [`Background::Sky`]: what the look has there.
    pub background: Background,
    /// How lenses that meet are evaluated; the picture is the same.
    pub technique: Technique,
    /// How translucent layers are laid one over the other.
    pub transparency: Transparency,
    /// How far edges that a deformation bends may be from where they should be, pixels, > 0.
    pub chord_px: f64,
}

/// Where nobody says how far bent edges may be off, pixels.
pub const CHORD_PX: f64 = 0.25;

impl Default for Style {
    fn default() -> Self {
        Self {
            look: StyleLook::default(),
            base: BaseStyle::default(),
            effects: Vec::new(),
            background: Background::default(),
            technique: Technique::default(),
            transparency: Transparency::default(),
            chord_px: CHORD_PX,
        }
    }
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
    /// What moves along the trajectory of this name: [`Scene::place`] says where it is.
    On(String),
}

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Width and height, pixels, 1..=16384.
    pub size: [u32; 2],
    /// Samples per pixel, 1..=1024; `None`: [`DEFAULT_SAMPLES`].
    pub samples: Option<u32>,
    /// Where legends of thematic colours stand.
    pub legend: LegendPlace,
    /// A title, at the top left.
    pub title: Option<String>,
    /// A caption, at the bottom left; `\n` begins a line.
    pub caption: Option<String>,
    /// Size of the text (its em); `None`: by the size of the picture.
    pub text: Option<TextSize>,
    /// Dots per inch of the picture on paper, 10..=2400: what points are measured by, and what the file says. `None`: points are
    /// those of [`DEFAULT_DPI`], and the file says nothing.
    pub dpi: Option<f64>,
}

/// Dots per inch where a figure in points says none: the reference pixel of the web, 1/96 inch.
pub const DEFAULT_DPI: f64 = 96.0;

/// Points of an inch.
const POINTS_PER_INCH: f64 = 72.0;

/// Size of text, its em.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextSize {
    /// Pixels.
    Pixels(f64),
    /// Points, 1/72 inch each.
    Points(f64),
}

impl TextSize {
    /// What it may be, pixels.
    pub const RANGE_PX: std::ops::RangeInclusive<f64> = 6.0..=400.0;

    /// Pixels of a picture of so many dots per inch.
    pub fn px(self, dpi: f64) -> f64 {
        match self {
            Self::Pixels(px) => px,
            Self::Points(points) => points * dpi / POINTS_PER_INCH,
        }
    }
}

/// Samples per pixel where a figure says nothing: edges are smooth, and shadows soft.
pub const DEFAULT_SAMPLES: u32 = 16;

impl Figure {
    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.samples.unwrap_or(DEFAULT_SAMPLES)
    }

    /// The size of the text, pixels, where the scene gives it.
    pub fn text_px(&self) -> Option<f64> {
        self.text.map(|size| size.px(self.dpi.unwrap_or(DEFAULT_DPI)))
    }
}

impl Default for Figure {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            samples: None,
            legend: LegendPlace::default(),
            title: None,
            caption: None,
            text: None,
            dpi: None,
        }
    }
}

/// Where legends stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LegendPlace {
    /// Nowhere.
    #[default]
    None,
    /// Where there is most room, which is the bottom right: the title and the caption stand on the left.
    Auto,
    /// In a corner.
    Corner(Corner),
}

/// A corner of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Top left.
    TopLeft,
    /// Top right.
    TopRight,
    /// Bottom left.
    BottomLeft,
    /// Bottom right.
    BottomRight,
}

impl Corner {
    /// All of them, with the words that scene files have for them.
    pub const WORDS: [(&'static str, Self); 4] = [
        ("top-left", Self::TopLeft),
        ("top-right", Self::TopRight),
        ("bottom-left", Self::BottomLeft),
        ("bottom-right", Self::BottomRight),
    ];

    /// Whether it is a left one.
    pub fn is_left(self) -> bool {
        matches!(self, Self::TopLeft | Self::BottomLeft)
    }

    /// Whether it is a top one.
    pub fn is_top(self) -> bool {
        matches!(self, Self::TopLeft | Self::TopRight)
    }
}

impl LegendPlace {
    /// The word that scene files have for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Auto => "auto",
            Self::Corner(corner) => Corner::WORDS.iter().find(|(_, c)| *c == corner).map_or("auto", |(word, _)| word),
        }
    }

    /// The place that a word means.
    pub fn of_word(word: &str) -> Option<Self> {
        match word {
            "none" => Some(Self::None),
            "auto" => Some(Self::Auto),
            word => Corner::WORDS.iter().find(|(w, _)| *w == word).map(|(_, c)| Self::Corner(*c)),
        }
    }

    /// The corner, where there is a legend.
    pub fn corner(self) -> Option<Corner> {
        match self {
            Self::None => None,
            Self::Auto => Some(Corner::BottomRight),
            Self::Corner(corner) => Some(corner),
        }
    }
}
