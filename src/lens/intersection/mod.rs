//! Which triangles and city objects lenses meet: exact in f64, by descent of the city's hierarchies.

use crate::{
    city::{CityModel, spatial::SpatialIndex},
    geom::{CommonPart, Volume},
};

/// What lenses, each the union of its volumes, have in common, as a union of convex regions; those that are empty are left
/// out. Of one lens: its volumes. Of none: nothing.
pub fn regions(lenses: &[&[Volume]]) -> Vec<CommonPart> {
    let Some((first, others)) = lenses.split_first() else { return Vec::new() };
    let alone: Vec<CommonPart> = first.iter().filter_map(|v| CommonPart::common(std::slice::from_ref(v))).collect();
    others.iter().fold(alone, |all, lens| {
        let both = |region: &CommonPart, volume: &Volume| {
            if !region.bounds().meets(&volume.bounds()) {
                return None;
            }
            CommonPart::common(&[region.volumes(), std::slice::from_ref(volume)].concat())
        };
        all.iter().flat_map(|region| lens.iter().filter_map(move |volume| both(region, volume))).collect()
    })
}

/// The shown triangles that share a point with any of the regions, as ascending indices into [`CityModel::planes`].
pub fn triangles_meeting(model: &CityModel, index: &SpatialIndex, regions: &[CommonPart]) -> Vec<u32> {
    let mut met = Vec::new();
    for region in regions {
        let visit = |_, triangle| {
            met.push(triangle);
            true
        };
        index.triangles_meeting(model, region, |_| true, visit);
    }
    met.sort_unstable();
    met.dedup();
    met
}

/// The city objects of which a shown triangle shares a point with any of the regions, as ascending indices.
pub fn objects_meeting(model: &CityModel, index: &SpatialIndex, regions: &[CommonPart]) -> Vec<u32> {
    let mut is_met = vec![false; model.objects.len()];
    let object_of = |tile: u32| model.geometries[model.tiles[tile as usize].geometry as usize].object as usize;
    for region in regions {
        let found = std::cell::RefCell::new(&mut is_met);
        let visit = |tile, _| {
            found.borrow_mut()[object_of(tile)] = true;
            false
        };
        index.triangles_meeting(model, region, |tile| !found.borrow()[object_of(tile)], visit);
    }
    (0..model.objects.len() as u32).filter(|&object| is_met[object as usize]).collect()
}

#[cfg(test)]
mod tests;
