//! Facades: where the storeys and windows of walls without textures are.
//!
//! Each wall of a building gets coordinates as textures have them: windows along it, storeys up. They are the city's own, so they stay on walls that
//! are moved, bent or copied; `pass/geometry.wgsl` draws by them.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, NONE, ObjectClass, StringId, Value},
    render::{
        city::{Shown, corners_of},
        layout,
        surfaces::part_of,
        textures::Textures,
    },
};

/// Height of a storey, where nothing says it, and what is taken for one, metres.
const STOREY_M: f64 = 3.0;
const STOREYS_M: Range<f64> = 2.2..5.5;
/// From one window to the next, metres.
const BAY_M: f64 = 2.4;
/// The narrowest wall that has a window, metres.
const LEAST_WIDTH_M: f64 = 1.7;
/// Windows and storeys of a wall, at most.
const MOST: u32 = 200;
/// The part of a storey that is not told from a whole one.
const ROOM: f64 = 0.15;
/// Walls of one plane: by how much their normals (sine of the angle) and their distances from the origin (metres) may differ; what is nearer along it than
/// this goes on.
const TURNED: f64 = 0.02;
const APART_M: f64 = 0.05;
/// Attributes that say how many storeys a building has above the ground.
const STOREYS: [&str; 6] =
    ["storeysAboveGround", "storeys_above_ground", "b3_bouwlagen", "numberOfStoreys", "building:levels", "storeys"];

/// The numbers of storeys of walls stand in the first coordinate, in steps of this; windows are counted from [`FIRST_BAY`] on.
pub const STOREY_STEP: f64 = 256.0;
/// Windows begin here within a step: rounding leads to no other.
pub const FIRST_BAY: f64 = 16.0;

/// The facades of what is shown.
#[derive(Debug, Default)]
pub(super) struct Facades {
    walls: Vec<Wall>,
    /// The wall of each triangle of the model, where it has one: its number + 1.
    of_triangles: FxHashMap<u32, u32>,
}

/// A wall with storeys.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wall {
    /// Along it, level and unit.
    along: DVec2,
    /// Where it begins along it, and how wide it is, metres.
    start: f64,
    width: f64,
    /// Where its building's first storey begins, and how high each is, metres.
    base: f64,
    storey: f64,
    bays: u32,
    storeys: u32,
}

impl Wall {
    /// The coordinates of a place on it.
    fn at(&self, place: DVec3) -> [f32; 2] {
        let bay = (self.along.dot(place.truncate()) - self.start) / self.width * f64::from(self.bays);
        let first = STOREY_STEP * f64::from(self.storeys) + FIRST_BAY;
        [(first + bay) as f32, ((place.z - self.base) / self.storey) as f32]
    }
}

/// An upright triangle.
struct Upright {
    triangle: u32,
    corners: [DVec3; 3],
}

/// A stretch of a plane that walls cover without a gap.
struct Stretch {
    root: u32,
    along: DVec2,
    /// From where to where along it, metres.
    ends: Range<f64>,
    /// Its lowest place, and up to where all of its width is wall.
    low: f64,
    eaves: f64,
    triangles: Vec<u32>,
}

impl Facades {
    /// Those of what is shown; `textures`: those that are there.
    pub fn new(shown: &Shown, textures: &Textures) -> Self {
        let model = shown.model;
        let of_geometry = |&geometry: &u32| stretches(model, geometry, textures);
        let stretches: Vec<Stretch> = shown.geometries.par_iter().flat_map_iter(of_geometry).collect();
        let mut houses: FxHashMap<u32, Range<f64>> = FxHashMap::default();
        for stretch in &stretches {
            let own = houses.entry(stretch.root).or_insert(f64::INFINITY..f64::NEG_INFINITY);
            *own = own.start.min(stretch.low)..own.end.max(stretch.eaves);
        }
        let told = Told::new(model);
        let storeys: FxHashMap<u32, f64> =
            houses.iter().map(|(root, heights)| (*root, told.storey(*root, heights.end - heights.start))).collect();
        let mut facades = Self::default();
        for stretch in stretches {
            let (base, storey) = (houses[&stretch.root].start, storeys[&stretch.root]);
            let width = stretch.ends.end - stretch.ends.start;
            let count = ((stretch.eaves - base) / storey + ROOM).floor();
            if width < LEAST_WIDTH_M || count < 1.0 {
                continue;
            }
            facades.walls.push(Wall {
                along: stretch.along,
                start: stretch.ends.start,
                width,
                base,
                storey,
                bays: ((width / BAY_M).round() as u32).clamp(1, MOST),
                storeys: (count as u32).min(MOST),
            });
            let number = facades.walls.len() as u32;
            facades.of_triangles.extend(stretch.triangles.into_iter().map(|triangle| (triangle, number)));
        }
        facades
    }

