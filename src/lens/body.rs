//! How lens bodies are drawn.

use crate::lens::kind::LensKind;

/// How a lens body is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LensBody {
    /// Not at all.
    None,
    /// A line around its silhouette, in the lens colour.
    #[default]
    Outline,
    /// Tinted glass, with a line around it.
    Shell,
    /// A glow around its silhouette.
    Halo,
}

impl LensBody {
    /// How lenses of a kind are drawn that say nothing of it. What is done to occluders is what tells of them; a line around what is opaque of
    /// it, and none around the rest, tells less.
    pub fn of_kind(kind: LensKind) -> Self {
        if kind == LensKind::Occlusion { Self::None } else { Self::Outline }
    }

    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 4] =
        [("outline", Self::Outline), ("shell", Self::Shell), ("halo", Self::Halo), ("none", Self::None)];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, body)| *body == self).map_or("none", |(word, _)| word)
    }
}
