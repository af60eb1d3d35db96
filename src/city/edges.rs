//! Edges of polygons: what a line drawing of the city shows, never the diagonals of triangulation.
//!
//! Found when they are asked for, from the triangles alone. Polygons do not share vertices in the model, and all triangles
//! of one name its corners by the same vertices, so in a tile a pair of vertices that two triangles name is a diagonal,
//! and one that a single triangle names is part of a ring. Where tiles cut a polygon, [`CityModel::cut_polygons`]
//! tells. Polygons of one geometry meet where positions are equal to the bit.
//!
//! ```text
//! triangles ──> pairs of vertices, named once (rings) ──> welded by position ──> faces at each edge ──> class
//! ```

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::city::model::{CityModel, Lod, NONE, ObjectClass, decode_normal, encode_normal};

/// Faces on one side of an edge that differ by less than this lie on each other, degrees.
const SAME_SIDE_DEG: f64 = 1.0;
/// Normals of one corner in two faces that differ by less are the same, degrees.
const SAME_NORMAL_DEG: f64 = 3.0;
/// An edge this sharp is a crease although its normals were smoothed, degrees: exporters average those of boxes too.
const SHARP_DEG: f64 = 75.0;

/// The relation of an edge to the faces at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum EdgeClass {
    /// All faces lie on one side of it, on each other: nearly always there is one.
    Border = 0,
    /// The faces turn by more than the crease angle, or they are more than two sides.
    Crease = 1,
    /// A border of polygons between faces that go on as one.
    Flat = 2,
}

/// The angle by which faces must turn at an edge for it to be a crease, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseAngles {
    /// Between polygons.
    pub polygons_deg: f64,
    /// In triangle meshes without levels of detail (glTF, OBJ); what is less is no edge at all.
    pub meshes_deg: f64,
    /// In relief, so that its triangles are no tangle of lines.
    pub terrain_deg: f64,
}

impl Default for CreaseAngles {
    fn default() -> Self {
        Self { polygons_deg: 5.0, meshes_deg: 20.0, terrain_deg: 30.0 }
    }
}

/// The extent of a face from its edge, metres; never less, and more where the face is slanted in its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Inward, across the edge.
    pub inward_m: f32,
    /// Along the edge, before its start.
    pub before_m: f32,
    /// Along the edge, beyond its end.
    pub beyond_m: f32,
}

/// An edge of a geometry. Seen from the front of its first face, that face is left of the way from start to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Start and end, metres from the tile's origin; the very floats of the vertices.
    pub ends: [[f32; 3]; 2],
    /// Normals of its first face and of the one that turns most from it, packed as in [`crate::city::model::Vertex`]; where
    /// the file turns the two differently, the second one's is reversed, so that they agree. A border repeats the first.
    pub normals: [u32; 2],
    /// The extents of the two faces from the edge.
    pub extents: [Extent; 2],
    /// Index of the tile, which says the geometry and so the object.
    pub tile: u32,
    /// A triangle of the first face: index into [`CityModel::planes`].
    pub triangle: u32,
    /// A triangle of the second face, and its tile; those of the first at a border.
    pub other: (u32, u32),
    /// Its class.
    pub class: EdgeClass,
}

/// The edges of the geometries `shown`: by geometry in that order, then by tile, then by place. No two of a geometry have
/// the same ends.
pub fn edges(model: &CityModel, shown: &[u32], angles: &CreaseAngles) -> Vec<Edge> {
    let found: Vec<Vec<Edge>> = shown
        .par_iter()
        .with_min_len(16)
        .map_init(Scratch::default, |scratch, &geometry| of_geometry(model, geometry, angles, scratch))
        .collect();
    found.concat()
}

/// Buffers kept between geometries.
#[derive(Default)]
struct Scratch {
    /// Pairs of vertices of a tile, the lower one in the high half, and the corner where the triangle's edge begins.
    pairs: Vec<(u64, u32)>,
    /// Parts of rings.
    sides: Vec<Side>,
    /// Position of every vertex of the geometry, as something that has an order, and its number.
    places: Vec<([u64; 3], u32)>,
    /// Number of the place of every vertex.
    place_of: Vec<u32>,
    /// Per vertex of a tile: another one of its polygon, or itself.
    fellow: Vec<u32>,
    /// Boxes around polygons, each where the first of its vertices stands, relative to its tile.
    boxes: Vec<(Vec3, Vec3)>,
}

