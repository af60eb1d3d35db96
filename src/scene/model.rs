//! What a scene is made of.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use crate::{
    city::{
        Materials,
        change::{Between, CityChange},
        lifetime::Dating,
        load::Up,
        side_table::Join,
    },
    lens::{
        EffectUse, Handled, Lens,
        best_view::{Background, BaseStyle, StyleLook},
        epoch::{linked, moment_after},
    },
    scene::{
        animation::Animation,
        overlay::{Layout, Overlay},
        technique::Technique,
        trajectory::Trajectory,
        transparency::Transparency,
        volume::Volume,
    },
    time::Moment,
    view::Camera,
};

/// All of a scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// The city to load.
    pub city: CitySpec,
    /// The eye; `None`: a good first view is chosen.
    pub camera: Option<Camera>,
    /// Whether heights of the camera, and of its path in an animation, are metres above the ground ([`Scene::on_ground`]).
    pub camera_above_ground: bool,
    /// Light.
    pub sun: Sun,
    /// The moment that is shown, seconds: where what moves is.
    pub time_s: f64,
    /// The moment of the calendar that is shown: which objects are there; `None`: all are.
    pub moment: Option<Moment>,
    /// Time operators that make of it, one after the other, what shows below all lenses.
    pub time_steps: Vec<Handled>,
    /// How the context looks.
    pub style: Style,
    /// The ways of what moves.
    pub trajectories: Vec<Trajectory>,
    /// Fields that stand in the city.
    pub volumes: Vec<Volume>,
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

impl Scene {
    /// Whether it has neither a city nor a volume to show.
    pub fn is_empty(&self) -> bool {
        self.city.files.is_empty() && self.volumes.is_empty()
    }

    /// The time operators of a lens, or of the whole scene, with those of other lenses in place of links; none where links lead nowhere.
    pub fn steps_of(&self, lens: Option<usize>) -> Vec<Handled> {
        let own = lens.map_or(Some(&self.time_steps), |lens| Some(&self.lenses.get(lens)?.time));
        // Steps that do not fit are told where pictures are made.
        own.and_then(|own| linked(own, &self.lenses).ok()).unwrap_or_default()
    }

    /// The moment that shows outside all lenses; of several that show together the first.
    pub fn shown_moment(&self) -> Option<Moment> {
        moment_after(&self.steps_of(None), self.moment, self.time_s).unwrap_or(self.moment)
    }
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
    /// Which attributes say when its objects are there.
    pub dating: Dating,
    /// Side tables whose attributes its objects get.
    pub joins: Vec<Join>,
    /// Attributes that say what became of its objects.
    pub changes: Vec<CityChange>,
    /// Timetables by which its objects move.
    pub timetables: Vec<PathBuf>,
}

impl CitySpec {
    /// Whether another is the same city on the GPU: what only says when objects are there may differ.
    pub fn loads_as(&self, other: &Self) -> bool {
        // What became of objects between two times goes by when they are there.
        let is_dated = self.changes.iter().any(|change| matches!(change.between, Between::Moments(_)));
        let dating = if is_dated { &other.dating } else { &self.dating };
        *self == Self { dating: dating.clone(), ..other.clone() }
    }
}

