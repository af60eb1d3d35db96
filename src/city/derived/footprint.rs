//! Footprints: what objects cover of the ground, seen from above, by its outline.
//!
//! A footprint is the union of the faces that lie on the ground where the object is pressed flat (`flat`), on a lattice of millimetres;
//! [`outline::union`] says how exact that is. What has too many crossings for an outline has that of its convex hull, and says so.

use super::{
    flat,
    moved::{Change, kept},
    source::{Source, Unit},
};
use glam::DVec2;
use rayon::prelude::*;

use crate::{
    city::{
        derived::form::{Form, LIFT_M},
        model::CityModel,
    },
    geom::outline::{self, Point},
};

/// Lattice units per metre.
const PER_M: f64 = 1000.0;

/// The ground that some objects cover.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// The objects whose faces it is made of: a root with its parts, or one object.
    pub objects: Vec<u32>,
    /// Its connected parts: each an outer ring counter-clockwise, then holes clockwise; metres, x east and y north.
    pub parts: Vec<Vec<Vec<DVec2>>>,
    /// Whether it is the convex hull of what is covered, which has too many crossings for an outline.
    pub is_hull: bool,
}

/// The footprints of what is `shown` of a city (indices of geometries), of each object by itself where `parts` says so. Objects that cover
/// nothing have none, nor have terrain, water, roads and land use.
pub fn footprints(model: &CityModel, shown: &[u32], parts: bool) -> Vec<Footprint> {
    let source = Source::new(model, shown, parts);
    source.units.par_iter().with_min_len(64).filter_map(|unit| footprint(&source, unit)).collect()
}

fn footprint(source: &Source, unit: &Unit) -> Option<Footprint> {
    let change = flat::change(source, unit, &Form::Flat { lift_m: LIFT_M });
    if change == Change::Gone {
        return None;
    }
    let origin = unit.bounds.min.truncate().floor();
    let on_lattice = |p: DVec2| -> Point { ((p - origin) * PER_M).round().to_array().map(|x| x as i64) };
    let seen = source.faces_of(unit).filter(|face| kept(source, face, &change).is_some());
    let faces: Vec<[Point; 3]> = seen.map(|face| face.corners.map(|p| on_lattice(p.truncate()))).collect();
    let mut figure = outline::union(&faces);
    let is_hull = figure.is_empty();
    if is_hull {
        let hull = outline::convex(faces.iter().flatten().copied());
        figure = if hull.len() < 3 { Vec::new() } else { vec![vec![hull]] };
    }
    let mut objects: Vec<u32> = source.geometries_of(unit).map(|geometry| geometry.object).collect();
    objects.sort_unstable();
    objects.dedup();
    let metres = |p: &Point| origin + DVec2::new(p[0] as f64, p[1] as f64) / PER_M;
    let ring = |ring: &Vec<Point>| ring.iter().map(metres).collect();
    let parts = figure.iter().map(|part| part.iter().map(ring).collect()).collect();
    (!figure.is_empty()).then_some(Footprint { objects, parts, is_hull })
}
