//! A scene: plain data that says what to look at, from where, through which lenses.
//!
//! Everything is in model coordinates, metres and radians; edits are commands.

pub mod above_ground;
pub mod anchor;
pub mod animation;
pub mod check;
pub mod command;
pub mod drawn;
pub mod look;
pub mod model;
pub mod overlay;
pub mod sized;
pub mod technique;
pub mod trajectory;
pub mod transparency;
pub mod volume;

pub use crate::lens::best_view::{Background, BaseStyle, StyleLook};
pub use animation::Animation;
pub use check::{SceneProblem, check_against};
pub use command::{Command, History};
pub use drawn::Drawn;
pub use look::SkyLight;
pub use model::{
    Anchor, CHORD_PX, CitySpec, Column, DEFAULT_DPI, DEFAULT_SAMPLES, Figure, MM_PER_INCH, PAPER_DPI, PAPER_TEXT,
    POINTS_PER_INCH, Paper, PiecePlace, Poi, PoiPlace, Scene, Style, Sun, SunTime, TextSize,
};
pub use overlay::{Layout, Overlay};
pub use technique::Technique;
pub use trajectory::{Moving, Trajectory};
pub use transparency::Transparency;
pub use volume::Volume;
