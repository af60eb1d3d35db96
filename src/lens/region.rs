//! Regions: where a lens acts (its focus areas).

use std::{path::PathBuf, sync::OnceLock};

use glam::{DQuat, DVec2, DVec3};

use crate::{
    city::CityModel,
    geom::{
        Shape, Volume,
        combination::Operation,
        shape::{Motion, Sightlines},
    },
    lens::{
        chosen::Choice,
        handled::Handled,
        occluders::Occluders,
        rendering::When,
        solids::{Place, ShownCity, Solids},
    },
};

/// A region: a focus area of a lens, as a scene gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// A volume given by its figures.
    Shape(Shape),
    /// What the faces of a file enclose, in any format that cities are read from.
    Mesh {
        /// The file.
        file: PathBuf,
        /// Where its origin is put, metres.
        at: DVec3,
        /// Turns its axes into the world's.
        rotation: DQuat,
        /// Metres per unit of the file, > 0.
        scale: f64,
    },
    /// What stands over a polygon.
    Prism {
        /// Its corners in plan, metres.
        points: Vec<DVec2>,
        /// Corners of its holes.
        holes: Vec<Vec<DVec2>>,
        /// Where it begins, metres.
        base: f64,
        /// How high it is, metres, ≥ 0.
        height: f64,
    },
    /// What stands over the light pixels of an image.
    Mask {
        /// The image: a pixel is in where it is opaque and at least as light as mid grey.
        image: PathBuf,
        /// South-west corner in plan, metres.
        corner: DVec2,
        /// Extent in plan, metres, ≥ 0.
        size: DVec2,
        /// Where it begins, metres.
        base: f64,
        /// How high it is, metres, ≥ 0.
        height: f64,
    },
    /// The light pixels of images that lie on each other.
    Mask3d {
        /// One per layer, bottom to top.
        images: Vec<PathBuf>,
        /// South-west corner, below, metres.
        corner: DVec3,
        /// Extent, metres, ≥ 0.
        size: DVec3,
    },
    /// What a saved depth sprite holds.
    Sprite {
        /// The file, as [`crate::lens::sprite_file`] has it.
        file: PathBuf,
    },
    /// What a user's handler says is inside, in a box.
    Own {
        /// The handler.
        used: Handled,
        /// The middle of the box, metres.
        center: DVec3,
        /// Its full edges, metres, ≥ 0.
        size: DVec3,
        /// Turns its axes into the world's.
        rotation: DQuat,
    },
    /// All that a lens that bends rays shows larger than without it.
    Magnified {
        /// The name of the lens.
        lens: String,
        /// How many times as large, at least, > 0.
        by: f64,
    },
    /// The union of the volumes of city objects.
    Objects(Choice),
    /// Everything that belongs to city objects, wherever it is.
    Thematic(Choice),
    /// Everything that belongs to the city objects that lie in some shapes, wherever it is.
    Enclosed {
        /// The shapes; at least one.
        parts: Vec<Region>,
        /// Only objects of which no corner is outside.
        whole: bool,
        /// Only objects of these types, as their files call them; parts are of the type that they are part of. Empty: all.
        types: Vec<String>,
    },
    /// Everything that belongs to the city objects that hide something, wherever it is.
    Occluders(Occluders),
    /// Of those the ones that the last of these holds of, and none before it; scenes draw with it, files have none.
    Case {
        /// The occluders that the case is of.
        of: Occluders,
        /// At least one.
        when: Vec<When>,
    },
    /// A boolean combination: the first part with the second, that with the third, and so on.
    Combined {
        /// How.
        how: Operation,
        /// At least one.
        parts: Vec<Region>,
    },
}

impl From<Shape> for Region {
    fn from(shape: Shape) -> Self {
        Self::Shape(shape)
    }
}

