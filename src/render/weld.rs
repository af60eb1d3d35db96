//! Vertices that faces share.
//!
//! The model keeps a vertex per corner and face, because faces differ in surface and normal. On the GPU
//! whatever is flat over a face comes from the triangle's *provoking* vertex alone, so faces may share
//! every other corner: a box needs eight or nine vertices, not twenty-four. On an adapter that is
//! bound by vertices, that is most of the frame.
//!
//! Each triangle is turned so that its provoking corner is a vertex that belongs to its surface; a vertex
//! belongs to one surface at most. Greedy; a corner is repeated only where all three are taken by other
//! surfaces. Triangles of a tile are taken in the order of their corners, not of the file: how a triangle is
//! turned shows in the last bit of its depth, and the same object from two files must look the same.

use glam::IVec3;
use rustc_hash::FxHashMap;

use crate::{city::NONE, render::layout::CityVertex};

/// One corner of a triangle as it comes in.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Relative to the tile's origin, metres.
    pub position: [f32; 3],
    /// Octahedral normal.
    pub normal: u32,
}

impl Corner {
    /// Its position, as something that has an order.
    fn place(self) -> [u32; 3] {
        self.position.map(f32::to_bits)
    }
}

/// What vertices must agree in to be shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct VertexKey {
    place: [u32; 3],
    /// 0 where normals are not compared.
    normal: u32,
}

/// Collects the triangles of one tile after the other.
#[derive(Debug)]
pub struct Weld {
    /// Whether vertices must agree in their normals to be shared, because normals are interpolated.
    smooth: bool,
    /// Which corner of a triangle flat values come from: 0 everywhere but in OpenGL, where it is 2.
    provoking: usize,
    /// Newest vertex at a place; the others follow by `next`.
    places: FxHashMap<VertexKey, u32>,
    next: Vec<u32>,
    first_of_tile: u32,
    origin: IVec3,
    /// Of the tile at work: surface and corners.
    waiting: Vec<(u32, [Corner; 3])>,
    /// Vertices so far.
    pub vertices: Vec<CityVertex>,
    /// Three per triangle.
    pub indices: Vec<u32>,
}

impl Weld {
    /// Nothing yet.
    pub fn new(smooth: bool, provoking: usize) -> Self {
        Self {
            smooth,
            provoking,
            places: FxHashMap::default(),
            next: Vec::new(),
            first_of_tile: 0,
            origin: IVec3::ZERO,
            waiting: Vec::new(),
            vertices: Vec::new(),
            indices: Vec::new(),
        }
    }

    /// Gives the vertices of the last tile their final surfaces: `name` sees each vertex with the surface its triangles
    /// came with, or `NONE` where it speaks for none.
    pub fn rename_tile(&mut self, mut name: impl FnMut(&mut CityVertex)) {
        self.vertices[self.first_of_tile as usize..].iter_mut().for_each(&mut name);
    }

    /// What comes is relative to `origin`, whole metres.
    pub fn begin_tile(&mut self, origin: IVec3) {
        self.places.clear();
        self.next.clear();
        self.first_of_tile = self.vertices.len() as u32;
        self.origin = origin;
    }

    /// Adds a triangle of a surface to the tile.
    pub fn triangle(&mut self, surface: u32, mut corners: [Corner; 3]) {
        // The least corner first; its turn stays.
        let least = (0..3).min_by_key(|&k| corners[k].place()).unwrap_or(0);
        corners.rotate_left(least);
        self.waiting.push((surface, corners));
    }

    /// Takes up the tile's triangles.
    pub fn end_tile(&mut self) {
        let mut waiting = std::mem::take(&mut self.waiting);
        waiting.sort_by_key(|(_, corners)| corners.map(|c| c.place()));
        for (surface, corners) in waiting.drain(..) {
            self.take_up(surface, corners);
        }
        self.waiting = waiting;
    }

    fn take_up(&mut self, surface: u32, corners: [Corner; 3]) {
        let keys = corners.map(|c| VertexKey { place: c.place(), normal: if self.smooth { c.normal } else { 0 } });
        let heads = keys.map(|key| self.places.get(&key).copied());
        // The corner that speaks for the face: its own, else one that speaks for none, else a new place, else a copy.
        let owned = |wanted: u32| {
            (0..3).find_map(|k| heads[k].and_then(|head| self.at_place(head, wanted)).map(|vertex| (k, vertex)))
        };
        let (lead, vertex) = if let Some(found) = owned(surface).or_else(|| owned(NONE)) {
            found
        } else {
            let lead = (0..3).find(|&k| heads[k].is_none()).unwrap_or(0);
            (lead, self.add(keys[lead], corners[lead]))
        };
        let speaker = &mut self.vertices[vertex as usize];
        speaker.surface = surface;
        speaker.normal = corners[lead].normal;
        let mut turned = [vertex; 3];
        for (step, corner) in turned.iter_mut().enumerate().skip(1) {
            let k = (lead + step) % 3;
            // Looked up again: a triangle of two equal corners has just made one of them.
            *corner = match self.places.get(&keys[k]) {
                Some(&head) => head,
                None => self.add(keys[k], corners[k]),
            };
        }
        turned.rotate_right(self.provoking);
        self.indices.extend(turned);
    }

