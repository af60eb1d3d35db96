//! Kinds of lenses.

/// Kinds of lenses this version has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LensKind {
    /// Restyles what is in it.
    #[default]
    Color,
    /// Shows something else in it.
    Content,
    /// Draws what hides a point of interest so that it can be seen.
    Occlusion,
    /// Moves what is in it.
    Deformation,
    /// Shows an image or a text.
    Annotation,
    /// Shows the city from an eye of its own.
    BestView,
    /// Shows a map of what lies around the main eye.
    MapView,
    /// Shows a small model of a place that can be turned.
    Worldlet,
    /// Shows another place in a region of the picture.
    SeeThrough,
    /// Shows another place that one can go to.
    Portal,
}

impl LensKind {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 10] = [
        ("color", Self::Color),
        ("content", Self::Content),
        ("occlusion", Self::Occlusion),
        ("deformation", Self::Deformation),
        ("annotation", Self::Annotation),
        ("best-view", Self::BestView),
        ("map-view", Self::MapView),
        ("worldlet", Self::Worldlet),
        ("see-through", Self::SeeThrough),
        ("portal", Self::Portal),
    ];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// The kind with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| *w == word).map(|(_, kind)| *kind)
    }

    /// Whether its lenses have an overlay in place of a focus area (Trapp §3.4).
    pub fn has_overlay(self) -> bool {
        !matches!(self, Self::Color | Self::Content | Self::Occlusion | Self::Deformation)
    }
}