impl Region {
    /// What is wrong with its numbers: the key, and what would be right.
    pub fn check(&self) -> Option<(&'static str, String)> {
        let lengths: Vec<(&str, f64)> = match self {
            Self::Prism { height, .. } => vec![("height", *height)],
            Self::Mask { size, height, .. } => vec![("size", size.min_element()), ("height", *height)],
            Self::Mask3d { size, .. } => vec![("size", size.min_element())],
            Self::Mesh { scale, .. } if *scale <= 0.0 => return Some(("scale", format!("must be > 0, is {scale}"))),
            _ => Vec::new(),
        };
        lengths.into_iter().find(|(_, v)| *v < 0.0).map(|(key, v)| (key, format!("must be ≥ 0, is {v}")))
    }

    /// Whether it means objects as such, not places.
    pub fn is_by_object(&self) -> bool {
        matches!(self, Self::Thematic(_) | Self::Enclosed { .. } | Self::Occluders(_) | Self::Case { .. })
    }

    /// What of it scene files give as a shape: of what is intersected with occluders the rest, of occluders nothing.
    pub fn own_shape(&self) -> Option<&Self> {
        match self {
            Self::Occluders(_) | Self::Case { .. } => None,
            Self::Combined { parts, .. } if self.occluders().is_some() => parts.get(1),
            other => Some(other),
        }
    }

    /// [`Self::own_shape`], to change it.
    pub fn own_shape_mut(&mut self) -> Option<&mut Self> {
        match self {
            Self::Occluders(_) | Self::Case { .. } => None,
            Self::Combined { .. } if self.occluders().is_some() => match self {
                Self::Combined { parts, .. } => parts.get_mut(1),
                _ => None,
            },
            other => Some(other),
        }
    }

    /// The occluders that it is, or that its first part is.
    pub fn occluders(&self) -> Option<&Occluders> {
        match self {
            Self::Occluders(occluders) | Self::Case { of: occluders, .. } => Some(occluders),
            Self::Combined { parts, .. } => parts.first().and_then(Self::occluders),
            _ => None,
        }
    }

    /// Gives a lens another name where parts of it name it.
    pub fn rename_lens(&mut self, before: &str, name: &str) {
        match self {
            Self::Magnified { lens, .. } if lens == before => name.clone_into(lens),
            Self::Combined { parts, .. } | Self::Enclosed { parts, .. } => {
                parts.iter_mut().for_each(|part| part.rename_lens(before, name));
            }
            _ => {}
        }
    }

    /// Whether it, or a part that it is combined from, is such a one.
    pub fn any(&self, is_one: &dyn Fn(&Self) -> bool) -> bool {
        let in_parts = || matches!(self, Self::Combined { parts, .. } if parts.iter().any(|p| p.any(is_one)));
        is_one(self) || in_parts()
    }

    /// The volumes whose union it is, without a city ([`Solids::volumes`]): of city objects, depth sprites and combinations none; a flat one as
    /// seen along these sight lines.
    pub fn volumes_seen(&self, sight: &Sightlines) -> Result<Vec<Volume>, String> {
        let city = ShownCity { model: &CityModel::default(), geometries: &[], index: &OnceLock::new(), number: 0 };
        let place = Place { motion: Motion::NONE, sight: *sight };
        Solids::default().volumes(self, city, &place).map_err(|(_, message)| message)
    }

    /// [`Self::volumes_seen`] of what needs no eye.
    pub fn volumes(&self) -> Result<Vec<Volume>, String> {
        match self {
            Self::Shape(shape) => shape.volumes().map_err(|error| error.to_string()),
            _ => self.volumes_seen(&Sightlines::From(DVec3::ZERO)),
        }
    }

    /// Whether its figures say that it holds nothing: a length of 0.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Prism { height, .. } => *height <= 0.0,
            Self::Mask { size, height, .. } => size.min_element().min(*height) <= 0.0,
            Self::Mask3d { size, .. } | Self::Own { size, .. } => size.min_element() <= 0.0,
            _ => false,
        }
    }
}
