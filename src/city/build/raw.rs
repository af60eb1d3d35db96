//! Raw data of loaders: polygons, geometries and objects.

use std::{ops::Range, sync::Arc};

use glam::DVec3;

use crate::{
    city::{
        build::{metric::is_trusted, points::Pool},
        model::{Attribute, Lod, ObjectClass},
    },
    geom::Aabb,
};

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
    /// The object, as returned by [`crate::city::build::ModelBuilder::add_object`].
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
pub(super) fn extent_of(indices: &[u32], pool: &Pool, world: impl Fn([i64; 3]) -> DVec3) -> Aabb {
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
    if corners.into_iter().all(is_trusted) {
        return Aabb { min: corners[0], max: corners[1] };
    }
    Aabb::from_points(used().map(&world).filter(|&p| is_trusted(p)))
}

/// An object as read; links by id are resolved in [`crate::city::build::ModelBuilder::finish`], within the object's own file.
#[derive(Clone, Debug, Default)]
pub struct RawObject {
    /// Id as the file spells it.
    pub id: String,
    /// Type as the file names it.
    pub kind: String,
    /// Its class.
    pub class: ObjectClass,
    /// Ids of its parents.
    pub parents: Vec<String>,
    /// Ids of its children.
    pub children: Vec<String>,
    /// Its attributes; strings interned with [`crate::city::build::ModelBuilder::intern`].
    pub attributes: Vec<Attribute>,
}

/// A [`RawObject`] on less memory: a city has tens of thousands, waiting for the rest of their file.
#[derive(Clone, Debug)]
pub(super) struct KeptObject {
    pub(super) id: Box<str>,
    pub(super) parents: Box<[String]>,
    pub(super) children: Box<[String]>,
    /// Index into [`crate::city::build::ModelBuilder::kinds`].
    pub(super) kind: u32,
    pub(super) class: ObjectClass,
    /// In [`crate::city::build::ModelBuilder::attributes`].
    pub(super) attributes: Range<u32>,
}