    /// The coordinates of a triangle's corners; `None`: it is no wall with storeys. `triangle` counts from the model's first.
    pub fn of(&self, triangle: u32, corners: [DVec3; 3]) -> Option<[[f32; 2]; 3]> {
        let number = self.of_triangles.get(&triangle)?.checked_sub(1)?;
        let wall = self.walls.get(number as usize)?;
        Some(corners.map(|corner| wall.at(corner)))
    }
}

/// What attributes say of storeys.
struct Told<'a> {
    model: &'a CityModel,
    storeys: Vec<StringId>,
    height: Option<StringId>,
}

impl<'a> Told<'a> {
    fn new(model: &'a CityModel) -> Self {
        let storeys = STOREYS.iter().filter_map(|name| model.strings.find(name)).collect();
        Self { model, storeys, height: model.strings.find("measuredHeight") }
    }

    fn number(&self, object: u32, name: StringId) -> Option<f64> {
        match self.model.attribute(object, name)? {
            Value::Integer(number) => Some(number as f64),
            Value::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The height of a storey of a building whose walls are so high, metres.
    fn storey(&self, building: u32, height: f64) -> f64 {
        let count = self.storeys.iter().find_map(|name| self.number(building, *name)).filter(|count| *count >= 1.0);
        let measured = self.height.and_then(|name| self.number(building, name));
        let of_count = count.and_then(|count| {
            [Some(height), measured]
                .into_iter()
                .flatten()
                .map(|height| height / count.round())
                .find(|storey| STOREYS_M.contains(storey))
        });
        of_count.unwrap_or_else(|| {
            let even = height / (height / STOREY_M).round().max(1.0);
            if STOREYS_M.contains(&even) { even } else { STOREY_M }
        })
    }
}

/// The stretches of walls of a geometry; none where its windows are modelled, or where it is no building.
fn stretches(model: &CityModel, geometry: u32, textures: &Textures) -> Vec<Stretch> {
    let of = &model.geometries[geometry as usize];
    if model.objects[of.object as usize].class != ObjectClass::Building {
        return Vec::new();
    }
    let mut planes: Vec<(DVec2, f64, Vec<Upright>)> = Vec::new();
    let mut known: FxHashMap<[i64; 3], usize> = FxHashMap::default();
    for tile in &model.tiles[of.tiles.start as usize..of.tiles.end as usize] {
        for triangle in tile.indices.start / 3..tile.indices.end / 3 {
            let [first, ..] = corners_of(model, tile, triangle);
            let surface = &model.surfaces[first.surface as usize];
            if surface.kind != StringId(NONE)
                && matches!(model.strings.get(surface.kind), "Window" | "WindowSurface" | "Door" | "DoorSurface")
            {
                return Vec::new();
            }
            let material = model.materials.get(surface.material as usize);
            let is_textured =
                tile.texcoords != NONE && material.is_some_and(|m| m.textures().iter().any(|t| textures.has(*t)));
            if is_textured || part_of(model, surface, first.normal) != layout::PART_WALL {
                continue;
            }
            let corners = model.corners(tile, triangle);
            let Some(facing) = facing(corners) else { continue };
            let plane = plane_of(&mut planes, &mut known, facing, facing.dot(corners[0].truncate()));
            planes[plane].2.push(Upright { triangle, corners });
        }
    }
    let root = model.root(of.object);
    planes.into_iter().flat_map(|(facing, _, all)| cut_into_stretches(root, facing, all)).collect()
}

/// Where an upright triangle looks; `None`: it is not upright, or nothing.
fn facing([a, b, c]: [DVec3; 3]) -> Option<DVec2> {
    let normal = (b - a).cross(c - a).try_normalize()?;
    (normal.z.abs() < 0.2).then(|| normal.truncate().normalize_or(DVec2::X))
}

/// The number of the plane that looks there and is so far from the origin; a new one where there is none.
fn plane_of(
    planes: &mut Vec<(DVec2, f64, Vec<Upright>)>,
    known: &mut FxHashMap<[i64; 3], usize>,
    facing: DVec2,
    offset: f64,
) -> usize {
    // Distances turn with the direction, far from the origin by much: a plane is told by rounded numbers, or by those beside.
    let code = |v: f64, step: f64| (v / step).round() as i64;
    let own = [code(facing.x, 2.0 * TURNED), code(facing.y, 2.0 * TURNED), code(offset, 2.0 * APART_M)];
    for (x, y, d) in (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |d| (x, y, d)))) {
        let Some(&number) = known.get(&[own[0] + x, own[1] + y, own[2] + d]) else { continue };
        let (other, far, _) = &planes[number];
        if other.perp_dot(facing).abs() < TURNED && other.dot(facing) > 0.0 && (far - offset).abs() < APART_M {
            return number;
        }
    }
    known.insert(own, planes.len());
    planes.push((facing, offset, Vec::new()));
    planes.len() - 1
}

