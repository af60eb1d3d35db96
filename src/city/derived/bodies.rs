//! Forms that are closed bodies of their own: faces on a lattice of millimetres, which the builder makes into a model, so that faces of
//! neighbours in one plane are known exactly.

use std::sync::Arc;

use super::{
    moved,
    source::{Face, Part, Source, Target, Unit},
};
use glam::DVec3;
use rayon::prelude::*;

use crate::{
    city::{
        build::{
            self,
            lattice::Lattice,
            points::Pool,
            raw::{Polygons, RawGeometry},
        },
        derived::form::{Derived, Form},
        model::{Lod, NONE, ObjectClass},
    },
    geom::outline,
};

/// Lattice units per metre.
const PER_M: f64 = 1000.0;

/// The triangles of a unit, on the lattice, that a body is made of.
pub(super) type Triangles = [[[i64; 3]; 3]];

/// Makes the body of a unit; `None` where it has none.
pub(super) type Make = fn(&Triangles, &Form) -> Option<Body>;

/// A closed body on the lattice.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    pub points: Vec<[i64; 3]>,
    /// Corners of rings; `surfaces` are numbers of [`Part`]s.
    pub polygons: Polygons,
}

impl Body {
    /// Adds a face of several rings, the outer one first.
    pub fn face(&mut self, part: Part, rings: impl IntoIterator<Item = Vec<[i64; 3]>>) {
        for ring in rings {
            let first = self.points.len() as u32;
            self.polygons.indices.extend(first..first + ring.len() as u32);
            self.polygons.ring_ends.push(self.polygons.indices.len() as u32);
            self.points.extend(ring);
        }
        self.polygons.polygon_ends.push(self.polygons.ring_ends.len() as u32);
        self.polygons.surfaces.push(part as u32);
    }

    /// Upright on a figure, from one height to another.
    pub fn upright(figure: &[outline::Part], [low, high]: [i64; 2]) -> Option<Self> {
        let mut body = Self::default();
        for rings in figure {
            let at = |z: i64| move |p: &outline::Point| [p[0], p[1], z];
            body.face(Part::Roof, rings.iter().map(|ring| ring.iter().map(at(high)).collect()));
            body.face(Part::Ground, rings.iter().map(|ring| ring.iter().rev().map(at(low)).collect()));
            for ring in rings {
                for (i, a) in ring.iter().enumerate() {
                    let b = &ring[(i + 1) % ring.len()];
                    body.face(Part::Wall, [vec![at(low)(a), at(low)(b), at(high)(b), at(high)(a)]]);
                }
            }
        }
        (low < high && !figure.is_empty()).then_some(body)
    }
}

/// Lowest and highest of some triangles.
pub(super) fn span(triangles: &Triangles) -> [i64; 2] {
    let heights = || triangles.iter().flatten().map(|p| p[2]);
    [heights().min().unwrap_or(0), heights().max().unwrap_or(0)]
}

/// The result for one unit: its body, and its materials.
struct Made {
    body: Option<Body>,
    looks: Looks,
}

/// The materials of a unit's largest roofs and walls; [`NONE`] where these have none of one colour.
#[derive(Clone, Copy, Debug)]
struct Looks {
    roof: u32,
    wall: u32,
}

/// The bodies of all units of a source, and beside them the units of another one of the same model as they are.
pub(super) fn derived(source: &Source, form: &Form, make: Make, beside: Option<&Source>) -> Derived {
    let mut target = Target::new(source.model);
    let origin = source.units.iter().map(|unit| unit.bounds.min).reduce(DVec3::min).unwrap_or_default().floor();
    let on_lattice = |p: DVec3| ((p - origin) * PER_M).round().to_array().map(|x| x as i64);
    let made = |unit: &Unit| {
        let triangles: Vec<_> = source.faces_of(unit).map(|face| face.corners.map(on_lattice)).collect();
        Made { body: make(&triangles, form), looks: looks(source, unit) }
    };
    let made: Vec<Made> = source.units.par_iter().with_min_len(64).map(made).collect();

    let mut points: Vec<[i64; 3]> = Vec::new();
    let mut bodies: Vec<(u32, Polygons)> = Vec::new();
    let mut unchanged: Vec<&Unit> = Vec::new();
    for (unit, Made { body, looks }) in source.units.iter().zip(made) {
        let Some(Body { points: own, mut polygons }) = body else {
            unchanged.push(unit);
            continue;
        };
        let surfaces = surfaces_of(&mut target, unit.object, looks);
        polygons.surfaces.iter_mut().for_each(|part| *part = surfaces[*part as usize]);
        let first = points.len() as u32;
        polygons.indices.iter_mut().for_each(|index| *index += first);
        points.extend(own);
        bodies.push((unit.object, polygons));
    }
    let pool = Arc::new(Pool { lattice: Lattice { step: DVec3::splat(1.0 / PER_M), origin }, points: points.into() });
    let raw = |(object, polygons)| RawGeometry { object, lod: Lod::NONE, solid: true, pool: pool.clone(), polygons };
    target.model = build::with_geometries(target.model, bodies.into_iter().map(raw));
    let chunk = unchanged.iter().fold(moved::Chunk::default(), |mut chunk, unit| {
        chunk.add(source, unit, &moved::Change::None);
        chunk
    });
    moved::append(&mut target, source, [chunk]);
    if let Some(beside) = beside {
        let chunk = beside.units.iter().fold(moved::Chunk::default(), |mut chunk, unit| {
            chunk.add(beside, unit, &moved::Change::None);
            chunk
        });
        moved::append(&mut target, beside, [chunk]);
    }
    Derived { model: target.finish(), unchanged: unchanged.len() as u32, ..Derived::default() }
}

/// The surfaces of a unit, one per [`Part`]. What is no building has none of its semantics.
fn surfaces_of(target: &mut Target, object: u32, looks: Looks) -> [u32; 3] {
    let class = target.model.objects[object as usize].class;
    let is_building = matches!(class, ObjectClass::Building | ObjectClass::Construction);
    let kinds = [("RoofSurface", looks.roof), ("WallSurface", looks.wall), ("GroundSurface", looks.wall)];
    kinds.map(|(kind, material)| target.own_surface(object, is_building.then_some(kind), material))
}

fn looks(source: &Source, unit: &Unit) -> Looks {
    if source.model.materials.is_empty() {
        return Looks { roof: NONE, wall: NONE };
    }
    let mut areas: [Vec<(u32, f64)>; 2] = Default::default();
    for face in source.faces_of(unit) {
        let list = match source.part(&face) {
            Part::Roof => &mut areas[0],
            Part::Wall => &mut areas[1],
            Part::Ground => continue,
        };
        let material = material_of(source, &face);
        let area = face.normal().length();
        match list.iter_mut().find(|(known, _)| *known == material) {
            Some((_, sum)) => *sum += area,
            None => list.push((material, area)),
        }
    }
    let [roof, wall] =
        areas.map(|list| list.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(NONE, |(material, _)| material));
    Looks { roof, wall }
}

/// The material of a face; none where a texture brings its colour.
fn material_of(source: &Source, face: &Face) -> u32 {
    let material = source.model.surfaces.get(face.surface as usize).map_or(NONE, |surface| surface.material);
    let found = source.model.materials.get(material as usize);
    if found.is_some_and(|m| m.texture == NONE) { material } else { NONE }
}
