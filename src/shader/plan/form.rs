//! Forms of regions: each decides by itself what is inside.

use crate::geom::shape::{Extent, VolumeForm};

/// Forms of regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Form {
    /// A volume.
    Volume(VolumeForm),
    /// The object that a place belongs to.
    Members,
    /// The same, where objects come or go.
    FadingMembers,
    /// The leaves of a combination.
    Combined,
    /// A user's region test: the number of its handler.
    Own(u32),
}

impl Form {
    /// All of them but users'.
    pub fn all() -> impl Iterator<Item = Self> {
        VolumeForm::ALL.iter().map(|form| Self::Volume(*form)).chain([
            Self::Members,
            Self::FadingMembers,
            Self::Combined,
        ])
    }

    /// Its number in WGSL: those of volumes come first.
    pub fn number(self) -> u32 {
        match self {
            Self::Volume(form) => form as u32,
            Self::Members => 0x100,
            Self::FadingMembers => 0x101,
            Self::Combined => 0x102,
            Self::Own(handler) => 0x4000 + handler,
        }
    }

    /// Its constant there.
    pub fn constant(self) -> String {
        match self {
            Self::Volume(form) => form.name().to_uppercase(),
            Self::Members => "MEMBERS".to_owned(),
            Self::FadingMembers => "FADING_MEMBERS".to_owned(),
            Self::Combined => "COMBINED".to_owned(),
            Self::Own(handler) => format!("OWN_{handler}"),
        }
    }

    /// The volume, where WGSL says in closed form where rays are inside: by the file of its form.
    pub fn closed(self) -> Option<VolumeForm> {
        match self {
            Self::Volume(form) => Some(form).filter(|form| form.extent() != Extent::Faces),
            _ => None,
        }
    }

    /// Whether WGSL says where rays enter it first and leave it last: in closed form, or step by step.
    pub fn has_span(self) -> bool {
        self.closed().is_some() || matches!(self, Self::Own(_))
    }

    /// Whether it is a solid.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Volume(form) if form.extent() == Extent::Faces)
    }

    /// Whether rays are in it once, and leave it again.
    pub fn is_convex(self) -> bool {
        matches!(self, Self::Volume(form) if form.extent() == Extent::Convex)
    }
}
