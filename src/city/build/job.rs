//! One job: some objects' geometries become triangles in tiles.

use std::ops::Range;

use super::{
    metric::{Grid, is_trusted},
    planes::PlaneKey,
    repeats,
    staging::{PackedStaging, Part, Shape, Slices, corners_and_triangles},
    tiles,
};
use glam::DVec3;

use crate::{
    city::{
        build::{lattice::Lattice, raw::extent_of},
        memory::give_back,
        model::{CityObject, CutTriangle, Geometry, Surface, Tile, Vertex, encode_normal},
        warning::{WarningCode, Warnings},
    },
    geom::{
        exact::newell,
        plane::ExactPlane,
        triangulate::{Refusal, Triangulator},
    },
};

/// Faces bent by less than this are not reported as non-planar: float formats are all bent by a little.
const FLAT_M: f64 = 1e-3;

/// The data that all jobs read.
pub(super) struct Context<'a> {
    pub(super) objects: &'a [CityObject],
    pub(super) surfaces: &'a [Surface],
    staging: &'a PackedStaging,
    /// One per pool.
    grids: Vec<Grid>,
    /// Lattices by grid class.
    pub(super) classes: Vec<Lattice>,
}

impl<'a> Context<'a> {
    pub(super) fn new(objects: &'a [CityObject], surfaces: &'a [Surface], staging: &'a PackedStaging) -> Self {
        let mut classes = Vec::new();
        let grids = staging.pools.iter().map(|pool| Grid::new(pool.lattice, &mut classes)).collect();
        Self { objects, surfaces, staging, grids, classes }
    }

    pub(super) fn grid(&self, raw: &Shape<'_>) -> &Grid {
        &self.grids[raw.pool_number as usize]
    }
}

/// The result of a job; ranges and geometry numbers start at 0.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) geometries: Vec<Geometry>,
    pub(super) tiles: Vec<Tile>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) texcoords: Vec<[f32; 2]>,
    pub(super) indices: Vec<u32>,
    /// Per triangle: 1 + index into `plane_keys`, or 0.
    pub(super) planes: Vec<u32>,
    /// As in the model.
    pub(super) cut_polygons: Vec<CutTriangle>,
    /// Planes and the polygon on each, counted within the chunk.
    pub(super) plane_keys: Vec<(PlaneKey, u32)>,
    pub(super) polygons: u32,
    pub(super) warnings: Warnings,
}

impl Chunk {
    /// Nothing, but the memory is kept.
    fn clear(&mut self) {
        let Self { geometries, tiles, vertices, texcoords, indices, planes, .. } = self;
        let Self { cut_polygons, plane_keys, polygons, warnings, .. } = self;
        geometries.clear();
        tiles.clear();
        vertices.clear();
        texcoords.clear();
        indices.clear();
        planes.clear();
        cut_polygons.clear();
        plane_keys.clear();
        *polygons = 0;
        *warnings = Warnings::default();
    }

    /// Frees the lists whose pages are worth it.
    pub(super) fn give_back(self) {
        give_back(self.vertices);
        give_back(self.texcoords);
        give_back(self.indices);
        give_back(self.planes);
        give_back(self.plane_keys);
    }

    /// Asks once for what a job will need: lists that double leave twice their size in pieces behind.
    fn reserve(&mut self, job: &[Part]) {
        let (corners, triangles) = corners_and_triangles(job);
        self.vertices.reserve_exact(corners);
        self.indices.reserve_exact(3 * triangles);
        self.planes.reserve_exact(triangles);
        self.plane_keys.reserve_exact(job.iter().map(Part::polygon_count).sum());
        self.geometries.reserve_exact(job.len());
        self.tiles.reserve_exact(job.len());
    }
}

/// A triangulated polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Flat normal, packed.
    pub(super) normal: u32,
    pub(super) surface: u32,
}