/// What walls of one plane cover without gaps.
fn cut_into_stretches(root: u32, facing: DVec2, all: Vec<Upright>) -> Vec<Stretch> {
    let along = DVec2::new(-facing.y, facing.x);
    let ends_of = |upright: &Upright| {
        let at = upright.corners.map(|corner| along.dot(corner.truncate()));
        at.into_iter().fold(f64::INFINITY..f64::NEG_INFINITY, |ends, s| ends.start.min(s)..ends.end.max(s))
    };
    let mut sorted: Vec<(Range<f64>, Upright)> = all.into_iter().map(|upright| (ends_of(&upright), upright)).collect();
    sorted.sort_by(|a, b| a.0.start.total_cmp(&b.0.start).then(a.1.triangle.cmp(&b.1.triangle)));
    let mut runs: Vec<(Range<f64>, Vec<Upright>)> = Vec::new();
    for (ends, upright) in sorted {
        match runs.last_mut() {
            Some((run, own)) if ends.start <= run.end + APART_M => {
                run.end = run.end.max(ends.end);
                own.push(upright);
            }
            _ => runs.push((ends, vec![upright])),
        }
    }
    let stretch = |(ends, own): (Range<f64>, Vec<Upright>)| {
        let corners = || own.iter().flat_map(|upright| upright.corners);
        let low = corners().map(|corner| corner.z).fold(f64::INFINITY, f64::min);
        // A gable is as high as its walls are at its ends.
        let high_at = |end: f64| {
            let near = corners().filter(|corner| (along.dot(corner.truncate()) - end).abs() <= 2.0 * APART_M);
            near.map(|corner| corner.z).fold(f64::NEG_INFINITY, f64::max)
        };
        let eaves = high_at(ends.start).min(high_at(ends.end));
        Stretch { root, along, low, eaves, triangles: own.iter().map(|upright| upright.triangle).collect(), ends }
    };
    runs.into_iter().map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(from: DVec3, to: DVec3, top: [f64; 2]) -> Vec<Upright> {
        let (a, b) = (from, to);
        let (c, d) = (b.with_z(top[1]), a.with_z(top[0]));
        let triangles = [[a, b, c], [a, c, d]];
        assert!(triangles.iter().all(|corners| facing(*corners) == Some(DVec2::NEG_Y)));
        triangles.into_iter().map(|corners| Upright { triangle: 0, corners }).collect()
    }

    #[test]
    fn a_wall_is_what_goes_on_and_a_gable_ends_at_its_eaves() {
        let mut all = wall(DVec3::ZERO, DVec3::new(6.0, 0.0, 0.0), [9.0, 9.0]);
        all.extend(wall(DVec3::new(6.02, 0.0, 0.0), DVec3::new(10.0, 0.0, 0.0), [9.0, 6.0]));
        all.extend(wall(DVec3::new(14.0, 0.0, 2.0), DVec3::new(15.0, 0.0, 2.0), [9.0, 9.0]));
        let found = cut_into_stretches(7, DVec2::NEG_Y, all);
        let told: Vec<_> =
            found.iter().map(|s| (s.ends.end - s.ends.start, s.low, s.eaves, s.triangles.len())).collect();
        assert_eq!(told, [(10.0, 0.0, 6.0, 4), (1.0, 2.0, 9.0, 2)]);
        assert!(facing([DVec3::ZERO, DVec3::X, DVec3::Y]).is_none(), "a floor");
    }

    #[test]
    fn coordinates_count_windows_and_storeys() {
        let wall = Wall { along: DVec2::X, start: 100.0, width: 12.0, base: 5.0, storey: 3.0, bays: 5, storeys: 3 };
        assert_eq!(wall.at(DVec3::new(100.0, 0.0, 5.0)), [3.0 * 256.0 + 16.0, 0.0]);
        assert_eq!(wall.at(DVec3::new(112.0, 0.0, 14.0)), [3.0 * 256.0 + 21.0, 3.0]);
        assert_eq!(wall.at(DVec3::new(106.0, 0.0, 9.5)), [3.0 * 256.0 + 18.5, 1.5]);
    }

    #[test]
    fn planes_are_told_far_from_the_origin() {
        let (mut planes, mut known) = (Vec::new(), FxHashMap::default());
        let facing = DVec2::from_angle(0.3);
        let first = plane_of(&mut planes, &mut known, facing, 446_000.0);
        assert_eq!(plane_of(&mut planes, &mut known, facing, 446_000.04), first);
        assert_ne!(plane_of(&mut planes, &mut known, -facing, 446_000.0), first, "the other side");
        assert_ne!(plane_of(&mut planes, &mut known, facing, 446_000.3), first);
    }
}
