//! Lenses of a plan: how they are tested, where they end softly, and how their bodies are drawn.

use crate::shader::plan::{form::Form, lens_test::LensTest};

/// `vec4f` that a body's parameters take: colour and opacity; width of the line or the glow in pixels.
pub const BODY_SLOTS: u32 = 2;

/// A lens of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PlanLens {
    /// Its bit in the masks.
    pub number: u32,
    /// How each of its volumes is tested; among the frame's volumes they follow those of the lenses before it.
    pub volumes: Vec<LensTest>,
    /// Forms of the leaves of its combinations, ascending, each once.
    pub leaves: Vec<Form>,
    /// How its body is drawn, if it is.
    pub body: Option<PlanBody>,
    /// Its soft border, if it has one.
    pub border: Option<PlanBorder>,
}

/// How the body of a lens is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanBody {
    /// As what.
    pub kind: BodyKind,
    /// Place of its parameters.
    pub parameters: u32,
}

/// Kinds of bodies of lenses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BodyKind {
    /// A line around its silhouette.
    Outline,
    /// Tinted glass, with such a line.
    Shell,
    /// A glow around its silhouette.
    Halo,
}

impl BodyKind {
    /// Its number in the invoker table.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// Whether it has a line around its silhouette.
    pub fn has_outline(self) -> bool {
        self != Self::Halo
    }
}

/// A soft border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanBorder {
    /// Place of its parameters.
    pub parameters: u32,
    /// Whether what cannot be had by halves is dithered.
    pub dithers: bool,
    /// Whether it is told by the distance along the ray.
    pub by_ray: bool,
}
