//! From what loaders read to a [`CityModel`]: de-duplication, triangulation, tiles, planes.
//!
//! Loaders push objects, attributes, surfaces and polygons on integer lattices; [`ModelBuilder::finish`]
//! does the rest, in parallel and with the same result for any thread count.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    city::{Attribute, CityModel, Lod, ObjectClass, Source, StringId, Surface, SurfaceDetail},
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
        p.abs().cmplt(DVec3::splat(4.6e18)).all().then(|| [p.x as i64, p.y as i64, p.z as i64])
    }
}

/// Vertices that polygons index into.
#[derive(Clone, Debug)]
pub struct Pool {
    /// What the integers mean.
    pub lattice: Lattice,
    /// The vertices.
    pub points: Vec<[i64; 3]>,
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
    pub fn extent(&self) -> Aabb {
        let used = self.polygons.indices.iter().filter_map(|&i| self.pool.points.get(i as usize));
        let (mut min, mut max) = ([i64::MAX; 3], [i64::MIN; 3]);
        for point in used {
            for axis in 0..3 {
                min[axis] = min[axis].min(point[axis]);
                max[axis] = max[axis].max(point[axis]);
            }
        }
        if min[0] > max[0] {
            return Aabb::EMPTY;
        }
        Aabb { min: self.pool.lattice.to_world(min), max: self.pool.lattice.to_world(max) }
    }
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
    raw_objects: Vec<RawObject>,
    /// First object of each file.
    file_starts: Vec<u32>,
    raw_geometries: Vec<RawGeometry>,
}

impl ModelBuilder {
    /// Starts a file: ids are resolved within it, and `source` is listed.
    pub fn begin_file(&mut self, source: Source) {
        self.file_starts.push(self.raw_objects.len() as u32);
        self.model.sources.push(source);
    }

    /// Adds an object; returns its index in the whole city.
    pub fn add_object(&mut self, object: RawObject) -> u32 {
        self.raw_objects.push(object);
        (self.raw_objects.len() - 1) as u32
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
        self.raw_geometries.push(geometry);
    }

    /// Interns a string.
    pub fn intern(&mut self, text: &str) -> StringId {
        self.model.strings.intern(text)
    }
}