    /// The vertex at a place that belongs to `surface` (`NONE`: to no face yet).
    fn at_place(&self, head: u32, surface: u32) -> Option<u32> {
        let mut vertex = head;
        loop {
            if self.vertices[vertex as usize].surface == surface {
                return Some(vertex);
            }
            vertex = self.next[(vertex - self.first_of_tile) as usize];
            if vertex == NONE {
                return None;
            }
        }
    }

    fn add(&mut self, key: VertexKey, corner: Corner) -> u32 {
        let number = self.vertices.len() as u32;
        let before = self.places.insert(key, number);
        self.next.push(before.unwrap_or(NONE));
        self.vertices.push(CityVertex {
            origin: self.origin.to_array(),
            surface: NONE,
            position: corner.position,
            normal: corner.normal,
        });
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The six faces of a box, two triangles each, counter-clockwise from outside.
    fn cube() -> Vec<(u32, [[f32; 3]; 3])> {
        let at = |i: u32| [(i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32];
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        faces
            .iter()
            .enumerate()
            .flat_map(|(s, f)| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]].map(|t| (s as u32, t.map(at))))
            .collect()
    }

    fn welded(triangles: &[(u32, [[f32; 3]; 3])], smooth: bool, provoking: usize) -> Weld {
        let mut weld = Weld::new(smooth, provoking);
        weld.begin_tile(IVec3::new(5, 6, 7));
        for (surface, corners) in triangles {
            weld.triangle(*surface, corners.map(|position| Corner { position, normal: 100 + surface }));
        }
        weld.end_tile();
        weld
    }

    /// The least corner first, so that turned triangles compare equal and mirrored ones do not.
    fn turned(mut t: [[f32; 3]; 3]) -> [[u32; 3]; 3] {
        let least = (0..3).min_by(|&a, &b| t[a].partial_cmp(&t[b]).expect("numbers")).expect("three");
        t.rotate_left(least);
        t.map(|p| p.map(f32::to_bits))
    }

    /// Triangles as they come out, in a fixed order: corners, and the speaker's surface and normal.
    fn out(weld: &Weld, provoking: usize) -> Vec<([[u32; 3]; 3], u32, u32)> {
        let mut all: Vec<_> = weld
            .indices
            .chunks_exact(3)
            .map(|t| {
                let vertices = [0, 1, 2].map(|k| weld.vertices[t[k] as usize]);
                let speaker = vertices[provoking];
                (turned(vertices.map(|v| v.position)), speaker.surface, speaker.normal)
            })
            .collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn every_triangle_keeps_its_corners_its_turn_and_its_surface() {
        let mut expected: Vec<_> = cube().iter().map(|(s, t)| (turned(*t), *s, 100 + s)).collect();
        expected.sort_unstable();
        for provoking in [0, 2] {
            let weld = welded(&cube(), false, provoking);
            assert_eq!(out(&weld, provoking), expected);
            assert!(weld.vertices.iter().all(|v| v.origin == [5, 6, 7]));
        }
    }

    #[test]
    fn the_order_of_the_file_changes_nothing() {
        let (forward, mut backward) = (cube(), cube());
        backward.reverse();
        for (_, corners) in &mut backward {
            corners.rotate_left(1);
        }
        let [a, b] = [welded(&forward, false, 0), welded(&backward, false, 0)];
        assert_eq!((a.vertices, a.indices), (b.vertices, b.indices));
    }

    #[test]
    fn a_box_needs_hardly_more_than_its_corners() {
        // Eight would do; taking faces as they come costs one more. Without sharing there are 24.
        assert!((8..=9).contains(&welded(&cube(), false, 0).vertices.len()));
    }

    #[test]
    fn interpolated_normals_are_never_shared() {
        let smooth = welded(&cube(), true, 0);
        assert_eq!(smooth.vertices.len(), 24);
        for t in smooth.indices.chunks_exact(3) {
            let vertices = [0, 1, 2].map(|k| smooth.vertices[t[k] as usize]);
            assert!(vertices.iter().all(|v| v.normal == 100 + vertices[0].surface));
        }
    }

    #[test]
    fn a_corner_of_more_faces_than_vertices_is_repeated() {
        // Four surfaces on the very same triangle: three corners speak for three of them.
        let t = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let weld = welded(&[(0, t), (1, t), (2, t), (3, t)], false, 0);
        assert_eq!(weld.vertices.len(), 4);
        let mut speakers: Vec<u32> = out(&weld, 0).iter().map(|(_, surface, _)| *surface).collect();
        speakers.sort_unstable();
        assert_eq!(speakers, [0, 1, 2, 3]);
    }
}
