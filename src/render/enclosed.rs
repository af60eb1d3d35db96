//! Which city objects some volumes hold or touch.

use std::borrow::Borrow;

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use crate::{
    city::{CityModel, Geometry, Tile},
    geom::{Aabb, Volume},
    lens::{intersection, solids::ShownCity},
    render::{displayed::Showing, placed_region::PlacedRegion, volume::LensVolume},
};

/// A region, and the box beyond which nothing of it counts, metres.
pub type Area<'a> = (&'a PlacedRegion, Aabb);

/// The bodies of some volumes.
pub fn areas<V: Borrow<LensVolume>>(volumes: &[V]) -> Vec<Area<'_>> {
    volumes.iter().map(|v| v.borrow()).map(|v| (&v.region, v.bounds)).collect()
}

/// City objects of which a triangle, where it is shown, meets one of the bodies: exact in f64, and to a centimetre where it is deformed.
pub fn objects_meeting(city: ShownCity, areas: &[Area], showing: &Showing) -> FxHashSet<u32> {
    let (convex, others): (Vec<&Area>, Vec<&Area>) =
        areas.iter().partition(|(region, _)| showing.is_nothing() && region.is_convex());
    let volumes: Vec<Volume> = convex.iter().filter_map(|(region, _)| region.volume()).cloned().collect();
    let mut met = meeting(city.model, if others.is_empty() { &[] } else { city.geometries }, &others, showing);
    if !volumes.is_empty() {
        // The hierarchy is of the city at rest.
        met.extend(intersection::objects_meeting(city.model, city.index(), &intersection::regions(&[&volumes])));
    }
    met
}

/// The same of any geometries of a model, without a hierarchy.
pub fn meeting(model: &CityModel, geometries: &[u32], areas: &[&Area], showing: &Showing) -> FxHashSet<u32> {
    let meets = |geometry: &Geometry| {
        let object = geometry.object;
        let near = |bounds: &Aabb| -> Vec<&Area> {
            let bounds = showing.bounds(object, bounds);
            areas.iter().copied().filter(|(_, own)| own.meets(&bounds)).collect()
        };
        if near(&geometry.bounds).is_empty() {
            return false;
        }
        let is_in = |near: &[&Area], corners: [DVec3; 3]| near.iter().any(|(region, _)| region.meets(&corners, object));
        let tiles = model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize].iter();
        let tiles: Vec<_> = tiles.map(|tile| (tile, near(&tile.bounds))).filter(|(_, near)| !near.is_empty()).collect();
        // Most have a corner in it; that asks for no finer triangles.
        let has_corner = |(tile, near): &(&Tile, Vec<&Area>)| {
            showing.corners(model, tile, object).any(|corner| is_in(near, [corner; 3]))
        };
        let has_triangle = |(tile, near): &(&Tile, Vec<&Area>)| {
            let shown = showing.tile(model, tile, object);
            shown.triangles.iter().any(|triangle| is_in(near, triangle.map(|corner| shown.corners[corner as usize])))
        };
        tiles.iter().any(has_corner) || tiles.iter().any(has_triangle)
    };
    let met = geometries.par_iter().map(|&g| &model.geometries[g as usize]).filter(|geometry| meets(geometry));
    met.map(|geometry| geometry.object).collect::<Vec<u32>>().into_iter().collect()
}

/// Those of some objects of which a shown corner is in none of the bodies.
pub fn with_corners_outside(
    city: ShownCity,
    objects: &FxHashSet<u32>,
    areas: &[Area],
    showing: &Showing,
) -> FxHashSet<u32> {
    let is_in = |corner: DVec3, object| areas.iter().any(|(region, _)| region.meets(&[corner; 3], object));
    let is_cut = |geometry: &&Geometry| {
        let tiles = &city.model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let mut corners = tiles.iter().flat_map(|tile| showing.corners(city.model, tile, geometry.object));
        objects.contains(&geometry.object) && corners.any(|corner| !is_in(corner, geometry.object))
    };
    let geometries = city.geometries.iter().map(|&g| &city.model.geometries[g as usize]);
    geometries.filter(is_cut).map(|geometry| geometry.object).collect()
}

/// What holds objects, as [`enclosed`] asks.
#[derive(Clone, Copy)]
pub struct Held<'a> {
    /// Those that are in them as a whole, or those that have a part in them.
    pub whole: bool,
    /// Of these types; none: of any.
    pub types: &'a [String],
}

/// The objects that some bodies hold, one per object of the city: those that touch one of them, with all that they are part of (but for
/// groups) and all parts of that; with `whole` without those of which some shown corner is in none. What others stand on (terrain, water,
/// roads, land use) is never among them. `types`: of what is part of nothing; empty: all.
pub fn enclosed(city: ShownCity, areas: &[Area], held: Held, showing: &Showing) -> Vec<bool> {
    let (model, Held { whole, types }) = (city.model, held);
    let kinds: Vec<_> = types.iter().filter_map(|name| model.strings.find(name)).collect();
    let is_wanted = |mut object: u32| {
        // As far as ways up go, whatever files say of parents and parts.
        for _ in 0..model.objects.len() {
            let Some(parent) = wholes(city, object).next() else { break };
            object = parent;
        }
        types.is_empty() || kinds.contains(&model.objects[object as usize].kind)
    };
    let mut met = objects_meeting(city, areas, showing);
    met.retain(|&object| !model.objects[object as usize].class.is_ground() && is_wanted(object));
    let mut held = all_of(city, &met);
    if whole {
        let mine = (0..model.objects.len() as u32).filter(|&object| held[object as usize]).collect();
        let cut = with_corners_outside(city, &mine, areas, showing);
        for (held, is_cut) in held.iter_mut().zip(all_of(city, &cut)) {
            *held &= !is_cut;
        }
    }
    held
}

/// Marks objects, what they are part of, and all parts of that.
fn all_of(city: ShownCity, objects: &FxHashSet<u32>) -> Vec<bool> {
    let model = city.model;
    let mut marked = vec![false; model.objects.len()];
    let mut next: Vec<u32> = objects.iter().copied().collect();
    while let Some(object) = next.pop() {
        // Each once, whatever files say of parents and parts.
        if !std::mem::replace(&mut marked[object as usize], true) {
            let is_group = is_group(city, object);
            let parts = model.objects[object as usize].children.iter().filter(|_| !is_group);
            next.extend(parts.copied().chain(wholes(city, object)));
        }
    }
    marked
}

/// What an object is part of. Of a group it is a member, not a part.
fn wholes(city: ShownCity<'_>, object: u32) -> impl Iterator<Item = u32> {
    let parents = city.model.objects[object as usize].parents.iter().copied();
    parents.filter(move |&parent| !is_group(city, parent))
}

fn is_group(city: ShownCity, object: u32) -> bool {
    city.model.strings.get(city.model.objects[object as usize].kind) == "CityObjectGroup"
}