/// A triangle: three corners (positions in the geometry's `indices`) of one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) corners: [u32; 3],
    pub(super) face: u32,
    /// As in [`Chunk::planes`].
    pub(super) plane: u32,
}

/// Buffers kept between geometries.
#[derive(Default)]
pub(super) struct Scratch {
    triangulator: Triangulator,
    repeats: repeats::Scratch,
    repeated: Vec<Vec<bool>>,
    /// One polygon's points, ring ends and triangles.
    points: Vec<[i64; 3]>,
    ring_ends: Vec<u32>,
    found: Vec<[u32; 3]>,
    /// One geometry's faces and triangles.
    pub(super) faces: Vec<Face>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) tiles: tiles::Scratch,
}

/// The corners of a polygon's rings, as ranges of `indices`.
pub(super) fn corner_ranges(polygons: Slices<'_>, polygon: usize) -> impl Iterator<Item = Range<usize>> {
    let end_before = |ends: &[u32], i: usize| i.checked_sub(1).map_or(0, |i| ends[i] as usize);
    let rings = end_before(polygons.polygon_ends, polygon)..polygons.polygon_ends[polygon] as usize;
    rings.map_while(move |ring| {
        let end = *polygons.ring_ends.get(ring)? as usize;
        Some(end_before(polygons.ring_ends, ring)..end)
    })
}

/// Does a job (geometries sorted by object and LoD), in place of what `chunk` held.
pub(super) fn run(job: &[Part], context: &Context<'_>, scratch: &mut Scratch, chunk: &mut Chunk) {
    chunk.clear();
    chunk.reserve(job);
    let mut same_shape: Vec<Shape<'_>> = Vec::new();
    for parts in job.chunk_by(|a, b| (a.object, a.lod) == (b.object, b.lod)) {
        same_shape.clear();
        same_shape.extend(parts.iter().map(|part| context.staging.shape(part)));
        let mut repeated = std::mem::take(&mut scratch.repeated);
        repeats::mark(&same_shape, context, &mut scratch.repeats, &mut repeated);
        for (raw, repeated) in same_shape.iter().zip(&repeated) {
            add_geometry(raw, repeated, context, scratch, chunk);
        }
        scratch.repeated = repeated;
    }
}

fn add_geometry(raw: &Shape<'_>, repeated: &[bool], context: &Context<'_>, scratch: &mut Scratch, chunk: &mut Chunk) {
    let grid = context.grid(raw);
    let first_triangle = chunk.planes.len();
    let mut dropped = 0;
    scratch.faces.clear();
    scratch.triangles.clear();
    for (polygon, &repeated) in repeated.iter().enumerate() {
        let id = &context.objects[raw.object as usize].id;
        let place = || format!("object {id:?}, LoD {}, face {polygon}", raw.lod);
        if repeated {
            chunk
                .warnings
                .add(WarningCode::DuplicateShape, id, || format!("{}: the object has this face already", place()));
            continue;
        }
        let polygon_number = chunk.polygons + polygon as u32;
        if let Err((code, why)) =
            add_face(raw, polygon, polygon_number, grid, scratch, chunk, &Called { id, place: &place })
        {
            dropped += 1;
            chunk.warnings.add(code, id, || format!("{}: {why}; the face is dropped", place()));
        }
    }
    chunk.polygons += repeated.len() as u32;
    let bounds = extent_of(raw.polygons.indices, raw.pool, |p| grid.world(p));
    let tiles = tiles::emit(raw, grid, bounds, scratch, chunk);
    chunk.geometries.push(Geometry {
        object: raw.object,
        lod: raw.lod,
        solid: raw.solid,
        polygons: repeated.len() as u32,
        triangles: (chunk.planes.len() - first_triangle) as u32,
        dropped,
        grid: grid.class,
        tiles,
        bounds,
    });
}

/// The name of a face in warnings.
struct Called<'a> {
    /// The id of its object.
    id: &'a str,
    /// Where it is, in words.
    place: &'a dyn Fn() -> String,
}

