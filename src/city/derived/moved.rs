//! Forms that are an object's own faces, at other heights: textures, semantics and the objects of parts stay.

use super::{
    flat,
    ground::GroundFaces,
    source::{Face, Part, Source, Target, Unit},
};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    city::{
        coplanar::intersection,
        derived::form::{Derived, Form},
        model::{CutTriangle, Geometry, NONE, Tile, Vertex, decode_normal, encode_normal},
    },
    geom::{Aabb, plane::Plane},
};

/// Says what becomes of a unit.
pub(super) type Make = fn(&Source, &Unit, &Form) -> Change;

/// The change of the faces of a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// They stay.
    None,
    /// Nothing is left.
    Gone,
    /// Those that look up lie level; of a unit without such ones those that look down.
    Level {
        /// Where, metres.
        z: f64,
        /// The lowest point before, metres.
        base: f64,
        /// The height above the ground, where there is some, metres.
        lift: f64,
        /// Whether it has none that look up.
        from_below: bool,
        /// Whether they look where they looked before.
        is_lit: bool,
    },
    /// They stand at other heights.
    Steps(Steps),
}

/// New heights of old: two straight pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    /// Stays where it is, metres.
    pub base: f64,
    /// Where the pieces meet, old metres.
    pub knee: f64,
    /// New metres per old one up to there, > 0.
    pub below: f64,
    /// And from there on, > 0.
    pub above: f64,
}

impl Steps {
    fn at(&self, z: f64) -> f64 {
        let (offset, slope) = self.piece(z > self.knee);
        offset + slope * z
    }

    /// New = offset + slope × old, metres.
    fn piece(&self, is_above: bool) -> (f64, f64) {
        let knee = self.base + (self.knee - self.base) * self.below;
        match is_above {
            true => (knee - self.knee * self.above, self.above),
            false => (self.base * (1.0 - self.below), self.below),
        }
    }
}

/// Triangles of equal keys lie in one plane, if they lie in one at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum PlaneKey {
    None,
    /// That of the source.
    Old(u32),
    /// Level, at so many micrometres.
    Level(i64),
    /// That of a triangle of the ground, raised by so much (bits).
    Ground(u32, u64),
    /// One of the source, moved: bits of the offset and the slope of heights.
    Moved(u32, [u64; 2]),
}

/// Faces of some units; ranges start at 0, surfaces are the source's.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    geometries: Vec<Geometry>,
    tiles: Vec<Tile>,
    vertices: Vec<Vertex>,
    texcoords: Vec<[f32; 2]>,
    indices: Vec<u32>,
    planes: Vec<PlaneKey>,
    cut_polygons: Vec<CutTriangle>,
    heights: Vec<[f32; 3]>,
    unchanged: u32,
    left_out: u32,
    /// By old vertex and new normal.
    numbers: FxHashMap<(u32, u32), u32>,
}

/// Units per piece of work.
const UNITS: usize = 256;

pub(super) fn derived(source: &Source, form: &Form, make: Make) -> Derived {
    let of = |units: &[Unit]| {
        let mut chunk = Chunk::default();
        for unit in units {
            let change = make(source, unit, form);
            chunk.unchanged += u32::from(change == Change::None);
            chunk.left_out += u32::from(change == Change::Gone);
            chunk.add(source, unit, &change);
        }
        chunk.numbers = FxHashMap::default();
        chunk
    };
    let chunks: Vec<Chunk> = source.units.par_chunks(UNITS).map(of).collect();
    let sum = |count: fn(&Chunk) -> u32| chunks.iter().map(count).sum();
    let (unchanged, left_out) = (sum(|c| c.unchanged), sum(|c| c.left_out));
    let mut target = Target::new(source.model);
    let heights = append(&mut target, source, chunks);
    Derived { model: target.finish(), heights, unchanged, left_out, instead: 0 }
}

impl Chunk {
    /// Adds the faces of a unit.
    pub fn add(&mut self, source: &Source, unit: &Unit, change: &Change) {
        if *change == Change::Gone {
            return;
        }
        for geometry in source.geometries_of(unit) {
            let (first_tile, first_triangle) = (self.tiles.len() as u32, self.planes.len());
            let mut bounds = Aabb::EMPTY;
            for tile in source.tiles_of(geometry) {
                bounds = bounds.union(self.add_tile(source, tile, change));
            }
            let triangles = (self.planes.len() - first_triangle) as u32;
            if triangles > 0 {
                let tiles = first_tile..self.tiles.len() as u32;
                let solid = geometry.solid && !matches!(change, Change::Level { .. });
                self.geometries.push(Geometry { solid, triangles, tiles, bounds, ..geometry.clone() });
            }
        }
    }