/// One polygon's part of an edge.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// The places of its ends, the lower one in the high half.
    key: u64,
    /// Where its triangle goes from the higher place to the lower one.
    is_backward: bool,
    /// Where the triangle's edge begins: index into [`CityModel::indices`].
    corner: u32,
    tile: u32,
    /// Where the polygon's box stands.
    at_box: u32,
    /// The polygon's number, if tiles cut it.
    polygon: u32,
}

fn of_geometry(model: &CityModel, number: u32, angles: &CreaseAngles, scratch: &mut Scratch) -> Vec<Edge> {
    let Some(geometry) = model.geometries.get(number as usize) else { return Vec::new() };
    // Meshes have no polygons to tell: their triangles were never anything else.
    let is_mesh = geometry.lod == Lod::NONE && geometry.triangles <= geometry.polygons;
    let degrees = match model.objects[geometry.object as usize].class {
        ObjectClass::Terrain => angles.terrain_deg,
        _ if is_mesh => angles.meshes_deg,
        _ => angles.polygons_deg,
    };
    weld(model, geometry.tiles.clone(), scratch);
    gather_boxes(model, geometry.tiles.clone(), scratch);
    gather_sides(model, geometry.tiles.clone(), scratch);
    let mut edges = Vec::with_capacity(scratch.sides.len() / 2);
    for sides in scratch.sides.chunk_by_mut(|a, b| a.key == b.key) {
        let faces = without_cuts(sides);
        let edge = (!faces.is_empty()).then(|| edge_of(model, faces, &scratch.boxes, degrees));
        edges.extend(edge.filter(|edge| !(is_mesh && edge.class == EdgeClass::Flat)));
    }
    if geometry.tiles.len() > 1 {
        edges.sort_by_key(|edge| edge.tile);
    }
    edges
}

/// Numbers the places of all vertices: ascending with x, y, z, whatever the order of the file.
fn weld(model: &CityModel, tiles: std::ops::Range<u32>, scratch: &mut Scratch) {
    let Scratch { places, place_of, .. } = scratch;
    places.clear();
    let Some(first) = model.tiles.get(tiles.start as usize) else { return };
    for tile in &model.tiles[tiles.start as usize..tiles.end as usize] {
        // Exact: one tile has no shift, and where there are several, positions are on a grid that all of them hold.
        let shift = (tile.origin - first.origin).as_dvec3();
        let vertices = &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize];
        let numbers = places.len() as u32..;
        let place =
            |v: &crate::city::model::Vertex| (shift + Vec3::from(v.position).as_dvec3()).to_array().map(ordered);
        places.extend(vertices.iter().map(place).zip(numbers));
    }
    places.par_sort_unstable();
    place_of.clear();
    place_of.resize(places.len(), 0);
    let mut number = 0;
    for (i, (place, vertex)) in places.iter().enumerate() {
        number += u32::from(i > 0 && places[i - 1].0 != *place);
        place_of[*vertex as usize] = number;
    }
}

/// A finite number as bits of the same order; the zeros are one.
fn ordered(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// Finds boxes around polygons: triangles of one share vertices.
fn gather_boxes(model: &CityModel, tiles: std::ops::Range<u32>, scratch: &mut Scratch) {
    let Scratch { fellow, boxes, .. } = scratch;
    boxes.clear();
    fellow.clear();
    for number in tiles {
        let tile = &model.tiles[number as usize];
        let first = boxes.len();
        let vertices = &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize];
        fellow.extend(first as u32..(first + vertices.len()) as u32);
        for triangle in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
            let tops = [0, 1, 2].map(|k| top(fellow, first as u32 + triangle[k]));
            let least = tops[0].min(tops[1]).min(tops[2]);
            tops.into_iter().for_each(|vertex| fellow[vertex as usize] = least);
        }
        boxes.resize(first + vertices.len(), (Vec3::INFINITY, Vec3::NEG_INFINITY));
        for (vertex, number) in vertices.iter().zip(first as u32..) {
            let p = Vec3::from(vertex.position);
            let (low, high) = &mut boxes[top(fellow, number) as usize];
            (*low, *high) = (low.min(p), high.max(p));
        }
    }
}

