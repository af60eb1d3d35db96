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
mod line;
mod links;
mod metric;
mod planes;
mod points;
mod repeats;
mod shelf;
mod tiles;

use std::{ops::Range, sync::Arc};

use glam::DVec3;

pub use self::points::{BAD_POINT, Points, Pool};
use self::shelf::Shelf;
use crate::{
    city::{
        Attribute, CityModel, CityObject, Lod, ObjectClass, Source, StringId, Surface, SurfaceDetail, WarningCode,
        memory::give_back,
    },
    geom::Aabb,
};

/// How a pool's integers become metres, per axis: `origin + step × integer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Metres per unit, > 0.
    pub step: DVec3,
    /// Metres at integer 0.
    pub origin: DVec3,
}

impl Lattice {
    /// The lattice that floating-point formats are put on: 2⁻²⁰ m (about a micrometre) around the world's origin.
    /// Positions nearer than 2³² m are rounded by at most half a step.
    pub const FINE: Self = Self { step: DVec3::splat(1.0 / 1_048_576.0), origin: DVec3::ZERO };

    /// World metres of a lattice point.
    pub fn to_world(&self, p: [i64; 3]) -> DVec3 {
        self.origin + self.step * DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64)
    }

    /// The nearest lattice point; `None` for NaN, infinity or farther than 2^62 steps.
    pub fn nearest(&self, world: DVec3) -> Option<[i64; 3]> {
        let p = ((world - self.origin) / self.step).round();
        p.abs().cmplt(DVec3::splat(4.6e18)).all().then_some([p.x as i64, p.y as i64, p.z as i64])
    }
}

/// Polygons of one geometry, flat: `indices` split into rings by `ring_ends`, rings into polygons by `polygon_ends`.
///
/// ```text
/// indices       0 1 2 3 | 4 5 6 | 7 8 9
/// ring_ends             4       7      10      (exclusive, into indices)
/// polygon_ends                  2       3      (exclusive, into ring_ends; ring 0 of a polygon is its outer one)
/// surfaces                      a       b      (one per polygon)
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    /// Indices into the pool.
    pub indices: Vec<u32>,
    /// Exclusive ends of rings in `indices`.
    pub ring_ends: Vec<u32>,
    /// Exclusive ends of polygons in `ring_ends`.
    pub polygon_ends: Vec<u32>,
    /// Index into the builder's surfaces, one per polygon.
    pub surfaces: Vec<u32>,
    /// Texture coordinates (v down), one per index, or empty.
    pub texcoords: Vec<[f32; 2]>,
    /// Smooth unit normals, one per index, or empty: faces are flat.
    pub normals: Vec<[f32; 3]>,
}

/// One geometry of one object, as read.
#[derive(Clone, Debug)]
pub struct RawGeometry {
    /// The object, as returned by [`ModelBuilder::add_object`].
    pub object: u32,
    /// Its level of detail.
    pub lod: Lod,
    /// Whether it is made of closed shells.
    pub solid: bool,
    /// The vertices, shared between geometries of one file.
    pub pool: Arc<Pool>,
    /// The faces.
    pub polygons: Polygons,
}

impl RawGeometry {
    /// Box around the vertices its polygons use, metres: taken on the integers, so corners are exactly as read.
    /// Coordinates too far away to be true are left out.
    pub fn extent(&self) -> Aabb {
        extent_of(&self.polygons.indices, &self.pool, |p| self.pool.lattice.to_world(p))
    }
}

/// Box around the points that `indices` name, in metres as `world` has them: it must grow with each coordinate.
fn extent_of(indices: &[u32], pool: &Pool, world: impl Fn([i64; 3]) -> DVec3) -> Aabb {
    let used = || indices.iter().filter_map(|&i| pool.points.get(i));
    let (mut min, mut max) = ([i64::MAX; 3], [i64::MIN; 3]);
    for point in used() {
        for axis in 0..3 {
            min[axis] = min[axis].min(point[axis]);
            max[axis] = max[axis].max(point[axis]);
        }
    }
    if min[0] > max[0] {
        return Aabb::EMPTY;
    }
    let corners = [min, max].map(&world);
    if corners.into_iter().all(metric::is_trusted) {
        return Aabb { min: corners[0], max: corners[1] };
    }
    Aabb::from_points(used().map(&world).filter(|&p| metric::is_trusted(p)))
}

/// An object as read; links by id are resolved in [`ModelBuilder::finish`], within the object's own file.
#[derive(Clone, Debug, Default)]
pub struct RawObject {
    /// Id as the file spells it.
    pub id: String,
    /// Type as the file names it.
    pub kind: String,
    /// What kind of thing it is.
    pub class: ObjectClass,
    /// Ids of its parents.
    pub parents: Vec<String>,
    /// Ids of its children.
    pub children: Vec<String>,
    /// Its attributes; strings interned with [`ModelBuilder::intern`].
    pub attributes: Vec<Attribute>,
}

/// Gathers what loaders read.
#[derive(Debug, Default)]
pub struct ModelBuilder {
    /// The model so far; loaders fill `sources`, `crs`, `materials`, `textures`, `unknown`, `warnings` directly.
    pub model: CityModel,
    /// The metric frame of a city in degrees, once its first vertex is known.
    pub zone: Option<crate::city::crs::UtmZone>,
    objects: Vec<KeptObject>,
    /// Kinds of objects, as `KeptObject::kind` counts them.
    kinds: Vec<Box<str>>,
    /// Attributes of the objects, in ranges.
    attributes: Vec<Attribute>,
    /// First object of each file.
    file_starts: Vec<u32>,
    shelf: Shelf,
}

/// A [`RawObject`] on less memory: a city has tens of thousands, waiting for the rest of their file.
#[derive(Clone, Debug)]
struct KeptObject {
    id: Box<str>,
    parents: Box<[String]>,
    children: Box<[String]>,
    /// Index into [`ModelBuilder::kinds`].
    kind: u32,
    class: ObjectClass,
    /// In [`ModelBuilder::attributes`].
    attributes: Range<u32>,
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
        if !self.shelf.add(geometry) {
            self.model.warnings.add(WarningCode::Unsupported, "", || {
                "a city has 2^32 corners at most; the geometries beyond are skipped".to_owned()
            });
        }
    }

    /// Interns a string.
    pub fn intern(&mut self, text: &str) -> StringId {
        self.model.strings.intern(text)
    }

    /// Makes the model: ids and links, then all geometry.
    pub fn finish(mut self) -> CityModel {
        self.finish_objects();
        let mut shelf = std::mem::take(&mut self.shelf);
        let mut model = self.model;
        shelf.parts.retain(|part| {
            let known = (part.object as usize) < model.objects.len();
            if !known {
                model.warnings.add(WarningCode::BadGeometry, "", || "a geometry belongs to no object".to_owned());
            }
            known
        });
        shelf.parts.sort_by_key(|part| (part.object, part.lod));
        let mut at = 0;
        for (index, object) in model.objects.iter_mut().enumerate() {
            let start = at;
            while shelf.parts.get(at).is_some_and(|part| part.object as usize == index) {
                at += 1;
            }
            object.geometries = start as u32..at as u32;
        }
        line::finish_geometries(&mut model, shelf);
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
    let mut shelf = Shelf::default();
    for geometry in geometries {
        if !shelf.add(geometry) {
            break;
        }
    }
    shelf.parts.sort_by_key(|part| (part.object, part.lod));
    line::finish_geometries(&mut model, shelf);
    model
}

#[cfg(test)]
mod tests;