impl Default for CitySpec {
    fn default() -> Self {
        Self {
            files: Vec::new(),
            lod: None,
            up: Up::default(),
            materials: Materials::Tamed,
            ground: true,
            dating: Dating::default(),
            joins: Vec::new(),
            changes: Vec::new(),
            timetables: Vec::new(),
        }
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
    /// When it shines: in place of `azimuth` and `elevation`.
    pub when: SunTime,
    /// Whether it stands elsewhere in time lenses: where it does at the moments that show there. Only at the scene's own moment.
    pub in_lenses: bool,
    /// Where on the earth, degrees north and east; `None`: where the city's reference system says.
    pub place: Option<DVec2>,
    /// How far the city's clock is ahead of UTC, hours; `None`: whole hours by its longitude.
    pub utc_offset_h: Option<f64>,
}

/// When the sun of a scene shines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SunTime {
    /// It stands where the scene says.
    #[default]
    Never,
    /// At a date and an hour of the city's clock.
    At(Moment),
    /// At the scene's own moment.
    Scene,
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
            when: SunTime::Never,
            in_lenses: false,
            place: None,
            utc_offset_h: None,
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
    /// Whether walls without textures have storeys and windows.
    pub facades: bool,
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
            facades: false,
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
    /// A point so many metres above the ground, which [`Scene::on_ground`] makes one of the model.
    AboveGround(DVec3),
    /// What moves along the trajectory of this name: [`Scene::place`] says where it is.
    On(String),
}

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Width and height, pixels, 1..=16384, where there is no `paper`; of a column, its proportions. [`Self::pixels`] is what is drawn.
    pub size: [u32; 2],
    /// Its size on paper; `None`: it has one in pixels.
    pub paper: Option<Paper>,
    /// Samples per pixel, 1..=1024; `None`: [`DEFAULT_SAMPLES`].
    pub samples: Option<u32>,
    /// Where legends of thematic colours stand; of itself at the bottom right.
    pub legend: PiecePlace,
    /// A title.
    pub title: Option<String>,
    /// Where it stands; of itself at the top left.
    pub title_at: PiecePlace,
    /// A caption; `\n` begins a line.
    pub caption: Option<String>,
    /// Where it stands; of itself at the bottom left.
    pub caption_at: PiecePlace,
    /// Where a scale bar stands; in perspective, where the length that it shows lies.
    pub scale_bar: PiecePlace,
    /// Whether time lenses say which moment shows in them.
    pub time_labels: bool,
    /// Where an arrow stands that points to the north.
    pub north_arrow: PiecePlace,
    /// Size of the text (its em); `None`: [`PAPER_TEXT`] where there is a `paper`; else by the size of the picture.
    pub text: Option<TextSize>,
    /// Dots per inch of the picture on paper, 10..=2400: what points are measured by, and what the file says. `None`: [`PAPER_DPI`] where
    /// there is a `paper`; else points are those of [`DEFAULT_DPI`], and the file says nothing.
    pub dpi: Option<f64>,
    /// How many times as wide and high it is drawn as it says itself, > 0: 1 of all but what a window shows ([`Scene::sized`]). No file has it.
    pub scale: f64,
}

/// The size of a figure on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paper {
    /// Width and height, millimetres.
    Millimetres([f64; 2]),
    /// As wide as a column, with the proportions of the figure's `size`.
    Column(Column),
}

/// A column of a journal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// One of two on a page.
    Single,
    /// Both.
    Double,
}

impl Column {
    /// All of them, with the words that scene files have for them.
    pub const WORDS: [(&'static str, Self); 2] = [("single", Self::Single), ("double", Self::Double)];

    /// How wide it is, millimetres.
    pub fn width_mm(self) -> f64 {
        match self {
            Self::Single => 85.0,
            Self::Double => 175.0,
        }
    }
}

/// Dots per inch of a figure with a size on paper where it says none.
pub const PAPER_DPI: f64 = 300.0;

/// Size of the text of a figure with a size on paper where it says none: what journals ask for at least.
pub const PAPER_TEXT: TextSize = TextSize::Points(7.0);

/// Millimetres of an inch.
pub const MM_PER_INCH: f64 = 25.4;

/// Dots per inch where a figure in points says none: the reference pixel of the web, 1/96 inch.
pub const DEFAULT_DPI: f64 = 96.0;

/// Points of an inch.
pub const POINTS_PER_INCH: f64 = 72.0;

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

    /// Width and height of the picture, pixels. 1..=16384 in a scene that a file has; whoever changes its paper or its dots bounds them.
    pub fn pixels(&self) -> [u32; 2] {
        let dots = |mm: f64| (mm / MM_PER_INCH * self.dots()).round().clamp(0.0, f64::from(u32::MAX)) as u32;
        match self.paper {
            None => self.size,
            Some(Paper::Millimetres(size)) => size.map(dots),
            Some(Paper::Column(column)) => {
                let [w, h] = self.size.map(f64::from);
                [1.0, h / w].map(|share| dots(column.width_mm() * share))
            }
        }
    }

    /// Gives it a size in pixels, in place of one on paper; its dots per inch stay.
    pub fn set_pixels(&mut self, size: [u32; 2]) {
        self.dpi = self.dpi_of_file();
        (self.size, self.paper) = (size, None);
    }

    /// The dots per inch that its file says: none where it has a size in pixels and nothing else is said.
    pub fn dpi_of_file(&self) -> Option<f64> {
        self.dpi.or(self.paper.map(|_| PAPER_DPI))
    }

    /// Dots per inch, which points are measured by.
    pub fn dots(&self) -> f64 {
        self.dpi_of_file().unwrap_or(DEFAULT_DPI)
    }

    /// Pixels of a point of it as it is drawn, 1/72 inch: by its dots per inch; where it says none, a point of a picture up to 1280 × 720 is 4/3 pixels, and of a
    /// larger one as much larger, so that lines keep their share of it as text does.
    pub fn point_px(&self) -> f64 {
        let [w, h] = self.pixels().map(f64::from);
        let larger = (w / 1280.0).min(h / 720.0).max(1.0);
        self.scale * self.dpi_of_file().unwrap_or(DEFAULT_DPI * larger) / POINTS_PER_INCH
    }

    /// The size of the text, pixels, where the scene gives it, or a size on paper.
    pub fn text_px(&self) -> Option<f64> {
        let [least, most] = [*TextSize::RANGE_PX.start(), *TextSize::RANGE_PX.end()];
        let of_paper = self.paper.map(|_| PAPER_TEXT.px(self.dots()).clamp(least, most));
        self.text.map(|size| size.px(self.dots())).or(of_paper)
    }
}

impl Default for Figure {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            paper: None,
            samples: None,
            legend: PiecePlace::default(),
            title: None,
            title_at: PiecePlace::Auto,
            caption: None,
            caption_at: PiecePlace::Auto,
            scale_bar: PiecePlace::None,
            time_labels: true,
            north_arrow: PiecePlace::None,
            text: None,
            dpi: None,
            scale: 1.0,
        }
    }
}