/// The first vertex of a polygon that has this one; shortens the way there.
fn top(fellow: &mut [u32], mut vertex: u32) -> u32 {
    while fellow[vertex as usize] != vertex {
        let next = fellow[vertex as usize];
        fellow[vertex as usize] = fellow[next as usize];
        vertex = next;
    }
    vertex
}

/// Everything that one triangle of its polygon names, by place.
fn gather_sides(model: &CityModel, tiles: std::ops::Range<u32>, scratch: &mut Scratch) {
    let Scratch { pairs, sides, place_of, fellow, .. } = scratch;
    sides.clear();
    let is_cut = tiles.len() > 1;
    let mut first_vertex = 0;
    for number in tiles {
        let tile = &model.tiles[number as usize];
        pairs.clear();
        pairs.extend((tile.indices.start..tile.indices.end).map(|corner| {
            let [from, to] = vertices_of_side(model, corner);
            (u64::from(from.min(to)) << 32 | u64::from(from.max(to)), corner)
        }));
        pairs.par_sort_unstable();
        for alone in pairs.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1) {
            let corner = alone[0].1;
            let [from, to] = vertices_of_side(model, corner).map(|v| place_of[first_vertex + v as usize]);
            // Positions so close that the floats are equal.
            if from == to {
                continue;
            }
            sides.push(Side {
                key: u64::from(from.min(to)) << 32 | u64::from(from.max(to)),
                is_backward: from > to,
                corner,
                tile: number,
                at_box: top(fellow, first_vertex as u32 + vertices_of_side(model, corner)[0]),
                polygon: if is_cut { cut_polygon(model, corner / 3) } else { NONE },
            });
        }
        first_vertex += tile.vertices.len();
    }
    sides.par_sort_unstable_by_key(|side| (side.key, side.is_backward, side.corner));
}

/// The polygon of a triangle that tiles cut, or [`NONE`].
fn cut_polygon(model: &CityModel, triangle: u32) -> u32 {
    let cuts = &model.cut_polygons;
    cuts.binary_search_by_key(&triangle, |cut| cut.triangle).map_or(NONE, |at| cuts[at].polygon)
}

/// The vertices of a triangle's edge that begins at `corner`, counted within the tile.
fn vertices_of_side(model: &CityModel, corner: u32) -> [u32; 2] {
    [corner, next_corner(corner)].map(|corner| model.indices[corner as usize])
}

