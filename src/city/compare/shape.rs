//! Whether two objects have the same faces.
//!
//! ```text
//! both by level of detail ─ the same floats? ── yes ──> the same
//!                              │ no
//!        corners of the finer grid to those of the coarser, half a step away at most ── some have none ──> different
//!                              │
//!        triangles of both over these corners ── the same set ──> the same
//!                              │ those that only one has
//!        one state's against the other's, turned over: does each flat piece cancel out? ── yes ──> the same
//! ```
//!
//! The last step makes it independent of triangulation: a flat face is what its border says. It errs on the side of *different*.

use std::ops::Range;

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::city::{
    build::Lattice,
    model::{CityModel, Geometry, Lod},
};

/// What coordinates that are on no grid of their file (glTF, degrees, earth-centred ones) have for a step, metres, and at most those of
/// OBJ: how many decimals are written there says little.
pub const FLOAT_STEP_M: f64 = 0.001;
/// Beside half a step: models keep positions to 4 µm, which both states may be off.
const NOISE_M: f64 = 1.0 / 65_536.0;
/// Between corners of a face that is flat up to this many steps on either side, any triangulation is the same face.
const FLAT_STEPS: f64 = 4.0;
/// Faces that meet in one edge, at most, where triangulations differ: more of them are taken for different, so that time stays linear.
const MOST_AROUND: usize = 64;

/// An object of a state.
#[derive(Clone, Copy)]
pub(super) struct Shape<'a> {
    pub model: &'a CityModel,
    pub object: u32,
}

/// The geometries of an object of one level of detail.
type Level<'a> = Vec<&'a Geometry>;

/// Distinct corners, and triangles over them.
#[derive(Default)]
struct Soup {
    places: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// The step of the grid that a geometry stands on, as it is compared.
pub(super) fn step_of(model: &CityModel, geometry: &Geometry) -> DVec3 {
    let step = model.steps.get(geometry.grid as usize).copied().unwrap_or(Lattice::FINE.step);
    match geometry.lod {
        _ if step == Lattice::FINE.step => DVec3::splat(FLOAT_STEP_M),
        // Of a format without levels of detail.
        Lod::NONE => step.min(DVec3::splat(FLOAT_STEP_M)),
        _ => step,
    }
}

/// How far corners may be apart, along each axis, that stand on grids of these steps.
pub(super) fn tolerance(step: DVec3) -> DVec3 {
    0.5 * step + NOISE_M
}

/// Whether two objects have the same faces at every level of detail that one of both has.
pub(super) fn are_same(before: Shape, after: Shape) -> bool {
    let [mut old, mut new] = [before, after].map(|shape| shape.levels());
    let is_plain = |levels: &[(Lod, Level)]| levels.len() == 1 && levels[0].0 == Lod::NONE;
    if is_plain(&old) != is_plain(&new) && !old.is_empty() && !new.is_empty() {
        // A format without levels of detail has one of them: the finest, as programs write it.
        for levels in [&mut old, &mut new] {
            levels.drain(..levels.len() - 1);
            levels[0].0 = Lod::NONE;
        }
    }
    let are_levels_same = |(old, new): (&(Lod, Level), &(Lod, Level))| {
        old.0 == new.0
            && (are_identical(before.model, &old.1, after.model, &new.1)
                || are_alike(before.model, &old.1, after.model, &new.1))
    };
    old.len() == new.len() && old.iter().zip(&new).all(are_levels_same)
}

impl<'a> Shape<'a> {
    /// The levels of detail that have faces, coarse to fine.
    fn levels(self) -> Vec<(Lod, Level<'a>)> {
        let range = &self.model.objects[self.object as usize].geometries;
        let geometries = &self.model.geometries[range.start as usize..range.end as usize];
        let mut levels: Vec<(Lod, Level)> = Vec::new();
        for geometry in geometries.iter().filter(|geometry| geometry.triangles > 0) {
            match levels.iter_mut().find(|(lod, _)| *lod == geometry.lod) {
                Some((_, level)) => level.push(geometry),
                None => levels.push((geometry.lod, vec![geometry])),
            }
        }
        levels.sort_by_key(|(lod, _)| *lod);
        levels
    }
}

/// Whether both have the same floats in the same order, as an object has that no one touched.
fn are_identical(before: &CityModel, old: &[&Geometry], after: &CityModel, new: &[&Geometry]) -> bool {
    let tiles = |level: &[&Geometry]| level.iter().flat_map(|geometry| geometry.tiles.clone()).collect::<Vec<u32>>();
    let (old, new) = (tiles(old), tiles(new));
    let range = |range: &Range<u32>| range.start as usize..range.end as usize;
    let are_tiles_same = |(old, new): (&u32, &u32)| {
        let (old, new) = (&before.tiles[*old as usize], &after.tiles[*new as usize]);
        let (ours, theirs) = (&before.vertices[range(&old.vertices)], &after.vertices[range(&new.vertices)]);
        old.origin == new.origin
            && before.indices[range(&old.indices)] == after.indices[range(&new.indices)]
            && ours.iter().map(|vertex| vertex.position).eq(theirs.iter().map(|vertex| vertex.position))
    };
    old.len() == new.len() && old.iter().zip(&new).all(are_tiles_same)
}

/// Whether both have the same faces, in whatever order and however they are cut into triangles.
fn are_alike(before: &CityModel, old: &[&Geometry], after: &CityModel, new: &[&Geometry]) -> bool {
    let step = |model: &CityModel, level: &[&Geometry]| {
        level.iter().fold(DVec3::ZERO, |step, geometry| step.max(step_of(model, geometry)))
    };
    let steps = [step(before, old), step(after, new)];
    let [old, new] = [Soup::new(before, old), Soup::new(after, new)];
    let size = |side: usize| steps[side].max_element();
    let is_new_coarser = size(1) > size(0) || size(1) == size(0) && new.places.len() < old.places.len();
    let (coarse, fine) = if is_new_coarser { (new, old) } else { (old, new) };
    let step = steps[0].max(steps[1]);
    let Some(moved) = fine.snapped(&coarse.places, tolerance(step)) else { return false };
    let [ours, theirs] = apart(sorted(&coarse.triangles), sorted(&moved));
    cancel_out(&coarse.places, &ours, &theirs, FLAT_STEPS * step.max_element())
}

impl Soup {
    fn new(model: &CityModel, level: &[&Geometry]) -> Self {
        let mut soup = Self::default();
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        let mut numbers: Vec<u32> = Vec::new();
        for tile in level.iter().flat_map(|geometry| geometry.tiles.clone()).map(|tile| &model.tiles[tile as usize]) {
            numbers.clear();
            numbers.extend(tile.vertices.clone().map(|vertex| {
                // Zero has two signs.
                let place = model.position(tile, vertex) + 0.0;
                *known.entry(place.to_array().map(f64::to_bits)).or_insert_with(|| {
                    soup.places.push(place);
                    soup.places.len() as u32 - 1
                })
            }));
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            soup.triangles.extend(indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| numbers[t[k] as usize])));
        }
        soup
    }

    /// Its triangles over other corners: the nearest of them within a tolerance. `None`: a corner of either has none.
    fn snapped(&self, places: &[DVec3], tolerance: DVec3) -> Option<Vec<[u32; 3]>> {
        let net = Net::new(places, tolerance);
        let targets: Option<Vec<u32>> = self.places.iter().map(|place| net.nearest(*place)).collect();
        let targets = targets?;
        let mut is_met = vec![false; places.len()];
        targets.iter().for_each(|target| is_met[*target as usize] = true);
        let moved = self.triangles.iter().map(|triangle| triangle.map(|corner| targets[corner as usize]));
        is_met.iter().all(|is_met| *is_met).then(|| moved.collect())
    }
}