/// Triangulates one polygon into `scratch.faces` and `scratch.triangles`, or says why not.
fn add_face(
    raw: &Shape<'_>,
    polygon: usize,
    polygon_number: u32,
    grid: &Grid,
    scratch: &mut Scratch,
    chunk: &mut Chunk,
    called: &Called<'_>,
) -> Result<(), (WarningCode, &'static str)> {
    let Called { id, place } = *called;
    let first_corner = gather(raw, polygon, grid, scratch)?;
    let Scratch { triangulator, points, ring_ends, found, faces, triangles, .. } = scratch;
    found.clear();
    let face = triangulator.triangulate(points, ring_ends, found).map_err(explain)?;
    if face.deviation > 1.0 && face.deviation * grid.coarsest_step() > FLAT_M {
        chunk.warnings.add(WarningCode::NonPlanar, id, || {
            format!("{}: corners lie up to {:.3} m off its plane", place(), face.deviation * grid.coarsest_step())
        });
    }
    for _ in 0..face.holes_dropped {
        chunk.warnings.add(WarningCode::ShortRing, id, || format!("{}: a hole without area is left out", place()));
    }
    let plane_of = |normal: [i128; 3], point: [i64; 3], keys: &mut Vec<(PlaneKey, u32)>| {
        ExactPlane::new(normal, grid.absolute(point)).map_or(0, |plane| {
            keys.push((PlaneKey { plane, class: grid.class }, polygon_number));
            keys.len() as u32
        })
    };
    let whole = if face.planar { plane_of(face.normal, points[0], &mut chunk.plane_keys) } else { 0 };
    let face_number = faces.len() as u32;
    for corners in found.iter() {
        let plane = if face.planar {
            whole
        } else {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            plane_of(newell(&[a, b, c]), a, &mut chunk.plane_keys)
        };
        triangles.push(Triangle { corners: corners.map(|c| c + first_corner), face: face_number, plane });
    }
    let surface = raw.polygons.surfaces.get(polygon).copied().unwrap_or(0);
    faces.push(Face { normal: encode_normal(grid.normal(face.normal)), surface });
    Ok(())
}

/// Copies a polygon's points and ring ends; returns the position of its first corner.
fn gather(
    raw: &Shape<'_>,
    polygon: usize,
    grid: &Grid,
    scratch: &mut Scratch,
) -> Result<u32, (WarningCode, &'static str)> {
    scratch.points.clear();
    scratch.ring_ends.clear();
    let mut first = None;
    for ring in corner_ranges(raw.polygons, polygon) {
        first.get_or_insert(ring.start as u32);
        for &index in raw.polygons.indices.get(ring).unwrap_or_default() {
            let Some(point) = raw.pool.points.get(index) else {
                return Err((WarningCode::VertexIndex, "a vertex index points past the vertex list"));
            };
            let world: DVec3 = grid.world(point);
            if !is_trusted(world) {
                return Err((WarningCode::BadCoordinate, "a coordinate is no number or too far from the origin"));
            }
            scratch.points.push(point);
        }
        scratch.ring_ends.push(scratch.points.len() as u32);
    }
    Ok(first.unwrap_or(0))
}

/// A refusal as a warning.
fn explain(refusal: Refusal) -> (WarningCode, &'static str) {
    match refusal {
        Refusal::ShortRing => (WarningCode::ShortRing, "its outer ring has fewer than three distinct points"),
        Refusal::ZeroArea => (WarningCode::ZeroArea, "its points lie on one line"),
        Refusal::SelfCrossing => (WarningCode::SelfCrossing, "its rings cross or overlap"),
        Refusal::AreaMismatch => (WarningCode::AreaMismatch, "no triangulation has exactly its area"),
        Refusal::TooLarge => (WarningCode::BadCoordinate, "it extends over more than 2^50 lattice units"),
    }
}
