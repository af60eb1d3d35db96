//! Triangles into tiles: vertices relative to an origin that depends on the geometry alone.

use std::ops::Range;

use super::{
    job::{Chunk, Triangle},
    metric::Grid,
    staging::Shape,
};
use glam::{DVec3, IVec3, Vec3};

use crate::{
    city::{
        build::points::BAD_POINT,
        model::{CutTriangle, NONE, Tile, Vertex, encode_normal},
    },
    geom::Aabb,
};

/// Edge of a tile, metres. Geometries no larger are one tile.
pub const TILE_M: f64 = 64.0;

/// In geometries of several tiles positions are rounded to 2⁻¹⁷ m (8 µm; half of it is the f32 error that 64 m allow):
/// offsets below 128 m are then exact, so a vertex that two tiles share is at one place and no crack opens between them.
/// Where triangles reach farther out of their tiles along an axis, all positions of the geometry are rounded as much
/// coarser along it, to 2⁻¹⁰ m at most: a corner more than 16 km away is an error of the file, and spoils no others.
const SHARED_PER_M: f64 = 131_072.0;
const LEAST_PER_M: f64 = 1024.0;
/// Integers up to this are exact in an f32.
const EXACT: f64 = 16_777_216.0;

/// Buffers kept between geometries.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Per triangle of a geometry of many tiles: its cell, its number.
    cells: Vec<([i32; 3], u32)>,
    /// Per face of such a geometry: whether its triangles lie in several cells.
    is_cut: Vec<bool>,
    /// Per corner: its vertex in the chunk; of this tile if not below the tile's first.
    vertex_of: Vec<u32>,
    order: Vec<u32>,
}

/// Appends the geometry's triangles to the chunk, tile by tile.
///
/// The grid of tiles starts at the whole metre below the geometry's smallest coordinates. A triangle belongs whole to
/// the tile that holds its lexicographically smallest corner, so it may reach out of it; [`Tile::bounds`] says how far.
pub(super) fn emit(
    raw: &Shape<'_>,
    grid: &Grid,
    bounds: Aabb,
    scratch: &mut super::job::Scratch,
    chunk: &mut Chunk,
) -> Range<u32> {
    let first = chunk.tiles.len() as u32;
    let super::job::Scratch { faces, triangles, tiles: own, .. } = scratch;
    if triangles.is_empty() {
        return first..first;
    }
    let origin = bounds.min.floor();
    // Corners of triangles are points that exist: faces with others were dropped.
    let point = |corner: u32| raw.pool.points.get(raw.polygons.indices[corner as usize]).unwrap_or(BAD_POINT);
    let world = |corner: u32| grid.world(point(corner));
    own.vertex_of.clear();
    own.vertex_of.resize(raw.polygons.indices.len(), NONE);
    own.order.clear();
    own.order.extend(0..triangles.len() as u32);
    own.is_cut.clear();
    if (bounds.max - bounds.min).max_element() <= TILE_M {
        let mut emitter = Emitter { raw, faces, triangles, is_cut: &[], vertex_of: &mut own.vertex_of, chunk };
        emitter.tile(&own.order, origin, &world);
        return first..first + 1;
    }
    own.cells.clear();
    let mut reach = DVec3::ZERO;
    own.cells.extend(triangles.iter().enumerate().map(|(number, triangle)| {
        let [a, b, c] = triangle.corners.map(world);
        let less = |p: DVec3, q: DVec3| if p.to_array() < q.to_array() { p } else { q };
        let cell = ((less(less(a, b), c) - origin) / TILE_M).floor();
        let from = origin + TILE_M * cell;
        reach = [a, b, c].into_iter().fold(reach, |reach, p| reach.max((p - from).abs()));
        (cell.as_ivec3().to_array(), number as u32)
    }));
    let per_m = DVec3::from(reach.to_array().map(|reach| {
        let mut per_m = SHARED_PER_M;
        while reach * per_m > EXACT && per_m > LEAST_PER_M {
            per_m /= 2.0;
        }
        per_m
    }));
    // A face's triangles are neighbours here.
    own.is_cut.resize(faces.len(), false);
    for (cells, pair) in own.cells.windows(2).zip(triangles.windows(2)) {
        own.is_cut[pair[0].face as usize] |= pair[0].face == pair[1].face && cells[0].0 != cells[1].0;
    }
    own.cells.sort_unstable();
    let mut emitter = Emitter { raw, faces, triangles, is_cut: &own.is_cut, vertex_of: &mut own.vertex_of, chunk };
    let world = |corner: u32| (world(corner) * per_m).round() / per_m;
    for same in own.cells.chunk_by(|a, b| a.0 == b.0) {
        own.order.clear();
        own.order.extend(same.iter().map(|&(_, number)| number));
        emitter.tile(&own.order, origin + TILE_M * IVec3::from(same[0].0).as_dvec3(), &world);
    }
    first..emitter.chunk.tiles.len() as u32
}

struct Emitter<'a> {
    raw: &'a Shape<'a>,
    faces: &'a [super::job::Face],
    triangles: &'a [Triangle],
    /// Per face, or empty.
    is_cut: &'a [bool],
    vertex_of: &'a mut [u32],
    chunk: &'a mut Chunk,
}

impl Emitter<'_> {
    /// Appends one tile with the triangles of these numbers.
    fn tile(&mut self, numbers: &[u32], origin: DVec3, world: &dyn Fn(u32) -> DVec3) {
        let chunk = &mut *self.chunk;
        let polygons = &self.raw.polygons;
        let (first_vertex, first_index) = (chunk.vertices.len() as u32, chunk.indices.len() as u32);
        let has_texcoords = polygons.texcoords.len() == polygons.indices.len() && !polygons.texcoords.is_empty();
        let texcoords = if has_texcoords { chunk.texcoords.len() as u32 } else { NONE };
        let mut bounds = Aabb::EMPTY;
        for &number in numbers {
            let triangle = self.triangles[number as usize];
            let face = self.faces[triangle.face as usize];
            for corner in triangle.corners {
                let known = &mut self.vertex_of[corner as usize];
                if *known == NONE || *known < first_vertex {
                    *known = chunk.vertices.len() as u32;
                    let position = (world(corner) - origin).as_vec3();
                    bounds = bounds.grown(origin + position.as_dvec3());
                    let normal = smooth_normal(polygons.normals, corner).unwrap_or(face.normal);
                    chunk.vertices.push(Vertex { position: position.to_array(), normal, surface: face.surface });
                    if has_texcoords {
                        chunk.texcoords.push(polygons.texcoords[corner as usize]);
                    }
                }
                chunk.indices.push(*known - first_vertex);
            }
            if self.is_cut.get(triangle.face as usize) == Some(&true) {
                chunk.cut_polygons.push(CutTriangle { triangle: chunk.planes.len() as u32, polygon: triangle.face });
            }
            chunk.planes.push(triangle.plane);
        }
        chunk.tiles.push(Tile {
            origin: origin.as_ivec3(),
            geometry: chunk.geometries.len() as u32,
            vertices: first_vertex..chunk.vertices.len() as u32,
            indices: first_index..chunk.indices.len() as u32,
            texcoords,
            bounds,
        });
    }
}

/// The corner's own normal, packed, if the file has one with a direction.
fn smooth_normal(normals: &[[f32; 3]], corner: u32) -> Option<u32> {
    let normal = Vec3::from(*normals.get(corner as usize)?).as_dvec3();
    let unit = normal.try_normalize()?;
    Some(encode_normal(unit))
}
