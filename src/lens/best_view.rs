//! What best-view lenses show (Trapp §3.4.1): a picture of its own, placed over the main one and tied to points of interest.

use std::path::PathBuf;

use glam::DVec3;

use crate::{lens::effect_use::EffectUse, view::Camera};

/// Vertical field of view of local cameras that say nothing of it, radians.
pub const DEFAULT_FOV: f64 = 45_f64.to_radians();

/// The most that a fisheye magnifies the middle of a map: it is drawn as much larger on each side.
pub const MOST_MAGNIFIED: f64 = 4.0;

/// What a best-view lens shows, and of what.
#[derive(Clone, Debug, PartialEq)]
pub struct BestView {
    /// Names of the points of interest that it is tied to; the first of them is the one that a view is of.
    pub pois: Vec<String>,
    /// What is shown.
    pub depiction: Depiction,
    /// Names of the lenses that act in its view, best-view lenses among them: those become overlays of its overlay. `None`: all lenses of the
    /// scene that act in every view.
    pub lenses: Option<Vec<String>>,
    /// How its view looks; `None`: as the scene.
    pub look: Option<Look>,
}

/// What an overlay is a picture of.
#[derive(Clone, Debug, PartialEq)]
pub enum Depiction {
    /// An image of a file.
    Image(PathBuf),
    /// Text; `\n` begins a line.
    Text(String),
    /// The city, from an eye of its own.
    View(LocalView),
}

/// An eye of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum LocalView {
    /// All of the first point of interest, from `normal`, a direction from it; `None`: from where it is seen best.
    Best {
        /// From the object to the eye, not 0.
        normal: Option<DVec3>,
        /// Vertical field of view, radians.
        fov_y: f64,
        /// Whether what is beside its object is pale.
        highlight: bool,
    },
    /// The main eye, looked at from outside (multiple centres of projection).
    Mcop {
        /// From the main eye to this one, not 0.
        normal: DVec3,
        /// How far, metres.
        distance_m: f64,
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// From the main eye in another direction (single centre of projection).
    Scop {
        /// Where it looks, not 0.
        direction: DVec3,
        /// Whether `direction` is on the axes of the camera (x right, y up, z towards whoever looks) and not on the world's.
        of_camera: bool,
        /// Whether left and right are exchanged: a rear-view mirror.
        mirror: bool,
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// A map of what lies around the main eye.
    Map {
        /// What is at its top.
        mode: MapMode,
        /// Metres of ground from the lower to the upper border.
        height_m: f64,
        /// Fisheye: how many times larger its middle is than it would be without, 1..=[`MOST_MAGNIFIED`]; 1: none.
        magnification: f64,
        /// Lazy tracking: how far the main eye may be from the map's middle before the map follows, as a share of the way to its border, 0..1;
        /// 0: it always does.
        lazy: f64,
    },
    /// A small model that can be turned: the first point of interest and what is within `margin_m` of it, alone.
    Worldlet {
        /// Where it is looked at from: radians clockwise from north.
        azimuth: f64,
        /// And how far from above, radians.
        elevation: f64,
        /// How much around the object belongs to it, metres.
        margin_m: f64,
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// What moves with the first point of interest, followed from behind; behind one that does not move is the side of the main eye.
    Follow {
        /// How far behind it, in plan, metres.
        distance_m: f64,
        /// How far above it, metres.
        height_m: f64,
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// From the first point of interest, level, to where it goes; from one that does not move where the main eye looks.
    Onboard {
        /// Radians clockwise from there: π looks back.
        azimuth: f64,
        /// How far the eye is above it, metres.
        height_m: f64,
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// Any eye: a region of the picture that shows another place (Through-The-Lens).
    Camera {
        /// The eye.
        camera: Camera,
        /// Whether its heights are metres above the ground (`Scene::on_ground`).
        above_ground: bool,
    },
}

impl LocalView {
    /// Whether it is a view of a point of interest, which it cannot do without.
    pub fn is_of_poi(&self) -> bool {
        matches!(self, Self::Best { .. } | Self::Worldlet { .. } | Self::Follow { .. } | Self::Onboard { .. })
    }

    /// How much a fisheye magnifies its middle; 1: there is none.
    pub fn magnification(&self) -> f64 {
        match self {
            Self::Map { magnification, .. } => *magnification,
            _ => 1.0,
        }
    }
}

/// How a map is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MapMode {
    /// North is up.
    #[default]
    NorthUp,
    /// Where the main eye looks is up; a compass shows north.
    HeadUp,
    /// North is up; a symbol shows where the main eye looks.
    UserView,
}

impl MapMode {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 3] =
        [("north-up", Self::NorthUp), ("head-up", Self::HeadUp), ("user-view", Self::UserView)];
}

/// How a view looks, as far as views of one scene may differ.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Look {
    /// What it starts from.
    pub look: StyleLook,
    /// The colours surfaces start from.
    pub base: BaseStyle,
    /// Effects on everything outside (and under) the lenses, in order.
    pub effects: Vec<EffectUse>,
    /// What is behind the city.
    pub background: Background,
}

/// A look of a whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum StyleLook {
    /// Materials under sun and sky.
    #[default]
    Natural,
    /// A white model with fine lines, on white.
    Paper,
    /// Flat, quiet colours with cast shadows.
    Map,
    /// Moonlight, and the light of streets.
    Night,
    /// White lines on blue.
    Blueprint,
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
    /// What the look has there: by default a quiet sky.
    #[default]
    Sky,
    /// One colour, sRGB 0..1.
    Color([f32; 3]),
}

impl BestView {
    /// Its own eye, if what it shows is the city.
    pub fn view(&self) -> Option<&LocalView> {
        match &self.depiction {
            Depiction::View(view) => Some(view),
            _ => None,
        }
    }
}