/// Places by cells of twice the tolerance, so that whatever is near is in eight of them.
struct Net<'a> {
    places: &'a [DVec3],
    tolerance: DVec3,
    /// The last place of each cell; `next` has the one before it.
    last: FxHashMap<[i64; 3], u32>,
    next: Vec<Option<u32>>,
}

impl<'a> Net<'a> {
    fn new(places: &'a [DVec3], tolerance: DVec3) -> Self {
        let mut this = Self { places, tolerance, last: FxHashMap::default(), next: Vec::with_capacity(places.len()) };
        for (number, place) in places.iter().enumerate() {
            let before = this.last.insert(this.cell(*place), number as u32);
            this.next.push(before);
        }
        this
    }

    fn cell(&self, place: DVec3) -> [i64; 3] {
        (place / (2.0 * self.tolerance)).floor().to_array().map(|c| c as i64)
    }

    /// The nearest place within the tolerance; of equally near ones the first by its coordinates.
    fn nearest(&self, at: DVec3) -> Option<u32> {
        let (low, high) = (self.cell(at - self.tolerance), self.cell(at + self.tolerance));
        let mut best: Option<(f64, [f64; 3], u32)> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut here = self.last.get(&[x, y, z]).copied();
                    while let Some(number) = here {
                        let place = self.places[number as usize];
                        let away = (place - at).abs();
                        let one = (away.length_squared(), place.to_array(), number);
                        if away.cmple(self.tolerance).all() && best.is_none_or(|best| one < best) {
                            best = Some(one);
                        }
                        here = self.next[number as usize];
                    }
                }
            }
        }
        best.map(|(_, _, number)| number)
    }
}

