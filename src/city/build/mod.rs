//! From what loaders read to a [`CityModel`]: de-duplication, triangulation, tiles, planes.
//!
//! Loaders push objects, attributes, surfaces and polygons on integer lattices; [`ModelBuilder::finish`]
//! does the rest, in parallel and with the same result for any thread count.
//!
//! ```text
//! ids, links, attributes ─> objects
//! geometries, by object and LoD ─> jobs ─> repeats dropped, triangles, tiles (`job`, in parallel)
//!                                            └─> chunks, appended in order ─> planes numbered
//! ```

mod job;
pub mod lattice;
mod line;
mod links;
mod metric;
mod planes;
pub mod points;
pub mod raw;
mod repeats;
mod staging;
mod tiles;

pub use self::lattice::Lattice;
pub use self::points::{BAD_POINT, Points, Pool};
pub use self::raw::{Polygons, RawGeometry, RawObject};
use std::path::Path;

use glam::DVec3;

use self::staging::PackedStaging;
use crate::city::{
    build::raw::KeptObject,
    crs::{Frames, LocalFrame, UtmZone},
    memory::give_back,
    model::{Attribute, CityModel, CityObject, Source, StringId, Surface, SurfaceDetail},
    warning::WarningCode,
};

/// Gathers what loaders read.
#[derive(Debug, Default)]
pub struct ModelBuilder {
    /// The model so far; loaders fill `sources`, `crs`, `materials`, `textures`, `unknown`, `warnings` directly.
    pub model: CityModel,
    /// The metric frame of a city in degrees, once its first vertex is known.
    pub zone: Option<UtmZone>,
    /// The frame that earth-centred files are put in, once there is one.
    pub frame: Option<LocalFrame>,
    objects: Vec<KeptObject>,
    /// Kinds of objects, as `KeptObject::kind` counts them.
    kinds: Vec<Box<str>>,
    /// Attributes of the objects, in ranges.
    attributes: Vec<Attribute>,
    /// First object of each file.
    file_starts: Vec<u32>,
    staging: PackedStaging,
}

impl ModelBuilder {
    /// Starts a file: ids are resolved within it, and `source` is listed.
    pub fn begin_file(&mut self, source: Source) {
        self.file_starts.push(self.objects.len() as u32);
        self.model.sources.push(source);
    }

    /// Adds an object; returns its index in the whole city.
    pub fn add_object(&mut self, mut object: RawObject) -> u32 {
        let attributes = std::mem::take(&mut object.attributes);
        self.add_object_with(object, &attributes)
    }

    /// Adds an object whose attributes stand elsewhere, in place of its own.
    pub fn add_object_with(&mut self, object: RawObject, attributes: &[Attribute]) -> u32 {
        let RawObject { id, kind, class, parents, children, .. } = object;
        // A city has a handful of kinds, and neighbours in a file are mostly alike.
        let kind = self.kinds.iter().rposition(|known| **known == *kind).unwrap_or_else(|| {
            self.kinds.push(kind.into());
            self.kinds.len() - 1
        });
        let start = self.attributes.len() as u32;
        self.attributes.extend_from_slice(attributes);
        self.objects.push(KeptObject {
            id: id.into(),
            parents: parents.into(),
            children: children.into(),
            kind: kind as u32,
            class,
            attributes: start..self.attributes.len() as u32,
        });
        (self.objects.len() - 1) as u32
    }

    /// Adds a surface; loaders keep their own map so that equal surfaces are added once.
    pub fn add_surface(&mut self, surface: Surface) -> u32 {
        self.model.surfaces.push(surface);
        (self.model.surfaces.len() - 1) as u32
    }

    /// Adds what a semantic surface has beyond its type.
    pub fn add_detail(&mut self, attributes: &[Attribute], parent: u32) -> u32 {
        let start = self.model.attributes.len() as u32;
        self.model.attributes.extend_from_slice(attributes);
        self.model.details.push(SurfaceDetail { attributes: start..self.model.attributes.len() as u32, parent });
        (self.model.details.len() - 1) as u32
    }

