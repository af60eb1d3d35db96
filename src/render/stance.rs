//! The city of a studio as it is at a moment: what moves by a timetable is put where it is then, on the host, for all that asks where things
//! are - occluders, points of interest, best views, lenses that are made of objects or hang on them -, and attributes that change have
//! the values of then, for all that asks of these: choices, texts.
//!
//! The GPU has each of these objects as its file has it, and places it ([`crate::render::moving`]); of the moments that lenses show, the host
//! goes by that of the scene.

use std::sync::{Arc, OnceLock};

use glam::DQuat;

use crate::{
    city::{
        CityModel, decode_normal, encode_normal,
        model::{Geometry, Value, Vertex},
        spatial::SpatialIndex,
    },
    geom::Aabb,
    lens::{Lens, Placement as Attached, Region},
    render::{epochs::Epochs, moving::placement, standing::Placement},
    scene::{PoiPlace, Scene},
    time::Moment,
};

/// Where the city of a studio stands.
#[derive(Clone, Debug, Default)]
pub(super) struct Stance {
    /// The city as its file has it, once something of it was put elsewhere.
    file: Option<Arc<CityModel>>,
    /// Its geometries that move, and what moves them.
    movers: Vec<(u32, usize)>,
    /// When it stands so; `None`: as its file has it.
    at: Option<Moment>,
    /// How often it was put elsewhere.
    pub count: u64,
}

impl Stance {
    /// The city as its file has it; `model`: as it stands.
    pub fn file<'a>(&'a self, model: &'a Arc<CityModel>) -> &'a Arc<CityModel> {
        self.file.as_ref().unwrap_or(model)
    }

    /// When it stands so.
    pub fn at(&self) -> Option<Moment> {
        self.at
    }

    /// Has a city, and what finds its triangles, stand as they do at a moment; whether they did not yet.
    pub fn put(
        &mut self,
        model: &mut Arc<CityModel>,
        index: &mut Arc<OnceLock<SpatialIndex>>,
        at: Option<Moment>,
    ) -> bool {
        if at == self.at {
            return false;
        }
        self.at = at;
        self.count += 1;
        let file = match &self.file {
            Some(file) => file.clone(),
            None => {
                self.movers = movers(model);
                self.file.insert(model.clone()).clone()
            }
        };
        let model = Arc::make_mut(model);
        give_values(model, &file, at);
        let mut tiles = Vec::new();
        for &(geometry, mover) in &self.movers {
            put(model, &file, geometry, &placement(&file.moves[mover].pose(at)));
            tiles.extend(file.geometries[geometry as usize].tiles.clone());
        }
        tiles.sort_unstable();
        if let Some(index) = Arc::make_mut(index).get_mut() {
            index.refit(model, |tile| tiles.binary_search(&tile).is_ok());
        }
        true
    }
}

/// The moment that a scene asks for, if it has something that asks where objects are, or which values they have.
pub(super) fn asked_for(scene: &Scene) -> Option<Option<Moment>> {
    // What is wrong with operators is told by who resolves the scene.
    let own = || Epochs::new(scene).ok().and_then(|epochs| epochs.own.first().and_then(|(moment, _)| *moment));
    asks_where(scene).then(own)
}

/// The geometries of a model that move, ascending, and what moves each.
fn movers(model: &CityModel) -> Vec<(u32, usize)> {
    if model.moves.is_empty() {
        return Vec::new();
    }
    let of = |(geometry, number): (&Geometry, u32)| Some((number, model.mover(geometry.object)?));
    model.geometries.iter().zip(0..).filter_map(of).collect()
}

/// Has objects whose attributes change over time have what holds at a moment; at none what the file has, the last.
fn give_values(model: &mut CityModel, file: &CityModel, at: Option<Moment>) {
    for (name, history) in &file.histories {
        for (object, values) in &history.of {
            let own = &file.objects[*object as usize].attributes;
            let Some(place) = own.clone().find(|i| file.attributes[*i as usize].name == *name) else { continue };
            let held = |at: Moment| {
                let after = values.partition_point(|(begin, _)| *begin <= Some(at));
                after.checked_sub(1).and_then(|i| values[i].1).unwrap_or(Value::Null)
            };
            model.attributes[place as usize].value = at.map_or(file.attributes[place as usize].value, held);
        }
    }
}

/// Puts a geometry, which the file has elsewhere.
fn put(model: &mut CityModel, file: &CityModel, geometry: u32, placement: &Placement) {
    let own = &file.geometries[geometry as usize];
    let mut all = Aabb::EMPTY;
    for number in own.tiles.clone() {
        let tile = &file.tiles[number as usize];
        let places: Vec<_> = tile.vertices.clone().map(|v| placement.point(file.position(tile, v))).collect();
        let origin = match placement.is_none() {
            true => tile.origin,
            false => Aabb::from_points(places.iter().copied()).center().floor().as_ivec3(),
        };
        let mut bounds = Aabb::EMPTY;
        for (vertex, place) in tile.vertices.clone().zip(&places) {
            let old = file.vertices[vertex as usize];
            let position = (*place - origin.as_dvec3()).as_vec3();
            // As they are rounded.
            bounds = bounds.union(Aabb::from_points([origin.as_dvec3() + position.as_dvec3()]));
            let normal = turned(old.normal, placement.rotation);
            model.vertices[vertex as usize] = Vertex { position: position.to_array(), normal, ..old };
        }
        let put = &mut model.tiles[number as usize];
        (put.origin, put.bounds) = (origin, bounds);
        all = all.union(bounds);
    }
    let is_kept = placement.is_none() || all.is_empty();
    model.geometries[geometry as usize].bounds = if is_kept { placement.boxed(&own.bounds) } else { all };
}

fn turned(normal: u32, rotation: DQuat) -> u32 {
    if rotation == DQuat::IDENTITY { normal } else { encode_normal(rotation * decode_normal(normal)) }
}

/// Whether something of a scene asks where objects are.
fn asks_where(scene: &Scene) -> bool {
    let is_of_objects = |region: &Region| !matches!(region, Region::Shape(_));
    let asks = |lens: &&Lens| {
        matches!(lens.placement, Attached::Object(_) | Attached::Poi(_))
            || lens.shapes.iter().any(|shape| shape.any(&is_of_objects))
            || lens.deform().is_some()
            || lens.kind.has_overlay()
    };
    scene.lenses.iter().filter(|lens| lens.enabled).any(|lens| asks(&lens))
        || scene.pois.iter().any(|poi| matches!(poi.place, PoiPlace::Object(_)))
}