/// Triangles with three corners, each from its smallest, in order.
fn sorted(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let whole = triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a);
    let mut all: Vec<[u32; 3]> = whole
        .map(|&[a, b, c]| match a.min(b).min(c) {
            least if least == a => [a, b, c],
            least if least == b => [b, c, a],
            _ => [c, a, b],
        })
        .collect();
    all.sort_unstable();
    all
}

/// Of two sorted lists those that the other has not.
fn apart(ours: Vec<[u32; 3]>, theirs: Vec<[u32; 3]>) -> [Vec<[u32; 3]>; 2] {
    let (mut only_ours, mut only_theirs) = (Vec::new(), Vec::new());
    let (mut ours, mut theirs) = (ours.into_iter().peekable(), theirs.into_iter().peekable());
    loop {
        match (ours.peek(), theirs.peek()) {
            (Some(a), Some(b)) if a == b => {
                ours.next();
                theirs.next();
            }
            (Some(a), Some(b)) if a < b => only_ours.extend(ours.next()),
            (_, Some(_)) => only_theirs.extend(theirs.next()),
            (Some(_), None) => only_ours.extend(ours.next()),
            (None, None) => return [only_ours, only_theirs],
        }
    }
}

/// An edge of a triangle: its ends, the smaller first, and which way the triangle goes along it.
struct Edge {
    ends: [u32; 2],
    triangle: u32,
    sense: i32,
}

/// Whether triangles and others, turned over, cancel out piece by piece: pieces are joined by edges and lie in a layer of one plane, so each
/// that has no border left is the same face twice.
fn cancel_out(places: &[DVec3], ours: &[[u32; 3]], theirs: &[[u32; 3]], flat: f64) -> bool {
    let turned = theirs.iter().map(|&[a, b, c]| [a, c, b]);
    let triangles: Vec<[u32; 3]> = ours.iter().copied().chain(turned).collect();
    if triangles.is_empty() {
        return true;
    }
    let mut edges: Vec<Edge> = Vec::with_capacity(3 * triangles.len());
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        edges.extend([[a, b], [b, c], [c, a]].map(|[from, to]| Edge {
            ends: [from.min(to), from.max(to)],
            triangle: number as u32,
            sense: if from < to { 1 } else { -1 },
        }));
    }
    edges.sort_unstable_by_key(|edge| (edge.ends, edge.triangle));
    if edges.chunk_by(|a, b| a.ends == b.ends).any(|around| around.len() > MOST_AROUND) {
        return false;
    }
    let pieces = pieces(places, &triangles, &edges, flat);
    edges.sort_unstable_by_key(|edge| (pieces[edge.triangle as usize], edge.ends));
    let mut alike =
        edges.chunk_by(|a, b| (pieces[a.triangle as usize], a.ends) == (pieces[b.triangle as usize], b.ends));
    alike.all(|edges| edges.iter().map(|edge| edge.sense).sum::<i32>() == 0)
}

/// The piece of each triangle: from the largest that is in none, in its plane, along edges.
fn pieces(places: &[DVec3], triangles: &[[u32; 3]], edges: &[Edge], flat: f64) -> Vec<u32> {
    const OPEN: u32 = u32::MAX;
    let corners = |triangle: usize| triangles[triangle].map(|corner| places[corner as usize]);
    let normals: Vec<DVec3> = (0..triangles.len())
        .map(|triangle| {
            let [a, b, c] = corners(triangle);
            (b - a).cross(c - a)
        })
        .collect();
    // By edge of a triangle where its edge begins in `edges`.
    let mut around: Vec<[u32; 3]> = vec![[0; 3]; triangles.len()];
    let mut filled = vec![0_u8; triangles.len()];
    let mut first = 0;
    for (at, edge) in edges.iter().enumerate() {
        first = if edges[first].ends == edge.ends { first } else { at };
        let triangle = edge.triangle as usize;
        around[triangle][filled[triangle] as usize] = first as u32;
        filled[triangle] += 1;
    }
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let size = |triangle: &u32| normals[*triangle as usize].length_squared();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut pieces = vec![OPEN; triangles.len()];
    let mut open: Vec<u32> = Vec::new();
    for seed in order {
        if pieces[seed as usize] != OPEN {
            continue;
        }
        let normal = normals[seed as usize].normalize_or_zero();
        let origin = corners(seed as usize)[0];
        let is_inside =
            |triangle: u32| corners(triangle as usize).iter().all(|place| (*place - origin).dot(normal).abs() <= flat);
        pieces[seed as usize] = seed;
        open.push(seed);
        while let Some(triangle) = open.pop() {
            for first in around[triangle as usize] {
                let ends = edges[first as usize].ends;
                for edge in edges[first as usize..].iter().take_while(|edge| edge.ends == ends) {
                    if pieces[edge.triangle as usize] == OPEN && is_inside(edge.triangle) {
                        pieces[edge.triangle as usize] = seed;
                        open.push(edge.triangle);
                    }
                }
            }
        }
    }
    pieces
}
