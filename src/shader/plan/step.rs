//! Steps of a plan: an effect, where it acts, and how it is laid over what is below.

use crate::shader::effect::{definition::EffectDefinition, prototype::EffectKind};

/// One use of an effect.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    /// Index into [`crate::shader::effect::handlers`].
    pub effect: u32,
    /// Where it acts.
    pub scope: Scope,
    /// Its first `vec4f` of the parameters.
    pub parameters: u32,
    /// How it is laid over what is below it; its weight follows its parameters. `None`: it replaces that.
    pub blend: Option<Blend>,
}

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scope {
    /// All of the picture.
    Everywhere,
    /// One class of a lens: index into [`crate::shader::Plan::lenses`].
    Lens(u32, ClassTest),
}

/// A class, as `lib/lens.wgsl` tests it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClassTest {
    /// D_F ≤ D < D_B.
    Inside,
    /// D < D_F.
    Front,
    /// D ≥ D_B.
    Behind,
    /// The ray misses the lens, or D is between two of its volumes.
    Rest,
}

impl ClassTest {
    /// All of them, in the order of the uber back end's numbers, which begin with 1.
    pub const ALL: [Self; 4] = [Self::Inside, Self::Front, Self::Behind, Self::Rest];

    /// The function that tests it.
    pub fn function(self) -> &'static str {
        match self {
            Self::Inside => "is_inside",
            Self::Front => "is_in_front",
            Self::Behind => "is_behind",
            Self::Rest => "is_rest",
        }
    }

    /// The function that says how much of it a place with a degree of interest has (`lib/border.wgsl`).
    pub fn share(self) -> &'static str {
        match self {
            Self::Inside => "share_inside",
            Self::Front => "share_front",
            Self::Behind => "share_behind",
            Self::Rest => "share_rest",
        }
    }
}

/// How a channel is laid over what is below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blend {
    /// In its place; with a weight below 1: as paint.
    Replace,
    /// The sum.
    Add,
    /// The difference, at least 0.
    Subtract,
    /// As a filter.
    Multiply,
    /// As light.
    Screen,
    /// A filter where it is dark below, light where it is light.
    Overlay,
}

impl Blend {
    /// All, in the order of the uber back end's numbers, which begin with 1.
    pub const ALL: [Self; 6] = [Self::Replace, Self::Add, Self::Subtract, Self::Multiply, Self::Screen, Self::Overlay];

    /// All words that name one.
    pub const WORDS: [&str; 7] = ["replace", "add", "subtract", "multiply", "screen", "overlay", "alpha"];

    /// The number that `lib/blend.wgsl` knows it by.
    pub fn number(self) -> u32 {
        1 + Self::ALL.iter().position(|b| *b == self).unwrap_or(0) as u32
    }

    /// The mode that a word names.
    pub fn parse(word: &str) -> Option<Self> {
        let word = if word == "alpha" { "replace" } else { word };
        Self::ALL.into_iter().find(|b| b.word() == word)
    }

    /// Its word in scene files; `alpha` is another for `replace`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Replace => "replace",
            Self::Add => "add",
            Self::Subtract => "subtract",
            Self::Multiply => "multiply",
            Self::Screen => "screen",
            Self::Overlay => "overlay",
        }
    }
}

impl Step {
    /// Where its weight stands, if it is blended.
    pub fn weight(&self, handler: &EffectDefinition) -> Option<u32> {
        self.blend.map(|_| self.parameters + handler.slots() + u32::from(handler.kind == EffectKind::Filter))
    }

    /// The slot of a filter that holds the number of its image.
    pub fn image(&self, handler: &EffectDefinition) -> u32 {
        self.parameters + handler.slots()
    }

    /// The slot after its last one.
    pub(super) fn end(&self, handler: &EffectDefinition) -> u32 {
        let is_filter = handler.kind == EffectKind::Filter;
        self.parameters + handler.slots() + u32::from(is_filter) + u32::from(self.blend.is_some())
    }

    /// Whether nothing of what is below it is left where it acts.
    pub fn replaces(&self, handler: &EffectDefinition) -> bool {
        self.blend.is_none() && !handler.reads_below
    }
}

/// The number that the uber back end knows a scope by: 0 is everywhere.
pub fn scope_number(scope: Scope) -> u32 {
    match scope {
        Scope::Everywhere => 0,
        Scope::Lens(_, class) => 1 + ClassTest::ALL.iter().position(|c| *c == class).unwrap_or(0) as u32,
    }
}
