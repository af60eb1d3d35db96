//! Packed staging of geometries between reading and triangulation: flat, one list per kind of number for the whole city.
//!
//! A city has tens of thousands of geometries of a dozen polygons; lists of their own would cost more than what is in
//! them.

use std::{ops::Range, sync::Arc};

use crate::city::{
    build::{
        points::Pool,
        raw::{Polygons, RawGeometry},
    },
    memory::give_back,
    model::Lod,
};

/// The geometries that were read and are not triangulated yet.
#[derive(Debug, Default)]
pub(super) struct PackedStaging {
    pub(super) parts: Vec<Part>,
    pub(super) pools: Vec<Arc<Pool>>,
    all: Polygons,
}

/// One geometry: its ranges of the lists.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) object: u32,
    /// Index into [`PackedStaging::pools`].
    pub(super) pool: u32,
    pub(super) lod: Lod,
    pub(super) solid: bool,
    indices: Range<u32>,
    ring_ends: Range<u32>,
    polygon_ends: Range<u32>,
    surfaces: Range<u32>,
    texcoords: Range<u32>,
    normals: Range<u32>,
}

impl Part {
    /// The number of its polygons.
    pub(super) fn polygon_count(&self) -> usize {
        self.polygon_ends.len()
    }
}

/// One geometry, borrowed: the fields of [`RawGeometry`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape<'a> {
    pub(super) object: u32,
    pub(super) lod: Lod,
    pub(super) solid: bool,
    pub(super) pool: &'a Pool,
    /// The number of the pool, and of its grid.
    pub(super) pool_number: u32,
    pub(super) polygons: Slices<'a>,
}

/// [`Polygons`], borrowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slices<'a> {
    pub(super) indices: &'a [u32],
    pub(super) ring_ends: &'a [u32],
    pub(super) polygon_ends: &'a [u32],
    pub(super) surfaces: &'a [u32],
    pub(super) texcoords: &'a [[f32; 2]],
    pub(super) normals: &'a [[f32; 3]],
}

impl PackedStaging {
    /// Appends a geometry; `false` when it is one too many for 32-bit ranges.
    pub(super) fn add(&mut self, raw: RawGeometry) -> bool {
        let RawGeometry { object, lod, solid, pool, polygons } = raw;
        let all = &mut self.all;
        let (Some(indices), Some(ring_ends), Some(polygon_ends), Some(surfaces), Some(texcoords), Some(normals)) = (
            append(&mut all.indices, polygons.indices),
            append(&mut all.ring_ends, polygons.ring_ends),
            append(&mut all.polygon_ends, polygons.polygon_ends),
            append(&mut all.surfaces, polygons.surfaces),
            append(&mut all.texcoords, polygons.texcoords),
            append(&mut all.normals, polygons.normals),
        ) else {
            return false;
        };
        // Loaders finish one pool before the next.
        if self.pools.last().is_none_or(|last| !Arc::ptr_eq(last, &pool)) {
            self.pools.push(pool);
        }
        let pool = self.pools.len() as u32 - 1;
        let part = Part { object, pool, lod, solid, indices, ring_ends, polygon_ends, surfaces, texcoords, normals };
        self.parts.push(part);
        true
    }

    pub(super) fn shape(&self, part: &Part) -> Shape<'_> {
        let all = &self.all;
        Shape {
            object: part.object,
            lod: part.lod,
            solid: part.solid,
            pool: &self.pools[part.pool as usize],
            pool_number: part.pool,
            polygons: Slices {
                indices: slice(&all.indices, &part.indices),
                ring_ends: slice(&all.ring_ends, &part.ring_ends),
                polygon_ends: slice(&all.polygon_ends, &part.polygon_ends),
                surfaces: slice(&all.surfaces, &part.surfaces),
                texcoords: slice(&all.texcoords, &part.texcoords),
                normals: slice(&all.normals, &part.normals),
            },
        }
    }

    /// Texture coordinates of all corners that have any.
    pub(super) fn texcoord_count(&self) -> usize {
        self.all.texcoords.len()
    }

    /// Frees everything.
    pub(super) fn give_back(self) {
        let Polygons { indices, ring_ends, polygon_ends, surfaces, texcoords, normals } = self.all;
        give_back(indices);
        give_back(ring_ends);
        give_back(polygon_ends);
        give_back(surfaces);
        give_back(texcoords);
        give_back(normals);
        give_back(self.parts);
        self.pools.into_iter().filter_map(Arc::into_inner).for_each(|pool| pool.points.give_back());
    }
}

/// Corners of geometries, and triangles that they make at most: of n corners and h holes n + 2 h - 2.
pub(super) fn corners_and_triangles(parts: &[Part]) -> (usize, usize) {
    let sum = |count: fn(&Part) -> usize| parts.iter().map(count).sum::<usize>();
    let corners = sum(|part| part.indices.len());
    let triangles = (corners + 2 * sum(|part| part.ring_ends.len())).saturating_sub(4 * sum(Part::polygon_count));
    (corners, triangles)
}

fn append<T>(all: &mut Vec<T>, own: Vec<T>) -> Option<Range<u32>> {
    let start = u32::try_from(all.len()).ok()?;
    let end = u32::try_from(all.len() + own.len()).ok()?;
    all.extend(own);
    Some(start..end)
}

fn slice<'a, T>(all: &'a [T], range: &Range<u32>) -> &'a [T] {
    &all[range.start as usize..range.end as usize]
}
