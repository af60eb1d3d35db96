//! Contents of lenses: what a lens shows in place of what is below it.

use crate::shader::plan::step::ClassTest;

/// The content that a lens of a plan shows in place of what is below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanContent {
    /// Index into [`crate::shader::Plan::lenses`].
    pub lens: u32,
    /// On which of its classes.
    pub class: ClassTest,
    /// Number of the city that it shows, from 1; less than [`MOST_CITIES`].
    pub city: u32,
    /// How it is combined with what is below.
    pub clip: Clip,
    /// Whether terrain stays as it is below.
    pub keeps_terrain: bool,
}

/// Cities of a picture, the scene's own included: bits of a word.
pub const MOST_CITIES: u32 = 32;

/// How the content of a lens is combined with what is shown below, the context included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Clip {
    /// It is clipped: the topmost content shows.
    #[default]
    Order,
    /// It stays, and the content is added.
    Merge,
    /// Nothing shows where a lens below has another content, neither; else as `Order`.
    Discard,
}

impl Clip {
    /// All, in the order of the uber back end's numbers.
    pub const ALL: [Self; 3] = [Self::Order, Self::Merge, Self::Discard];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::Merge => "merge",
            Self::Discard => "discard",
        }
    }

    /// The number that the uber back end knows it by.
    pub fn number(self) -> u32 {
        Self::ALL.iter().position(|c| *c == self).unwrap_or(0) as u32
    }
}
