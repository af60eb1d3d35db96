//! Kinds of lenses, each with what only lenses of that kind have. A kind is a file and its line in the table below.

mod annotation;
mod best_view;
mod color;
mod content;
mod deformation;
mod feature;
mod fisheye;
mod magnifier;
mod map_view;
mod occlusion;
mod portal;
mod ray;
mod row;
mod sampling;
mod see_through;
mod time;
mod worldlet;

pub use annotation::Annotation;
pub use best_view::BestViewLens;
pub use color::ColorLens;
pub use content::ContentLens;
pub use deformation::Deformation;
pub use feature::FeatureLens;
pub use fisheye::FisheyeLens;
pub use magnifier::Magnifier;
pub use map_view::MapView;
pub use occlusion::Occlusion;
pub use portal::Portal;
pub use ray::OwnRayLens;
pub use row::{KindRow, OwnKind};
pub use sampling::SamplingLens;
pub use see_through::SeeThrough;
pub use time::TimeLens;
pub use worldlet::Worldlet;

use crate::lens::{best_view::BestView, content::Content, deform::Deform, ray::RayLens, rendering::Rendering};

/// The sum of the kinds, of a table of them.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident($own:ty),)+) => {
        /// Kinds of lenses this version has, each with what is its own.
        #[derive(Clone, Debug, PartialEq)]
        pub enum LensKind {
            $($(#[$doc])* $kind($own),)+
        }

        impl LensKind {
            /// The words of all in scene files.
            pub const WORDS: &[&str] = &[$(<$own>::ROW.word),+];

            /// The kind with this word, with nothing of its own given yet.
            pub fn of_word(word: &str) -> Option<Self> {
                match word {
                    $(_ if word == <$own>::ROW.word => Some(<$own>::empty().into()),)+
                    _ => None,
                }
            }

            /// What is said of the kind as such.
            pub fn row(&self) -> &'static KindRow {
                match self {
                    $(Self::$kind(_) => &<$own>::ROW,)+
                }
            }

            fn own(&self) -> &dyn Own {
                match self {
                    $(Self::$kind(own) => own,)+
                }
            }

            fn own_mut(&mut self) -> &mut dyn Own {
                match self {
                    $(Self::$kind(own) => own,)+
                }
            }
        }

        $(impl From<$own> for LensKind {
            fn from(own: $own) -> Self {
                Self::$kind(own)
            }
        })+
    };
}

use row::Own;

kinds! {
    /// Restyles what is in it.
    Color(ColorLens),
    /// Shows something else in it.
    Content(ContentLens),
    /// Draws what hides a point of interest so that it can be seen.
    Occlusion(Occlusion),
    /// Moves what is in it.
    Deformation(Deformation),
    /// Shows another moment in it.
    Time(TimeLens),
    /// Shows larger what lies behind its plane.
    Magnifier(Magnifier),
    /// Shows a feature larger.
    Feature(FeatureLens),
    /// Has more pixels for its middle.
    Sampling(SamplingLens),
    /// Shows more directions than the picture.
    Fisheye(FisheyeLens),
    /// Bends rays as a handler of its user says.
    Ray(OwnRayLens),
    /// Shows an image or a text.
    Annotation(Annotation),
    /// Shows the city from an eye of its own.
    BestView(BestViewLens),
    /// Shows a map of what lies around the main eye.
    MapView(MapView),
    /// Shows a small model of a place that can be turned.
    Worldlet(Worldlet),
    /// Shows another place in a region of the picture.
    SeeThrough(SeeThrough),
    /// Shows another place that one can go to.
    Portal(Portal),
}

impl Default for LensKind {
    fn default() -> Self {
        ColorLens::empty().into()
    }
}

impl LensKind {
    /// Its word in scene files.
    pub fn word(&self) -> &'static str {
        self.row().word
    }

    /// Whether its lenses have an overlay in place of a focus area.
    pub fn has_overlay(&self) -> bool {
        self.best_view().is_some()
    }

    /// What it shows in place of what is below it; `None`: it acts on that.
    pub fn content(&self) -> Option<&Content> {
        self.own().content()
    }

    /// As [`Self::content`], to be changed.
    pub fn content_mut(&mut self) -> Option<&mut Content> {
        self.own_mut().content_mut()
    }

    /// Gives it a content, or none; a kind that cannot have one stays as it is. A content lens without content is a colour lens.
    pub fn set_content(&mut self, content: Option<Content>) {
        match content {
            None if matches!(self, Self::Content(_)) => *self = Self::default(),
            content => self.own_mut().set_content(content),
        }
    }

    /// How the occluders of an occlusion lens are drawn.
    pub fn rendering(&self) -> Option<&Rendering> {
        self.own().rendering()
    }

    /// As [`Self::rendering`], to be changed.
    pub fn rendering_mut(&mut self) -> Option<&mut Rendering> {
        self.own_mut().rendering_mut()
    }

    /// What it does with space, if it is a deformation lens.
    pub fn deform(&self) -> Option<&Deform> {
        self.own().deform()
    }

    /// As [`Self::deform`], to be changed.
    pub fn deform_mut(&mut self) -> Option<&mut Deform> {
        self.own_mut().deform_mut()
    }

    /// How it bends rays, if it is a lens that does.
    pub fn ray(&self) -> Option<&RayLens> {
        self.own().ray()
    }

    /// As [`Self::ray`], to be changed.
    pub fn ray_mut(&mut self) -> Option<&mut RayLens> {
        self.own_mut().ray_mut()
    }

    /// What its overlay shows, if it has one.
    pub fn best_view(&self) -> Option<&BestView> {
        self.own().best_view()
    }

    /// As [`Self::best_view`], to be changed.
    pub fn best_view_mut(&mut self) -> Option<&mut BestView> {
        self.own_mut().best_view_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_of_one_kind_and_back() {
        for (i, word) in LensKind::WORDS.iter().enumerate() {
            assert!(!LensKind::WORDS[..i].contains(word), "{word}");
            assert_eq!(LensKind::of_word(word).unwrap().word(), *word);
        }
        assert_eq!(LensKind::of_word("glass"), None);
    }

    #[test]
    fn a_kind_has_what_is_its_own_and_nothing_else() {
        let given = |kind: &LensKind| {
            let parts =
                [kind.rendering().is_some(), kind.deform().is_some(), kind.best_view().is_some(), kind.ray().is_some()];
            (parts.iter().filter(|is| **is).count(), kind.content().is_some())
        };
        for word in LensKind::WORDS {
            let mut kind = LensKind::of_word(word).unwrap();
            let (parts, has_content) = given(&kind);
            assert!(parts <= 1, "{word}");
            assert_eq!(has_content, *word == "content", "{word}");
            kind.set_content(Some(Content::default()));
            assert_eq!(kind.content().is_some(), !kind.has_overlay() && kind.ray().is_none(), "{word}");
            kind.set_content(None);
            assert_eq!((given(&kind), kind.content()), ((parts, false), None), "{word}");
        }
    }
}