    /// Adds what is left of a tile; returns a box around it, metres.
    fn add_tile(&mut self, source: &Source, tile: &Tile, change: &Change) -> Aabb {
        let model = source.model;
        let (first_vertex, first_index) = (self.vertices.len() as u32, self.indices.len() as u32);
        let first_texcoord = self.texcoords.len() as u32;
        let is_textured = tile.texcoords != NONE;
        self.numbers.clear();
        for triangle in tile.indices.start / 3..tile.indices.end / 3 {
            let face = source.face(tile, triangle);
            let Some(order) = kept(source, &face, change) else { continue };
            let old = order.map(|k| model.indices[3 * triangle as usize + k]);
            let vertices = old.map(|i| &model.vertices[(tile.vertices.start + i) as usize]);
            let corners = order.map(|k| face.corners[k]);
            if let (Change::Level { base, lift, is_lit, .. }, Some(ground)) = (change, &source.ground) {
                let texcoords = is_textured.then(|| old.map(|i| model.texcoords[(tile.texcoords + i) as usize]));
                let normal = if *is_lit { upward(&face) } else { encode_normal(DVec3::Z) };
                let sheet = Sheet { tile, surface: face.surface, corners, texcoords, first_vertex, normal };
                let covered = sheet.lay(self, ground, *base, *lift);
                if covered {
                    continue;
                }
            }
            let normals = normals(vertices.map(|v| v.normal), &corners, change);
            for ((old, vertex), normal) in old.into_iter().zip(vertices).zip(normals) {
                let next = self.vertices.len() as u32 - first_vertex;
                let number = *self.numbers.entry((old, normal)).or_insert(next);
                if number == next {
                    let position = moved(vertex.position, tile, change);
                    self.vertices.push(Vertex { position, normal, surface: face.surface });
                    if is_textured {
                        self.texcoords.push(model.texcoords[(tile.texcoords + old) as usize]);
                    }
                }
                self.indices.push(number);
            }
            if let Ok(at) = model.cut_polygons.binary_search_by_key(&triangle, |cut| cut.triangle) {
                let triangle = self.planes.len() as u32;
                self.cut_polygons.push(CutTriangle { triangle, ..model.cut_polygons[at] });
            }
            self.planes.push(plane_key(source, model.planes[triangle as usize], &corners, change));
            if let Change::Level { base, .. } = change {
                self.heights.push(corners.map(|corner| (corner.z - base).max(0.0) as f32));
            }
        }
        let vertices = first_vertex..self.vertices.len() as u32;
        let world = |v: &Vertex| tile.origin.as_dvec3() + Vec3::from(v.position).as_dvec3();
        let bounds = Aabb::from_points(self.vertices[vertices.start as usize..].iter().map(world));
        if !vertices.is_empty() {
            self.tiles.push(Tile {
                origin: tile.origin,
                geometry: self.geometries.len() as u32,
                vertices,
                indices: first_index..self.indices.len() as u32,
                texcoords: if is_textured { first_texcoord } else { NONE },
                bounds,
            });
        }
        bounds
    }
}

/// A face that is laid on the ground.
struct Sheet<'a> {
    tile: &'a Tile,
    surface: u32,
    /// Counter-clockwise from above, metres.
    corners: [DVec3; 3],
    texcoords: Option<[[f32; 2]; 3]>,
    first_vertex: u32,
    /// Packed.
    normal: u32,
}

/// A face over more triangles of the ground than this is not laid on them.
const MOST_PIECES: usize = 4096;

/// Part of a face that may have no ground below it and is left out nevertheless: gaps between triangles of the ground.
const UNCOVERED: f64 = 1e-3;

