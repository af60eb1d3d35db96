//! Lens tests: how it is decided where a place is with regard to a region.

use crate::{geom::shape::VolumeForm, shader::plan::form::Form};

/// How it is decided where a place is with regard to a region of a lens: a method, and the form where that matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LensTest {
    /// From the region's own numbers. Of what has no closed form, cheap for *inside* alone.
    Numbers(Form),
    /// *Inside* from its own numbers; *in front* and *behind* from a volumetric depth sprite.
    Sides(Form),
    /// By its volumetric depth sprite, stored as the depth target is.
    Sprite,
    /// By its volumetric depth sprite, whatever that is stored in.
    LayeredSprite,
    /// By a volumetric depth sprite that has its own eye.
    OwnSprite,
}

impl LensTest {
    /// From the numbers of a volume.
    pub const fn volume(form: VolumeForm) -> Self {
        Self::Numbers(Form::Volume(form))
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let with_sides = [Form::Volume(VolumeForm::Solid), Form::Combined].map(Self::Sides);
        Form::all().map(Self::Numbers).chain(with_sides).chain([Self::Sprite, Self::LayeredSprite, Self::OwnSprite])
    }

    /// Its number in WGSL: that of its form, where the region's own numbers are all.
    pub fn number(self) -> u32 {
        match self {
            Self::Numbers(form) => form.number(),
            Self::Sides(form) => 0x1000 + form.number(),
            Self::Sprite => 0x2000,
            Self::LayeredSprite => 0x2001,
            Self::OwnSprite => 0x2002,
        }
    }

    /// Its constant there.
    pub fn constant(self) -> String {
        match self {
            Self::Numbers(form) => form.constant(),
            Self::Sides(form) => form.constant() + "_SPRITE",
            Self::Sprite => "SPRITE".to_owned(),
            Self::LayeredSprite => "LAYERED_SPRITE".to_owned(),
            Self::OwnSprite => "OWN_SPRITE".to_owned(),
        }
    }

    /// The form whose numbers it reads.
    pub fn form(self) -> Option<Form> {
        match self {
            Self::Numbers(form) | Self::Sides(form) => Some(form),
            Self::Sprite | Self::LayeredSprite | Self::OwnSprite => None,
        }
    }

    /// The form that knows where rays enter and leave, where that is what it asks.
    pub fn spanned(self) -> Option<Form> {
        match self {
            Self::Numbers(form) => Some(form).filter(|form| form.has_span()),
            _ => None,
        }
    }

    /// Whether a volumetric depth sprite of the picture's eye alone says where a place is.
    pub fn is_sprite(self) -> bool {
        matches!(self, Self::Sprite | Self::LayeredSprite)
    }

    /// Whether a volumetric depth sprite tells the sides of what is not inside.
    pub fn has_sides(self) -> bool {
        matches!(self, Self::Sides(_))
    }

    /// Whether it says in closed form where rays are inside, and they leave it again.
    pub fn has_span(self) -> bool {
        matches!(self, Self::Numbers(form) if form.is_convex())
    }

    /// Whether it may read the faces of a solid.
    pub fn has_faces(self) -> bool {
        self.form().is_some_and(|form| form.is_solid() || form == Form::Combined)
    }

    /// Whether it reads the leaves of a combination.
    pub fn has_leaves(self) -> bool {
        self.form() == Some(Form::Combined)
    }
}
