//! Which city objects some volumes hold or touch.

use std::borrow::Borrow;

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::{
    city::Geometry,
    geom::{Aabb, Volume},
    lens::{intersection, solids::ShownCity},
    render::{placed_region::PlacedRegion, volume::LensVolume},
};

/// A region, and the box beyond which nothing of it counts, metres.
pub type Area<'a> = (&'a PlacedRegion, Aabb);

/// The bodies of some volumes.
pub fn areas<V: Borrow<LensVolume>>(volumes: &[V]) -> Vec<Area<'_>> {
    volumes.iter().map(|v| v.borrow()).map(|v| (&v.region, v.bounds)).collect()
}

/// City objects of which a shown triangle meets one of the bodies; exact in f64.
pub fn objects_meeting(city: ShownCity, areas: &[Area]) -> FxHashSet<u32> {
    let model = city.model;
    let convex: Vec<Volume> = areas.iter().filter_map(|(b, _)| b.volume()).filter(|v| v.is_convex()).cloned().collect();
    let mut met: FxHashSet<u32> = match convex.is_empty() {
        true => Default::default(),
        false => {
            intersection::objects_meeting(model, city.index(), &intersection::regions(&[&convex])).into_iter().collect()
        }
    };
    let others: Vec<&Area> = areas.iter().filter(|(region, _)| !region.is_convex()).collect();
    let geometries = if others.is_empty() { &[][..] } else { city.geometries };
    for geometry in geometries.iter().map(|&g| &model.geometries[g as usize]) {
        if met.contains(&geometry.object) {
            continue;
        }
        let near: Vec<_> = others.iter().filter(|(_, bounds)| bounds.meets(&geometry.bounds)).collect();
        let hit = |tile: &crate::city::Tile| {
            (tile.indices.start as usize..tile.indices.end as usize).step_by(3).any(|i| {
                let corners = [0, 1, 2].map(|k| model.position(tile, tile.vertices.start + model.indices[i + k]));
                near.iter().any(|(region, _)| region.meets(&corners, geometry.object))
            })
        };
        if !near.is_empty() && model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize].iter().any(hit) {
            met.insert(geometry.object);
        }
    }
    met
}

/// Those of some objects of which a shown corner is in none of the bodies.
pub fn with_corners_outside(city: ShownCity, objects: &FxHashSet<u32>, areas: &[Area]) -> FxHashSet<u32> {
    let is_in = |corner: DVec3, object| areas.iter().any(|(region, _)| region.meets(&[corner; 3], object));
    let is_cut = |geometry: &&Geometry| {
        let tiles = &city.model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let mut corners = tiles.iter().flat_map(|t| t.vertices.clone().map(move |v| city.model.position(t, v)));
        objects.contains(&geometry.object) && corners.any(|corner| !is_in(corner, geometry.object))
    };
    let geometries = city.geometries.iter().map(|&g| &city.model.geometries[g as usize]);
    geometries.filter(is_cut).map(|geometry| geometry.object).collect()
}

/// The objects that some bodies hold, one per object of the city: those that touch one of them, with all that they are part of (but for
/// groups) and all parts of that; with `whole` without those of which some shown corner is in none. What others stand on (terrain, water,
/// roads, land use) is never among them. `types`: of what is part of nothing; empty: all.
pub fn enclosed(city: ShownCity, areas: &[Area], whole: bool, types: &[String]) -> Vec<bool> {
    let model = city.model;
    let kinds: Vec<_> = types.iter().filter_map(|name| model.strings.find(name)).collect();
    let is_wanted = |mut object: u32| {
        // As far as ways up go, whatever files say of parents and parts.
        for _ in 0..model.objects.len() {
            let Some(parent) = wholes(city, object).next() else { break };
            object = parent;
        }
        types.is_empty() || kinds.contains(&model.objects[object as usize].kind)
    };
    let mut met = objects_meeting(city, areas);
    met.retain(|&object| !model.objects[object as usize].class.is_ground() && is_wanted(object));
    let mut held = all_of(city, &met);
    if whole {
        let mine = (0..model.objects.len() as u32).filter(|&object| held[object as usize]).collect();
        let cut = with_corners_outside(city, &mine, areas);
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
