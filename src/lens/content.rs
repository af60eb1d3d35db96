//! What a lens shows in itself in place of what is below it: the city in another level of detail, another data set,
//! something made of its objects, or a part of it elsewhere, turned and scaled (object-level effects, Tiesel
//! §3.4.3, and the source box of Borst et al. 2007).

use std::path::PathBuf;

use glam::{DQuat, DVec3};

use crate::{
    city::{Lod, change::Became, derived::Derive},
    lens::{class::Class, handled::Handled},
    shader::Clip,
};

/// Own content of a lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Content {
    /// The files of another data set; none: the scene's own.
    pub files: Vec<PathBuf>,
    /// No level of detail finer than this, one that the data set has; `None`: the finest.
    pub lod: Option<Lod>,
    /// What its objects are shown as; `None`: as themselves. Terrain, roads, water and land use stay as they are below.
    pub derive: Option<Derive>,
    /// Which objects of an earlier state alone; `None`: all.
    pub only: Option<Only>,
    /// Where along the sight line it shows.
    pub class: Class,
    /// What becomes of what is below.
    pub clip: Clip,
    /// Whether terrain, roads, water and land use stay as they are below, and the content brings none.
    pub keep_terrain: bool,
    /// Where it is taken from and put to; `None`: it stands where it is.
    pub copied: Option<Copied>,
    /// A user's transform about the point that it is put to, after that; `None`: none.
    pub transform: Option<Handled>,
}

impl Default for Content {
    fn default() -> Self {
        Self {
            files: Vec::new(),
            lod: None,
            derive: None,
            only: None,
            class: Class::Inside,
            clip: Clip::Order,
            keep_terrain: false,
            copied: None,
            transform: None,
        }
    }
}

/// The objects of an earlier state of the city, in files, of which something became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Only {
    /// One of these.
    pub became: Vec<Became>,
    /// The attribute by which objects of both states are the same; `None`: their id.
    pub key: Option<String>,
}

/// Which city a content shows; contents of one city differ in where it shows and stands.
#[derive(Clone, Debug, PartialEq)]
pub struct ContentSource {
    /// As [`Content::files`].
    pub files: Vec<PathBuf>,
    /// As [`Content::lod`].
    pub lod: Option<Lod>,
    /// As [`Content::derive`].
    pub derive: Option<Derive>,
    /// As [`Content::only`].
    pub only: Option<Only>,
}

impl ContentSource {
    /// Whether it is the scene's own city as it is shown.
    pub fn is_shown_city(&self) -> bool {
        self.files.is_empty() && self.lod.is_none() && self.derive.is_none()
    }
}

impl Content {
    /// The city that it shows.
    pub fn source(&self) -> ContentSource {
        ContentSource { files: self.files.clone(), lod: self.lod, derive: self.derive, only: self.only.clone() }
    }

    /// Whether it stands elsewhere than its city.
    pub fn is_moved(&self) -> bool {
        self.copied.is_some() || self.transform.is_some()
    }

    /// Whether terrain, roads, water and land use stay as they are below.
    pub fn keeps_terrain(&self) -> bool {
        self.keep_terrain || self.derive.is_some() || self.only.is_some()
    }

    /// What becomes of what is below, unless something else is asked for: what is shown of an earlier state is shown beside it.
    pub fn usual_clip(&self) -> Clip {
        if self.only.is_some() { Clip::Merge } else { Clip::default() }
    }
}

/// A mapping from the model into the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Copied {
    /// The point that is taken, metres, and what is turned and scaled about; `None`: the one that it is put to.
    pub from: Option<DVec3>,
    /// Where that point is put, in the coordinates of the lens' shapes, metres; `None`: to the middle of the lens.
    pub to: Option<DVec3>,
    /// Turns it, along the model's axes.
    pub rotation: DQuat,
    /// Scales it, > 0.
    pub scale: f64,
}

impl Default for Copied {
    fn default() -> Self {
        Self { from: None, to: None, rotation: DQuat::IDENTITY, scale: 1.0 }
    }
}