impl Sheet<'_> {
    /// Lays the face on all triangles of the ground below it. Whether they cover it.
    fn lay(&self, chunk: &mut Chunk, ground: &GroundFaces, base: f64, lift: f64) -> bool {
        let from_above = self.corners.map(DVec3::truncate);
        let twice_area =
            |p: &[DVec2]| (1..p.len().max(2) - 1).map(|k| (p[k] - p[0]).perp_dot(p[k + 1] - p[0])).sum::<f64>();
        let all = twice_area(&from_above);
        let mut covered = 0.0;
        let below = ground.below(&from_above);
        if below.len() > MOST_PIECES {
            return false;
        }
        for (number, below) in below {
            let (polygon, count) = intersection(&from_above, &below.corners);
            let piece = &polygon[..count];
            let area = if count < 3 { 0.0 } else { twice_area(piece) };
            if area <= 2.0 * flat::LEAST_AREA_M2 {
                continue;
            }
            covered += area;
            let key = match below.group {
                0 => PlaneKey::Ground(number, lift.to_bits()),
                group => PlaneKey::Moved(group, [lift.to_bits(), 1.0_f64.to_bits()]),
            };
            self.add(chunk, piece, key, base, |p| below.height(p) + lift);
        }
        covered >= all * (1.0 - UNCOVERED)
    }

    /// Adds a convex piece of the face.
    fn add(&self, chunk: &mut Chunk, piece: &[DVec2], key: PlaneKey, base: f64, height: impl Fn(DVec2) -> f64) {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        let area = (b - a).perp_dot(c - a);
        let shares = |p: DVec2| {
            let (u, v) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
            [1.0 - u - v, u, v]
        };
        let origin = self.tile.origin.as_dvec3();
        let first = chunk.vertices.len() as u32 - self.first_vertex;
        let was = |p: DVec2| {
            let z = shares(p).into_iter().zip(self.corners).map(|(share, corner)| share * corner.z).sum::<f64>();
            (z - base).max(0.0) as f32
        };
        for &p in piece {
            let position = (p.extend(height(p)) - origin).as_vec3().to_array();
            chunk.vertices.push(Vertex { position, normal: self.normal, surface: self.surface });
            chunk.texcoords.extend(self.texcoords.map(|at| {
                let share = shares(p).map(|share| share as f32);
                [0, 1].map(|k| (0..3).map(|corner| share[corner] * at[corner][k]).sum())
            }));
        }
        for k in 1..piece.len() as u32 - 1 {
            chunk.indices.extend([first, first + k, first + k + 1]);
            chunk.planes.push(key);
            chunk.heights.push([0, k as usize, k as usize + 1].map(|i| was(piece[i])));
        }
    }
}

/// The corners of a face in their new order; `None` where it is not seen.
pub(super) fn kept(source: &Source, face: &Face, change: &Change) -> Option<[usize; 3]> {
    let Change::Level { from_below, .. } = change else { return Some([0, 1, 2]) };
    let side = 0.5 * face.normal().z;
    let is_seen = side > 0.0 || *from_below || source.part(face) == Part::Roof;
    let has_area = side.abs() > flat::LEAST_AREA_M2;
    (is_seen && has_area).then_some(if side > 0.0 { [0, 1, 2] } else { [0, 2, 1] })
}

/// A vertex, from the tile's origin, where it stands now.
fn moved([x, y, z]: [f32; 3], tile: &Tile, change: &Change) -> [f32; 3] {
    let origin = f64::from(tile.origin.z);
    let z = match change {
        Change::None | Change::Gone => z,
        Change::Level { z, .. } => (z - origin) as f32,
        Change::Steps(steps) => (steps.at(origin + f64::from(z)) - origin) as f32,
    };
    [x, y, z]
}

/// The normals of a triangle's corners, packed; `corners` where they stood.
fn normals(old: [u32; 3], corners: &[DVec3; 3], change: &Change) -> [u32; 3] {
    let steps = match change {
        Change::None | Change::Gone => return old,
        Change::Level { is_lit: true, .. } => return [upward(&Face { corners: *corners, surface: 0 }); 3],
        Change::Level { .. } => return [encode_normal(DVec3::Z); 3],
        Change::Steps(steps) => steps,
    };
    let slope = |z: f64| if z < steps.knee { steps.below } else { steps.above };
    let turned = |(normal, corner): (u32, &DVec3)| {
        let n = decode_normal(normal);
        let s = slope(corner.z);
        if n.z == 0.0 || s == 1.0 { normal } else { encode_normal((n * DVec3::new(1.0, 1.0, 1.0 / s)).normalize_or(n)) }
    };
    if old[0] != old[1] || old[0] != old[2] {
        return [0, 1, 2].map(|k| turned((old[k], &corners[k])));
    }
    // A flat face has one normal, also where it reaches over the knee.
    let is_turned = decode_normal(old[0]).z != 0.0 && corners.iter().any(|c| slope(c.z) != 1.0);
    if !is_turned {
        return old;
    }
    let [a, b, c] = corners.map(|p| DVec3::new(p.x, p.y, steps.at(p.z)));
    [(b - a).cross(c - a).try_normalize().map_or(old[0], encode_normal); 3]
}

/// The normal of a face, upwards whichever way it was turned, packed.
fn upward(face: &Face) -> u32 {
    let normal = face.normal();
    let up = if normal.z < 0.0 { -normal } else { normal };
    encode_normal(up.try_normalize().unwrap_or(DVec3::Z))
}

