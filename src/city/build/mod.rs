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
mod links;
mod metric;
mod planes;
mod points;
mod repeats;
mod shelf;
mod tiles;

use std::{ops::Range, sync::Arc};

use glam::DVec3;
use rayon::prelude::*;

pub use self::points::{BAD_POINT, Points, Pool};
use self::{
    job::Chunk,
    planes::PlaneTable,
    shelf::{Part, Shelf},
};
use crate::{
    city::{
        Attribute, CityModel, CityObject, Lod, NONE, ObjectClass, Source, StringId, Surface, SurfaceDetail, WarningCode,
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
    pub fn add_object(&mut self, object: RawObject) -> u32 {
        let RawObject { id, kind, class, parents, children, attributes } = object;
        // A city has a handful of kinds, and neighbours in a file are mostly alike.
        let kind = self.kinds.iter().rposition(|known| **known == *kind).unwrap_or_else(|| {
            self.kinds.push(kind.into());
            self.kinds.len() - 1
        });
        let start = self.attributes.len() as u32;
        self.attributes.extend(attributes);
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
        finish_geometries(&mut model, shelf);
        model
    }

    /// Turns raw objects into objects with unique ids, resolved links and their range of attributes.
    fn finish_objects(&mut self) {
        let kept = std::mem::take(&mut self.objects);
        let model = &mut self.model;
        let ids = links::unique_ids(&kept, &mut model.warnings);
        let links = links::resolve(&kept, &ids, &self.file_starts, &mut model.warnings);
        let first = model.attributes.len() as u32;
        if first == 0 {
            model.attributes = std::mem::take(&mut self.attributes);
            model.attributes.shrink_to_fit();
        } else {
            model.attributes.reserve_exact(self.attributes.len());
            model.attributes.append(&mut std::mem::take(&mut self.attributes));
        }
        model.surfaces.shrink_to_fit();
        model.details.shrink_to_fit();
        model.objects.reserve_exact(kept.len());
        for (((object, id), parents), children) in kept.into_iter().zip(ids).zip(links.parents).zip(links.children) {
            let KeptObject { kind, class, attributes, .. } = object;
            let kind = model.strings.intern(&self.kinds[kind as usize]);
            let attributes = attributes.start + first..attributes.end + first;
            model.objects.push(CityObject { id, kind, class, parents, children, attributes, geometries: 0..0 });
        }
    }
}

/// Polygons per job: enough to be worth a thread's while, few enough to share work evenly.
const JOB_POLYGONS: usize = 1024;

/// Jobs per batch, for all threads: what is triangulated but not yet appended is bounded by two batches. Results do not
/// depend on it.
fn batch_jobs() -> usize {
    (3 * rayon::current_num_threads()).clamp(4, 96)
}

/// Triangulates geometries (sorted by object and LoD) and appends them to the model, in order.
fn finish_geometries(model: &mut CityModel, shelf: Shelf) {
    let context = job::Context::new(&model.objects, &model.surfaces, &shelf);
    // The whole is known before: growing by doubling would cost half as much memory again.
    let (corners, triangles) = shelf.corners_and_triangles();
    let mut built = Built::default();
    built.chunk.vertices.reserve_exact(corners);
    built.chunk.indices.reserve_exact(3 * triangles);
    built.chunk.planes.reserve_exact(triangles);
    built.chunk.geometries.reserve_exact(shelf.parts.len());
    built.chunk.tiles.reserve(shelf.parts.len());

    let mut jobs = Jobs { parts: &shelf.parts };
    let mut ready: Vec<Chunk> = Vec::new();
    loop {
        let batch: Vec<_> = jobs.by_ref().take(batch_jobs()).collect();
        if batch.is_empty() && ready.is_empty() {
            break;
        }
        // One batch is appended while the next is worked on.
        let (next, ()) = rayon::join(
            || {
                batch
                    .into_par_iter()
                    .map_init(job::Scratch::default, |scratch, job| job::run(job, &context, scratch))
                    .collect()
            },
            || ready.drain(..).for_each(|chunk| built.append(chunk, &context.classes)),
        );
        ready = next;
    }
    drop(context);
    drop(shelf);
    let Built { mut chunk, planes, .. } = built;
    let plane_equations = planes.finish(&mut chunk.planes);
    chunk.vertices.shrink_to_fit();
    chunk.indices.shrink_to_fit();
    chunk.planes.shrink_to_fit();
    chunk.texcoords.shrink_to_fit();
    chunk.tiles.shrink_to_fit();
    model.geometries = chunk.geometries;
    model.tiles = chunk.tiles;
    model.vertices = chunk.vertices;
    model.texcoords = chunk.texcoords;
    model.indices = chunk.indices;
    model.planes = chunk.planes;
    model.plane_equations = plane_equations;
    model.warnings.append(chunk.warnings);
}

/// Cuts sorted geometries into jobs; an object's geometries of one LoD stay together.
struct Jobs<'a> {
    parts: &'a [Part],
}

impl<'a> Iterator for Jobs<'a> {
    type Item = &'a [Part];

    fn next(&mut self) -> Option<Self::Item> {
        let mut polygons = 0;
        let mut end = 0;
        while let Some(part) = self.parts.get(end) {
            let same_shape = end > 0 && {
                let last = &self.parts[end - 1];
                (last.object, last.lod) == (part.object, part.lod)
            };
            if polygons >= JOB_POLYGONS && !same_shape {
                break;
            }
            polygons += part.polygon_count();
            end += 1;
        }
        let (job, rest) = self.parts.split_at(end);
        self.parts = rest;
        (!job.is_empty()).then_some(job)
    }
}

/// Everything appended so far.
#[derive(Default)]
struct Built {
    chunk: Chunk,
    planes: PlaneTable,
    /// Polygons so far, for the plane table.
    polygons: u32,
}

impl Built {
    fn append(&mut self, chunk: Chunk, classes: &[Lattice]) {
        let all = &mut self.chunk;
        let (vertices, indices) = (all.vertices.len() as u32, all.indices.len() as u32);
        let (tiles, texcoords) = (all.tiles.len() as u32, all.texcoords.len() as u32);
        let geometries = all.geometries.len() as u32;
        all.vertices.extend_from_slice(&chunk.vertices);
        all.indices.extend_from_slice(&chunk.indices);
        all.texcoords.extend_from_slice(&chunk.texcoords);
        all.tiles.extend(chunk.tiles.into_iter().map(|mut tile| {
            tile.geometry += geometries;
            tile.vertices = tile.vertices.start + vertices..tile.vertices.end + vertices;
            tile.indices = tile.indices.start + indices..tile.indices.end + indices;
            if tile.texcoords != NONE {
                tile.texcoords += texcoords;
            }
            tile
        }));
        all.geometries.extend(chunk.geometries.into_iter().map(|mut geometry| {
            geometry.tiles = geometry.tiles.start + tiles..geometry.tiles.end + tiles;
            geometry
        }));
        let numbers: Vec<u32> = chunk
            .plane_keys
            .iter()
            .map(|&(key, polygon)| self.planes.add(key, self.polygons + polygon, classes))
            .collect();
        all.planes.extend(chunk.planes.iter().map(|&local| if local == 0 { 0 } else { numbers[local as usize - 1] }));
        self.polygons += chunk.polygons;
        all.warnings.append(chunk.warnings);
    }
}

#[cfg(test)]
mod tests;