    /// Adds a geometry of an object.
    pub fn add_geometry(&mut self, geometry: RawGeometry) {
        self.model.extent_as_read = self.model.extent_as_read.union(geometry.extent());
        if !self.staging.add(geometry) {
            self.model.warnings.add(WarningCode::Unsupported, "", || {
                "a city has 2^32 corners at most; the geometries beyond are skipped".to_owned()
            });
        }
    }

    /// Interns a string.
    pub fn intern(&mut self, text: &str) -> StringId {
        self.model.strings.intern(text)
    }

    /// The frame of a file that does not say where it is, by one of its places, z up; `None` where that need not be earth-centred. That of
    /// earlier files, if there is one.
    pub fn frame_of_unnamed(&mut self, file: &Path, place: DVec3) -> Option<LocalFrame> {
        let own = LocalFrame::of_unnamed(place)?;
        self.model.warnings.add(WarningCode::UnknownCrs, "", || {
            format!(
                "{}: coordinates can only be earth-centred (EPSG:4978); they are turned to east, north and up",
                file.display()
            )
        });
        Some(*self.frame.get_or_insert(own))
    }

    /// Makes the model: ids and links, then all geometry.
    pub fn finish(mut self) -> CityModel {
        self.finish_objects();
        let mut staging = std::mem::take(&mut self.staging);
        let mut model = self.model;
        model.frames = Frames { zone: self.zone, local: self.frame };
        staging.parts.retain(|part| {
            let known = (part.object as usize) < model.objects.len();
            if !known {
                model.warnings.add(WarningCode::BadGeometry, "", || "a geometry belongs to no object".to_owned());
            }
            known
        });
        staging.parts.sort_by_key(|part| (part.object, part.lod));
        let mut at = 0;
        for (index, object) in model.objects.iter_mut().enumerate() {
            let start = at;
            while staging.parts.get(at).is_some_and(|part| part.object as usize == index) {
                at += 1;
            }
            object.geometries = start as u32..at as u32;
        }
        line::finish_geometries(&mut model, staging);
        model
    }

    /// Turns raw objects into objects with unique ids, resolved links and their range of attributes.
    fn finish_objects(&mut self) {
        let mut kept = std::mem::take(&mut self.objects);
        let model = &mut self.model;
        let ids = links::unique_ids(&kept, &mut model.warnings);
        let links = links::resolve(&kept, &ids, &self.file_starts, &mut model.warnings);
        let first = model.attributes.len() as u32;
        if first == 0 {
            model.attributes = std::mem::take(&mut self.attributes);
            model.attributes.shrink_to_fit();
        } else {
            model.attributes.reserve_exact(self.attributes.len());
            model.attributes.append(&mut self.attributes);
            give_back(std::mem::take(&mut self.attributes));
        }
        model.surfaces.shrink_to_fit();
        model.details.shrink_to_fit();
        model.objects.reserve_exact(kept.len());
        for (((object, id), parents), children) in kept.drain(..).zip(ids).zip(links.parents).zip(links.children) {
            let KeptObject { kind, class, attributes, .. } = object;
            let kind = model.strings.intern(&self.kinds[kind as usize]);
            let attributes = attributes.start + first..attributes.end + first;
            model.objects.push(CityObject { id, kind, class, parents, children, attributes, geometries: 0..0 });
        }
        give_back(kept);
    }
}

/// A model with these geometries in place of its own, triangulated and tiled as those of files are. Ranges of objects are left to the
/// caller: geometries stand by object, then by level of detail.
pub fn with_geometries(mut model: CityModel, geometries: impl IntoIterator<Item = RawGeometry>) -> CityModel {
    let mut staging = PackedStaging::default();
    for geometry in geometries {
        if !staging.add(geometry) {
            break;
        }
    }
    staging.parts.sort_by_key(|part| (part.object, part.lod));
    line::finish_geometries(&mut model, staging);
    model
}

#[cfg(test)]
mod tests;
