//! What keys of scene files take, in words and numbers: the checks, the messages, the docs and the JSON schema go by it.

use crate::{
    lens::{Rendering, ramp},
    shader::effect::ParameterKind,
};

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A whole number within the closed range.
    Integer {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// A finite number within the closed range.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// `true` or `false`.
    Boolean,
    /// Text that is not empty.
    Text,
    /// Texts that are not empty.
    Texts,
    /// One of `now`; those of `later` are known but not available yet.
    Word {
        /// Words of this version.
        now: &'static [&'static str],
        /// Words of later ones.
        later: &'static [&'static str],
    },
    /// `[x, y, z]`, each within ± [`FAR_M`].
    Point,
    /// `[x, y, z]`, each 0 to [`FAR_M`].
    Lengths,
    /// `[x, y, z]`, each within ± [`FAR_M`], of which one is not 0.
    Direction,
    /// `[yaw, pitch, roll]` in degrees, each within ±360.
    Angles,
    /// At least so many points.
    Points(usize),
    /// `[x, y]`, each within ± [`FAR_M`].
    PlanPoint,
    /// `[x, y]`, each 0 to [`FAR_M`].
    PlanLengths,
    /// `[x, y]`, each 0 to 1: shares of a picture's width and height.
    PicturePlace,
    /// One of some words, or a [`Kind::PicturePlace`].
    WordOrPlace(&'static [&'static str]),
    /// At least so many points `[x, y]`.
    PlanPoints(usize),
    /// Lists of at least three points `[x, y]`.
    Rings,
    /// At least so many planes `[x, y, z, d]`.
    Planes(usize),
    /// At least so many seconds, each 0 or more and later than the one before.
    Times(usize),
    /// `"#rrggbb"` or `[r, g, b]`.
    Color,
    /// `"sky"` or a colour.
    Background,
    /// A level of detail, `"2"` or `"1.3"`.
    Lod,
    /// `[width, height]` in pixels.
    Size,
    /// `[width, height]` in millimetres.
    PaperSize,
    /// A table.
    Table(&'static Table),
    /// Tables, `[[key]]`.
    Tables(&'static Table),
    /// One shape: a table of [`super::shape_keys::SHAPES`].
    Shape,
    /// Shapes.
    Shapes,
    /// Names of effects, or tables `{ effect = NAME, ... }`.
    Effects,
    /// A number, or a list of numbers, or of such lists.
    Numbers,
    /// A text, or texts.
    Names,
    /// Shares, 0 to 1, at equal steps of a ramp.
    Shares,
    /// Colours `"#rrggbb"` at equal steps of a ramp.
    Colors,
    /// A detection test: a table of [`super::test_keys::TESTS`].
    Test,
    /// An eye of its own: a table of [`super::best_view::VIEWS`].
    View,
    /// Detection tests.
    Tests,
    /// A moment of the calendar, as a text or as a year.
    Moment,
    /// Time operators: a list of tables `{ op = NAME, ... }`.
    Operators,
    /// Steps of a deformation: tables of [`super::deformation::STEPS`].
    Steps,
    /// A user's handler: a table `{ kind = NAME, ... }`.
    Handler,
    /// A word of [`crate::lens::rendering::ROWS`], or effects.
    Rendering,
    /// One of the first words, or a table that says more.
    WordOrTable(&'static [&'static str], &'static Table),
}

/// Farthest a coordinate may lie from the origin, metres; beyond it f64 is coarser than a micrometre.
pub const FAR_M: f64 = 1e9;

/// One key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds without it; empty: it must be given.
    pub default: &'static str,
    /// Unit, or empty.
    pub unit: &'static str,
    /// What it means.
    pub doc: &'static str,
    /// A good value, as TOML.
    pub example: &'static str,
}

/// A table of keys.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Its name as messages and docs give it.
    pub name: &'static str,
    /// What it is for.
    pub doc: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