/// The plane of a triangle that was in the plane `group` of the source.
fn plane_key(source: &Source, group: u32, corners: &[DVec3; 3], change: &Change) -> PlaneKey {
    let level = |z: f64| PlaneKey::Level((z * 1e6).round() as i64);
    let steps = match change {
        Change::Level { z, .. } => return level(*z),
        _ if group == 0 => return PlaneKey::None,
        Change::None | Change::Gone => return PlaneKey::Old(group),
        Change::Steps(steps) => steps,
    };
    let Plane { normal, offset } = source.model.plane_equations[group as usize - 1];
    let (is_below, is_above) = (corners.iter().all(|c| c.z <= steps.knee), corners.iter().all(|c| c.z >= steps.knee));
    match normal.z {
        0.0 => PlaneKey::Old(group),
        z if z.abs() == 1.0 => level(steps.at(offset * z)),
        _ if is_below || is_above => {
            let (offset, slope) = steps.piece(is_above);
            PlaneKey::Moved(group, [offset.to_bits(), slope.to_bits()])
        }
        _ => PlaneKey::None,
    }
}

/// The plane that a key means; none for [`PlaneKey::None`].
fn plane_of(source: &Source, key: PlaneKey) -> Option<Plane> {
    let old = |group: u32| source.model.plane_equations[group as usize - 1];
    match key {
        PlaneKey::None => None,
        PlaneKey::Old(group) => Some(old(group)),
        PlaneKey::Ground(number, lift) => Some(source.ground.as_ref()?.plane(number, f64::from_bits(lift))),
        PlaneKey::Level(z) => Some(Plane { normal: DVec3::Z, offset: z as f64 * 1e-6 }),
        PlaneKey::Moved(group, bits) => {
            // n · p = k at old heights (z − offset) / slope.
            let Plane { normal, offset } = old(group);
            let [moved, slope] = bits.map(f64::from_bits);
            let n = DVec3::new(normal.x, normal.y, normal.z / slope);
            let length = n.length();
            Some(Plane { normal: n.try_normalize()?, offset: (offset + normal.z * moved / slope) / length })
        }
    }
}

/// Appends chunks to a model; returns their heights.
pub(super) fn append(target: &mut Target, source: &Source, chunks: impl IntoIterator<Item = Chunk>) -> Vec<[f32; 3]> {
    let mut numbers: FxHashMap<PlaneKey, u32> = FxHashMap::default();
    let mut heights = Vec::new();
    for chunk in chunks {
        let vertices: Vec<Vertex> = chunk
            .vertices
            .iter()
            .map(|vertex| Vertex { surface: target.surface(source.model, vertex.surface), ..*vertex })
            .collect();
        let grids: Vec<u32> = source.model.steps.iter().map(|step| target.grid(*step)).collect();
        let all = &mut target.model;
        let (first_vertex, first_index) = (all.vertices.len() as u32, all.indices.len() as u32);
        let (first_tile, first_geometry) = (all.tiles.len() as u32, all.geometries.len() as u32);
        let (first_texcoord, first_triangle) = (all.texcoords.len() as u32, all.planes.len() as u32);
        let later = |range: &std::ops::Range<u32>, first: u32| range.start + first..range.end + first;
        all.tiles.extend(chunk.tiles.into_iter().map(|tile| Tile {
            geometry: tile.geometry + first_geometry,
            vertices: later(&tile.vertices, first_vertex),
            indices: later(&tile.indices, first_index),
            texcoords: if tile.texcoords == NONE { NONE } else { tile.texcoords + first_texcoord },
            ..tile
        }));
        all.geometries.extend(chunk.geometries.into_iter().map(|g| Geometry {
            tiles: later(&g.tiles, first_tile),
            grid: grids.get(g.grid as usize).copied().unwrap_or_default(),
            ..g
        }));
        let cuts = chunk.cut_polygons.into_iter();
        all.cut_polygons.extend(cuts.map(|cut| CutTriangle { triangle: cut.triangle + first_triangle, ..cut }));
        all.vertices.extend(vertices);
        all.texcoords.extend(chunk.texcoords);
        all.indices.extend(chunk.indices);
        for key in chunk.planes {
            let number = *numbers.entry(key).or_insert_with(|| match plane_of(source, key) {
                None => 0,
                Some(plane) => {
                    all.plane_equations.push(plane);
                    all.plane_equations.len() as u32
                }
            });
            all.planes.push(number);
        }
        heights.extend(chunk.heights);
    }
    heights
}