fn next_corner(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// Leaves out what two tiles have of one polygon: a diagonal. Changes the order of what is left only where there is one.
fn without_cuts(sides: &mut [Side]) -> &[Side] {
    if sides.len() < 2 || sides.iter().all(|side| side.polygon == NONE) {
        return sides;
    }
    let is_diagonal: Vec<bool> = sides
        .iter()
        .map(|side| side.polygon != NONE && sides.iter().filter(|other| other.polygon == side.polygon).count() == 2)
        .collect();
    let mut kept = 0;
    for (i, is_diagonal) in is_diagonal.into_iter().enumerate() {
        if !is_diagonal {
            sides.swap(kept, i);
            kept += 1;
        }
    }
    &sides[..kept]
}

/// A face as an edge sees it.
struct Face {
    /// Packed.
    normal: u32,
    /// Into the face, across the edge; unit, or zero where the normal runs along the edge.
    inward: DVec3,
    /// Whether its triangle has a normal per corner.
    is_smooth: bool,
}

/// The edge of `sides` (one at least), which all have its ends.
fn edge_of(model: &CityModel, sides: &[Side], boxes: &[(Vec3, Vec3)], crease_deg: f64) -> Edge {
    let faces: Vec<Face> = sides.iter().map(|side| face_of(model, side)).collect();
    let at_most = |degrees: f64| degrees.to_radians().cos();
    let along = |face: &Face| face.inward.dot(faces[0].inward);
    let is_beside = |face: &Face| along(face) >= at_most(SAME_SIDE_DEG);
    let goes_on = |face: &Face| -along(face) >= at_most(crease_deg);
    let is_smoothed = || {
        faces.len() == 2
            && faces.iter().any(|face| face.is_smooth)
            && -along(&faces[1]) >= at_most(SHARP_DEG)
            && agrees(model, &sides[0], &sides[1])
    };
    let class = if faces[1..].iter().all(is_beside) {
        EdgeClass::Border
    } else if faces[1..].iter().all(|face| is_beside(face) || goes_on(face)) || is_smoothed() {
        EdgeClass::Flat
    } else {
        EdgeClass::Crease
    };
    let second = match class {
        EdgeClass::Border => 0,
        _ => (1..faces.len())
            .filter(|&i| !is_beside(&faces[i]))
            .fold(0, |best, i| if best == 0 || along(&faces[i]).abs() < along(&faces[best]).abs() { i } else { best }),
    };
    let is_opposed = |i: usize| sides[i].is_backward != sides[0].is_backward;
    let is_turned = second > 0 && !is_opposed(second);
    let other = faces[second].normal;
    let [from, to] = [sides[0].corner, next_corner(sides[0].corner)];
    Edge {
        ends: [from, to].map(|corner| vertex(model, sides[0].tile, corner).position),
        normals: [faces[0].normal, if is_turned { encode_normal(-decode_normal(other)) } else { other }],
        extents: [0, second].map(|i| extent_of(model, &sides[i], &faces[i], boxes, is_opposed(i))),
        tile: sides[0].tile,
        triangle: from / 3,
        other: (sides[second].tile, sides[second].corner / 3),
        class,
    }
}

/// The extent of the box of a face from its edge; `is_opposed`: the edge goes from the side's end to its start.
fn extent_of(model: &CityModel, side: &Side, face: &Face, boxes: &[(Vec3, Vec3)], is_opposed: bool) -> Extent {
    let mut ends =
        [side.corner, next_corner(side.corner)].map(|corner| Vec3::from(vertex(model, side.tile, corner).position));
    if is_opposed {
        ends.reverse();
    }
    let (low, high) = boxes[side.at_box as usize];
    let reach = |from: Vec3, direction: Vec3| {
        let farthest = Vec3::select(direction.cmpge(Vec3::ZERO), high, low);
        direction.dot(farthest - from).max(0.0)
    };
    let along = (ends[1] - ends[0]).normalize_or_zero();
    Extent {
        inward_m: reach(ends[0], face.inward.as_vec3()),
        before_m: reach(ends[0], -along),
        beyond_m: reach(ends[1], along),
    }
}

fn vertex(model: &CityModel, tile: u32, corner: u32) -> &crate::city::model::Vertex {
    let first = model.tiles[tile as usize].vertices.start;
    &model.vertices[(first + model.indices[corner as usize]) as usize]
}

fn face_of(model: &CityModel, side: &Side) -> Face {
    let first = side.corner - side.corner % 3;
    let [a, b, c] = [first, first + 1, first + 2].map(|corner| vertex(model, side.tile, corner));
    let is_smooth = a.normal != b.normal || a.normal != c.normal;
    let normal = if is_smooth {
        let [a, b, c] = [a, b, c].map(|v| Vec3::from(v.position).as_dvec3());
        (b - a).cross(c - a).try_normalize().map_or(model_normal(side, model), encode_normal)
    } else {
        a.normal
    };
    let [from, to] = [side.corner, next_corner(side.corner)].map(|corner| {
        let position = vertex(model, side.tile, corner).position;
        Vec3::from(position).as_dvec3()
    });
    Face { normal, inward: decode_normal(normal).cross(to - from).normalize_or_zero(), is_smooth }
}

/// The packed normal of a side's first corner.
fn model_normal(side: &Side, model: &CityModel) -> u32 {
    vertex(model, side.tile, side.corner).normal
}

/// Whether two sides of an edge have the same normals at both ends.
fn agrees(model: &CityModel, a: &Side, b: &Side) -> bool {
    let normals = |side: &Side| {
        let mut corners = [side.corner, next_corner(side.corner)];
        if side.is_backward {
            corners.reverse();
        }
        corners.map(|corner| decode_normal(vertex(model, side.tile, corner).normal))
    };
    let least = SAME_NORMAL_DEG.to_radians().cos();
    normals(a).into_iter().zip(normals(b)).all(|(a, b)| a.dot(b) >= least)
}

#[cfg(test)]
mod tests;
