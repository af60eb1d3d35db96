//! Parameters of effects: what they take, and what holds where they are not given.

use crate::time::{Interval, Span, Unit};

/// Types of parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterKind {
    /// `true` or `false`; in WGSL a `bool`.
    Boolean,
    /// A number within the closed range; in WGSL an `f32`.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// Any text; not for WGSL.
    Text,
    /// One of these words; in WGSL a `u32`, and a constant `PARAMETER_WORD` for each.
    Word(Vec<String>),
    /// `"#rrggbb"` or `[r, g, b]`, sRGB 0..1; in WGSL a `vec3f`, linear.
    Color,
    /// Three finite numbers, `[x, y, z]`; in WGSL a `vec3f`.
    Vector,
    /// Finite numbers, ascending, at most [`MAX_LIST`]; not for WGSL.
    Numbers,
    /// Texts, at most [`MAX_LIST`]; not for WGSL.
    Texts,
    /// Shares, 0 to 1, at equal steps of a ramp, at most [`MAX_RAMP`]; in WGSL a `u32` for `share_on_ramp`.
    Shares,
    /// Colours, as [`Self::Color`], at equal steps of a ramp, at most [`MAX_RAMP`]; in WGSL a `u32` for `color_on_ramp`.
    Colors,
    /// A moment, as [`Interval`] reads it: its beginning; in WGSL a `Moment`. For epochs alone, as all that follow.
    Moment,
    /// A span of time, as [`Span`] reads it; in WGSL a `Duration`.
    Span,
    /// A unit that moments are rounded to, as [`Unit`] reads it; in WGSL a `Unit`.
    Unit,
    /// A time of day, `"14:30"`, less than 24 hours; in WGSL a `Duration` without months.
    Clock,
    /// Moments that show together, or spans, each as [`Self::Moment`] or [`Self::Span`], at most [`MAX_INSTANTS`]; in WGSL an `Instants`. For
    /// the program's own operators alone.
    Instants,
    /// Weights of instants: numbers above 0, at most [`MAX_INSTANTS`]; not for WGSL.
    Weights,
}

/// Moments that show together, at most.
pub const MAX_INSTANTS: usize = 64;
/// Longest list a parameter takes.
pub const MAX_LIST: usize = 256;
/// Steps of a ramp.
pub const MAX_RAMP: usize = 64;

impl ParameterKind {
    /// Its type in WGSL and how many floats it takes there; `None` for what only the host reads.
    pub fn in_shader(&self) -> Option<(&'static str, usize)> {
        match self {
            Self::Boolean => Some(("bool", 1)),
            Self::Number { .. } => Some(("f32", 1)),
            Self::Word(_) | Self::Shares | Self::Colors => Some(("u32", 1)),
            Self::Color | Self::Vector => Some(("vec3f", 3)),
            Self::Moment => Some(("Moment", 2)),
            Self::Span | Self::Clock => Some(("Duration", 3)),
            Self::Unit => Some(("Unit", 3)),
            Self::Instants => Some(("Instants", 3)),
            Self::Text | Self::Numbers | Self::Texts | Self::Weights => None,
        }
    }

    /// Its values in words.
    pub fn describe(&self) -> String {
        match self {
            Self::Boolean => "true or false".into(),
            Self::Number { min, max } if *min == f64::MIN && *max == f64::MAX => "a finite number".into(),
            Self::Number { min, max } => format!("a number {min} to {max}"),
            Self::Text => "a text".into(),
            Self::Word(words) => format!("one of {}", words.join(", ")),
            Self::Color => "a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Vector => "three numbers [x, y, z]".into(),
            Self::Numbers => format!("1 to {MAX_LIST} ascending numbers"),
            Self::Texts => format!("1 to {MAX_LIST} texts"),
            Self::Shares => format!("1 to {MAX_RAMP} numbers of 0 to 1"),
            Self::Colors => format!("1 to {MAX_RAMP} colours \"#rrggbb\""),
            Self::Moment => "a time: \"1890\", \"1890-05-03\" or \"1890-05-03T14:00\"".into(),
            Self::Span => "a span of time: \"10 years\", \"-6 months\", \"1 h 30 min\" or \"P10Y\"".into(),
            Self::Unit => "a unit of time: \"year\", \"10 years\", \"month\", \"day\" or \"15 min\"".into(),
            Self::Clock => "a time of day: \"14:30\"".into(),
            Self::Instants => {
                format!("1 to {MAX_INSTANTS} times, or spans of time: [\"1650\", \"1750\"] or [\"0 s\", \"-10 years\"]")
            }
            Self::Weights => format!("1 to {MAX_INSTANTS} numbers above 0"),
        }
    }

    /// Whether it is of time, in whole words.
    pub fn is_time(&self) -> bool {
        matches!(self, Self::Moment | Self::Span | Self::Unit | Self::Clock)
    }

    /// A text as WGSL reads it where it is of time.
    ///
    /// # Errors
    /// What would be right.
    pub fn words_of_time(&self, text: &str) -> Result<Vec<u32>, String> {
        match self {
            Self::Moment => {
                let moment = Interval::parse(text)?.begin;
                moment.map(|moment| moment.words().to_vec()).ok_or_else(|| format!("\"{text}\" has no beginning"))
            }
            Self::Span => Span::parse(text).map(|span| span.words().to_vec()),
            Self::Unit => Span::parse(text).and_then(Unit::of).map(|unit| unit.words().to_vec()),
            Self::Clock => Span::of_clock(text).map(|span| span.words().to_vec()),
            _ => Err(format!("must be {}", self.describe())),
        }
    }

    /// Whether WGSL reads it as a ramp.
    pub fn is_ramp(&self) -> bool {
        matches!(self, Self::Shares | Self::Colors)
    }
}

/// The value of a parameter that is not given.
#[derive(Clone, Debug, PartialEq)]
pub enum Fallback {
    /// The effect does nothing without it.
    Required,
    /// This value.
    Value(DefaultValue),
    /// A value that the host works out, in words.
    Words(String),
}

/// A parameter's default value.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(untagged)]
pub enum DefaultValue {
    /// Yes or no.
    Boolean(bool),
    /// A number.
    Number(f64),
    /// A word, or a colour as `"#rrggbb"`.
    Text(String),
    /// Shares.
    Numbers(Vec<f64>),
    /// Colours.
    Texts(Vec<String>),
}

/// One parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterDefinition {
    /// Its key.
    pub name: String,
    /// Its type.
    pub kind: ParameterKind,
    /// Its value where it is not given.
    pub fallback: Fallback,
    /// Unit, or empty.
    pub unit: String,
    /// Its meaning.
    pub doc: String,
}

impl ParameterDefinition {
    /// Whether the effect does nothing without it.
    pub fn is_required(&self) -> bool {
        self.fallback == Fallback::Required
    }

    /// Its value where it is not given, in words or as TOML; empty where it is required.
    pub fn default_text(&self) -> String {
        match &self.fallback {
            Fallback::Required => String::new(),
            Fallback::Words(words) => words.clone(),
            Fallback::Value(DefaultValue::Boolean(b)) => b.to_string(),
            Fallback::Value(DefaultValue::Number(n)) => n.to_string(),
            Fallback::Value(DefaultValue::Text(t)) => format!("\"{t}\""),
            Fallback::Value(DefaultValue::Numbers(n)) => format!("{n:?}"),
            Fallback::Value(DefaultValue::Texts(t)) => format!("{t:?}"),
        }
    }
}