/// Where a piece of a figure stands: its title, its caption, its legends, its scale bar, its north arrow.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum PiecePlace {
    /// Nowhere.
    #[default]
    None,
    /// Where the program finds it a good place.
    Auto,
    /// In a corner, or at the middle of a side.
    Anchor(Anchor),
    /// With its middle here, shares of the picture's width and height from the top left, 0 to 1.
    At([f64; 2]),
}

/// A corner of the picture, or the middle of one of its sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Top left.
    TopLeft,
    /// Top right.
    TopRight,
    /// Bottom left.
    BottomLeft,
    /// Bottom right.
    BottomRight,
    /// The middle of the upper side.
    Top,
    /// The middle of the lower side.
    Bottom,
    /// The middle of the left side.
    Left,
    /// The middle of the right side.
    Right,
}

impl Anchor {
    /// All of them, with the words that scene files have for them.
    pub const WORDS: [(&'static str, Self); 8] = [
        ("top-left", Self::TopLeft),
        ("top-right", Self::TopRight),
        ("bottom-left", Self::BottomLeft),
        ("bottom-right", Self::BottomRight),
        ("top", Self::Top),
        ("bottom", Self::Bottom),
        ("left", Self::Left),
        ("right", Self::Right),
    ];

    /// Where it is, shares of the picture's width and height from the top left.
    pub fn share(self) -> [f32; 2] {
        let x = match self {
            Self::TopLeft | Self::BottomLeft | Self::Left => 0.0,
            Self::Top | Self::Bottom => 0.5,
            Self::TopRight | Self::BottomRight | Self::Right => 1.0,
        };
        let y = match self {
            Self::TopLeft | Self::TopRight | Self::Top => 0.0,
            Self::Left | Self::Right => 0.5,
            Self::BottomLeft | Self::BottomRight | Self::Bottom => 1.0,
        };
        [x, y]
    }
}

impl PiecePlace {
    /// The word that scene files have for it; `None`: they have a list of two numbers.
    pub fn word(self) -> Option<&'static str> {
        match self {
            Self::None => Some("none"),
            Self::Auto => Some("auto"),
            Self::Anchor(anchor) => Anchor::WORDS.iter().find(|(_, own)| *own == anchor).map(|(word, _)| *word),
            Self::At(_) => None,
        }
    }

    /// The place that a word means.
    pub fn of_word(word: &str) -> Option<Self> {
        match word {
            "none" => Some(Self::None),
            "auto" => Some(Self::Auto),
            word => Anchor::WORDS.iter().find(|(w, _)| *w == word).map(|(_, anchor)| Self::Anchor(*anchor)),
        }
    }

    /// Whether the piece is wanted.
    pub fn is_some(self) -> bool {
        self != Self::None
    }
}
