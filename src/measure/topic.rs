//! A topic: a name, and what it has drawn. One file each in [`crate::measure::topics`].

use std::{fmt, sync::Arc};

use serde::Serialize;

use crate::{
    measure::{light_by_rays::LightByRays, quantity::Quantity, stage::Stage},
    render::{
        composited::Composited,
        picture::{RenderError, Request},
    },
    scene::Scene,
};

/// A question about accuracy and time.
#[derive(Clone, Copy, Debug)]
pub struct Topic {
    /// As it is typed; also the name of its files.
    pub name: &'static str,
    /// The headline of its table and plot.
    pub title: &'static str,
    /// One sentence: what is varied, and what for.
    pub about: &'static str,
    /// Where what is varied comes from: author and section (docs/sources.md).
    pub sources: &'static [&'static str],
    /// The thing that every variant is compared with, in words that follow "the reference is".
    pub reference: &'static str,
    /// The knobs that are turned; a variant has one value for each.
    pub knobs: &'static [Knob],
    /// The quantity along x in the plot.
    pub x: Quantity,
    /// The quantities along y, one panel each; the first is the time.
    pub y: &'static [Quantity],
    /// The two figures, both better when smaller, that decide which variants are on the Pareto front.
    pub front: [Quantity; 2],
    /// Knobs that variants must agree in to be compared: a picture of more effects does not lose against one of fewer.
    pub alike: &'static [usize],
    /// The knobs that tell lines of the plot apart; without any, points stand alone.
    pub series: &'static [usize],
    /// A knob each of whose values has a panel of its own, with the first of `y`.
    pub panels: Option<usize>,
    /// A knob whose values stand beside the points of lines.
    pub notes: Option<usize>,
    /// With which power of a knob an error falls, where the table says it.
    pub slope: Option<Slope>,
    /// Whether every variant is started on a device of its own. Else nothing is known of its start-up, and its memory is what its
    /// targets and lists take.
    pub restarts: bool,
    /// Makes what is drawn.
    pub make: fn(&mut Stage<'_>) -> Result<Trial, RenderError>,
}

/// An error that falls with a knob, told for each line of the plot.
#[derive(Clone, Copy, Debug)]
pub struct Slope {
    /// The knob.
    pub knob: usize,
    /// The error.
    pub error: Quantity,
    /// Values up to this one say nothing of it.
    pub above: f64,
}

/// Something that can be turned.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Knob {
    /// Its name, a table's heading.
    pub name: &'static str,
    /// `px`, `m`; empty for counts and words.
    pub unit: &'static str,
}

/// A knob's value.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A count or a measure, in the knob's unit.
    Number(f64),
    /// A choice.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// A picture that can be drawn again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// The scene.
    pub scene: Scene,
    /// The request.
    pub request: Request,
    /// The scene of the frame before the timed one, where something moves.
    pub before: Option<Scene>,
    /// The scenes of the other frames that it takes, which are timed with it.
    pub also: Vec<Scene>,
}

/// What a picture should show, in f64.
#[derive(Clone, Debug)]
pub enum Exact {
    /// Translucent layers, over any background.
    Layers(Arc<Composited>),
    /// Light on clay.
    Light(Arc<LightByRays>),
}

/// One of the things that are compared.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The text beside its point in the plot: short, and unlike the others'.
    pub label: String,
    /// One value per knob of the topic, in their order.
    pub knobs: Vec<Value>,
    /// The picture that is drawn.
    pub shot: Shot,
    /// The picture that it is compared with; `None`: the trial's reference.
    pub reference: Option<Shot>,
    /// What is right in f64.
    pub exact: Option<Exact>,
    /// For a picture with one lens: whether each pixel is in it, where something better than the reference says so.
    pub mask: Option<Arc<Vec<bool>>>,
}

/// The pictures that a topic has drawn.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The frame whose time is 1.
    pub plain: Shot,
    /// The picture that is right.
    pub reference: Shot,
    /// The variants that are compared, in the order of the table.
    pub variants: Vec<Variant>,
}