pub(in crate::figure) const fn key(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> Key {
    Key { name, kind, default, unit, doc, example }
}

/// Text in points.
pub const TEXT_PT: Kind = Kind::Number { min: 1.0, max: 400.0 };
/// Dots per inch.
pub const DPI: Kind = Kind::Number { min: 10.0, max: 2400.0 };

/// Classes of an effect's use.
pub const CLASSES: &[&str] = &["inside", "front", "behind", "rest"];

impl Kind {
    /// What it takes, as people read it.
    pub fn describe(&self) -> String {
        match self {
            Self::Integer { min, max } if min == max => format!("{min}"),
            Self::Integer { min, max } => format!("a whole number {min} to {max}"),
            Self::Number { min, max } if *min == f64::MIN && *max == f64::MAX => "a finite number".into(),
            Self::Number { min, max } if *min <= -FAR_M && *max >= FAR_M => format!("a number from {min:e} to {max:e}"),
            Self::Number { min, max } if *max >= FAR_M => format!("a number ≥ {min}"),
            Self::Number { min, max } => format!("a number {min} to {max}"),
            Self::Boolean => "true or false".into(),
            Self::Text => "a text that is not empty".into(),
            Self::Texts => "a list of texts that are not empty".into(),
            Self::Word { now, .. } => now.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(" or "),
            Self::Point => format!("[x, y, z], three numbers from {:e} to {FAR_M:e}", -FAR_M),
            Self::Lengths => format!("[x, y, z], three numbers from 0 to {FAR_M:e}"),
            Self::Direction => format!("{}, not all 0", Self::Point.describe()),
            Self::Angles => "[yaw, pitch, roll], three numbers -360 to 360".into(),
            Self::Points(least) => format!("a list of at least {least} points [x, y, z]"),
            Self::PlanPoint => format!("[x, y], two numbers from {:e} to {FAR_M:e}", -FAR_M),
            Self::PicturePlace => "[x, y], two numbers 0 to 1".into(),
            Self::WordOrPlace(words) => {
                let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                format!("{}, or {}", words.join(" or "), Self::PicturePlace.describe())
            }
            Self::PlanLengths => format!("[width, height], two numbers from 0 to {FAR_M:e}"),
            Self::PlanPoints(least) => format!("a list of at least {least} points [x, y]"),
            Self::Rings => "a list of rings, each a list of at least 3 points [x, y]".into(),
            Self::Planes(least) => format!("a list of at least {least} planes [x, y, z, d]"),
            Self::Times(least) => {
                format!("a list of at least {least} times, 0 or more, each later than the one before")
            }
            Self::Color => "a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Background => "\"sky\" or a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Lod => "a level of detail like \"2\" or \"1.3\"".into(),
            Self::Size => "[width, height], two whole numbers 1 to 16384".into(),
            Self::PaperSize => "[width, height], two numbers 0.1 to 10000".into(),
            Self::Table(_) => "a table".into(),
            Self::Tables(_) => "a list of tables".into(),
            Self::Shape | Self::Handler => "a table { kind = ..., ... }".into(),
            Self::Shapes => "a list of at least one shape".into(),
            Self::Numbers => "a number, or a list of numbers".into(),
            Self::Effects => "a list of effects: names or tables { effect = NAME, ... }".into(),
            Self::Names => "a text that is not empty, or a list of at least one such text".into(),
            Self::View => "a table { kind = ..., ... }".into(),
            Self::Test => "a table { kind = ..., ... }, { any = [...] }, { all = [...] } or { not = ... }".into(),
            Self::Shares => ParameterKind::Shares.describe(),
            Self::Colors => ParameterKind::Colors.describe(),
            Self::Tests => "a list of at least one test".into(),
            Self::Moment => ParameterKind::Moment.describe(),
            Self::Operators => "a list of at least one step { op = ..., ... }".into(),
            Self::Steps => "a list of at least one step { kind = ..., ... }".into(),
            Self::Rendering => {
                let words: Vec<String> = Rendering::words().map(|word| format!("\"{word}\"")).collect();
                format!(
                    "{}, a table {{ as = ..., ... }}, a list of such cases, or a list of effects",
                    words.join(" or ")
                )
            }
            Self::WordOrTable(words, table) => {
                let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                let keys: Vec<String> = names(table).map(|name| format!("{name} = ...")).collect();
                format!("{}, or a table {{ {} }}", words.join(" or "), keys.join(", "))
            }
        }
    }
}

/// The names of a table's keys.
pub fn names(table: &Table) -> impl Iterator<Item = &'static str> + use<> {
    table.keys.iter().map(|k| k.name)
}

/// Ramp names, for the docs.
pub const RAMPS: &[&str] = ramp::NAMES;
