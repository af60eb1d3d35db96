//! The city where deformations show it, on the host: for whatever asks which objects are where. Of what lies in lenses, tile by tile
//! ([`Showing`]); for occluders, to which anything may belong, as a whole ([`Displayed`]).
//!
//! Triangles are halved until they are within a centimetre of what they become, so that what is told from them is off by no more. Objects,
//! geometries and their numbers are those of the city at rest.

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    city::{
        CityModel, Tile,
        model::{NONE, Vertex},
        spatial::SpatialIndex,
    },
    geom::{
        Aabb,
        deform::{
            Deformers, Support,
            refine::{Limits, refined},
        },
    },
    lens::{Lens, Region, solids::ShownCity},
    render::{
        heights::Heights,
        moved::Moved,
        standing::{Placement, Standing},
    },
    scene::{Poi, PoiPlace, Scene},
};

/// How far an edge may be from what it becomes, metres.
const TOLERANCE_M: f64 = 0.01;
/// Triangles that one tile may become, at most: beyond, its edges are less exact.
const MOST_TRIANGLES: usize = 1 << 18;

/// A city where deformations show it.
#[derive(Debug)]
pub(super) struct Displayed {
    moved: Moved,
    /// The number of the city that is shown so.
    of: u64,
    model: CityModel,
    index: OnceLock<SpatialIndex>,
    number: u64,
}

/// The city as it was last shown, and how many there were so far.
#[derive(Debug, Default)]
pub(super) struct LastDisplayed {
    last: Option<Arc<Displayed>>,
    count: u64,
}

impl LastDisplayed {
    /// A city where deformations show it; `None` where they move nothing.
    pub fn of(&mut self, city: ShownCity, moved: &Moved) -> Option<Arc<Displayed>> {
        if moved.is_nothing() {
            return None;
        }
        if let Some(last) = self.last.as_ref().filter(|last| last.moved == *moved && last.of == city.number) {
            return Some(last.clone());
        }
        self.count += 1;
        let model = displayed(city, moved);
        let number = city.number + self.count;
        let made = Displayed { moved: moved.clone(), of: city.number, model, index: OnceLock::new(), number };
        Some(self.last.insert(Arc::new(made)).clone())
    }
}

impl Displayed {
    /// What is shown of it: the geometries that `city` shows at rest.
    pub fn shown<'a>(&'a self, city: ShownCity<'a>) -> ShownCity<'a> {
        ShownCity { model: &self.model, index: &self.index, number: self.number, ..city }
    }
}

/// A city and its points of interest, where a lens looks for them.
#[derive(Clone, Copy, Debug)]
pub struct Stand<'a> {
    /// The city, and what is shown of it.
    pub city: ShownCity<'a>,
    /// The points of interest.
    pub pois: &'a [Poi],
}

/// A city and its points of interest at rest, and where deformations show them.
pub(super) struct Stands<'a> {
    at_rest: Stand<'a>,
    displayed: Option<(Arc<Displayed>, Vec<Poi>)>,
}

impl<'a> Stands<'a> {
    /// What nothing moves, or nobody asks for where it is shown.
    fn at_rest(city: ShownCity<'a>, pois: &'a [Poi]) -> Self {
        Self { at_rest: Stand { city, pois }, displayed: None }
    }

    /// What deformations show elsewhere.
    fn displayed(city: ShownCity<'a>, pois: &'a [Poi], moved: &Moved, last: &mut LastDisplayed) -> Self {
        let place = |poi: &Poi| match poi.place {
            PoiPlace::At(at) => Poi { place: PoiPlace::At(moved.place(None, at)), ..poi.clone() },
            PoiPlace::Object(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => poi.clone(),
        };
        let displayed = last.of(city, moved).map(|displayed| (displayed, pois.iter().map(place).collect()));
        Self { at_rest: Stand { city, pois }, displayed }
    }

    /// The second only where a lens of the scene asks for it.
    pub fn of_scene(
        scene: &Scene,
        city: ShownCity<'a>,
        pois: &'a [Poi],
        moved: &Moved,
        last: &mut LastDisplayed,
    ) -> Self {
        if asks_where(scene) { Self::displayed(city, pois, moved, last) } else { Self::at_rest(city, pois) }
    }

    /// What is shown.
    pub fn shown(&self) -> Stand<'_> {
        self.displayed
            .as_ref()
            .map_or(self.at_rest, |(displayed, pois)| Stand { city: displayed.shown(self.at_rest.city), pois })
    }

    /// What a lens looks at.
    pub fn of_lens(&self, lens: &Lens) -> Stand<'_> {
        if looks_at_rest(lens) { self.at_rest } else { self.shown() }
    }
}

/// Whether some lens of a scene asks for what it looks for where that is shown: for occluders.
fn asks_where(scene: &Scene) -> bool {
    let is_asked = |region: &Region| matches!(region, Region::Occluders(_) | Region::Case { .. });
    let asks =
        |lens: &Lens| lens.enabled && !looks_at_rest(lens) && lens.shapes.iter().any(|shape| shape.any(&is_asked));
    scene.lenses.iter().any(asks)
}

/// Whether a lens looks for objects in the city at rest: where it says so, and where they tell what it moves.
pub(super) fn looks_at_rest(lens: &Lens) -> bool {
    lens.at_rest || lens.deform().is_some()
}

/// Where a city, or a content of one, is shown.
pub struct Showing<'a> {
    deformers: &'a Deformers,
    supports: Vec<&'a Support>,
    /// Of a city whose objects have some.
    heights: Option<&'a Heights>,
    placement: &'a Placement,
}

/// A tile where it is shown.
pub struct ShownTile {
    /// Metres.
    pub corners: Vec<DVec3>,
    /// By `corners`.
    pub triangles: Vec<[u32; 3]>,
    /// Of each corner one of the tile's that it has all else of.
    sources: Vec<u32>,
}

impl<'a> Showing<'a> {
    /// Of the scene's own city.
    pub fn of_city(moved: &'a Moved) -> Self {
        Self::of_content(moved, &Placement::NONE, true)
    }

    /// Of a content that stands so; `is_own`: its objects are those of the scene's own city, and are as high as these.
    pub fn of_content(moved: &'a Moved, placement: &'a Placement, is_own: bool) -> Self {
        let heights = (is_own && !moved.heights.is_empty()).then_some(&*moved.heights);
        Self { deformers: &moved.deformers, supports: moved.deformers.supports().collect(), heights, placement }
    }

    /// Whether all of it is shown where the city has it.
    pub fn is_nothing(&self) -> bool {
        self.supports.is_empty() && self.heights.is_none() && self.placement.is_none()
    }

    /// How an object stands before it is deformed.
    fn standing(&self, object: u32) -> Standing<'a> {
        let raised = self.heights.and_then(|heights| heights.of(object)).copied();
        Standing { raised, placement: self.placement }
    }

    /// Whether what stands in a box is shown where it stands.
    fn leaves(&self, bounds: &Aabb) -> bool {
        !self.supports.iter().any(|support| support.reaches(bounds))
    }

    /// A box around what of an object is in a box of its city.
    pub fn bounds(&self, object: u32, bounds: &Aabb) -> Aabb {
        let bounds = self.standing(object).boxed(bounds);
        if self.leaves(&bounds) { bounds } else { self.deformers.deformed_bounds(&bounds) }
    }

    /// The corners of a tile of an object.
    pub fn corners(&self, model: &CityModel, tile: &Tile, object: u32) -> impl Iterator<Item = DVec3> {
        let standing = self.standing(object);
        let is_left = self.leaves(&standing.boxed(&tile.bounds));
        let stands = tile.vertices.clone().map(move |vertex| standing.place(model.position(tile, vertex)));
        stands.map(move |place| if is_left { place } else { self.deformers.value(place) })
    }

    /// A tile of an object, in parts that are within a centimetre of what they become.
    pub fn tile(&self, model: &CityModel, tile: &Tile, object: u32) -> ShownTile {
        let standing = self.standing(object);
        let corners: Vec<DVec3> =
            tile.vertices.clone().map(|vertex| standing.place(model.position(tile, vertex))).collect();
        let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
        let (triangles, _) = indices.as_chunks::<3>();
        let bounds = Aabb::from_points(corners.iter().copied());
        if self.leaves(&bounds) {
            let sources = (0..corners.len() as u32).collect();
            return ShownTile { corners, triangles: triangles.to_vec(), sources };
        }
        let limits = Limits { triangles: MOST_TRIANGLES, ..Limits::default() };
        // A pixel is a metre.
        let made = refined(&corners, triangles, self.deformers, &|_| 1.0, TOLERANCE_M, limits);
        let first = corners.len() as u32;
        let kept = made.kept.iter().map(|&triangle| triangles[triangle as usize]);
        let bent = made.triangles.iter().map(|corners| corners.map(|corner| first + corner));
        ShownTile {
            triangles: kept.chain(bent).collect(),
            sources: (0..first).chain(made.vertices.iter().map(|v| triangles[v.source as usize][0])).collect(),
            corners: corners.into_iter().chain(made.vertices.iter().map(|v| v.shown)).collect(),
        }
    }
}

/// A tile of the model that is made, with numbers from 0.
struct MadeTile {
    tile: Tile,
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
}

impl MadeTile {
    /// A tile that is shown where it is.
    fn left(model: &CityModel, tile: &Tile) -> Self {
        let vertices = model.vertices[tile.vertices.start as usize..tile.vertices.end as usize].to_vec();
        let indices = model.indices[tile.indices.start as usize..tile.indices.end as usize].to_vec();
        let ends = [vertices.len() as u32, indices.len() as u32];
        let tile = Tile { vertices: 0..ends[0], indices: 0..ends[1], texcoords: NONE, ..tile.clone() };
        Self { tile, vertices, indices }
    }

    fn new(model: &CityModel, tile: &Tile, shown: &ShownTile) -> Self {
        let bounds = Aabb::from_points(shown.triangles.iter().flatten().map(|&corner| shown.corners[corner as usize]));
        let origin = bounds.center().floor().as_ivec3();
        let vertex = |(corner, source): (&DVec3, &u32)| Vertex {
            position: (*corner - origin.as_dvec3()).as_vec3().to_array(),
            ..model.vertices[(tile.vertices.start + source) as usize]
        };
        let vertices: Vec<Vertex> = shown.corners.iter().zip(&shown.sources).map(vertex).collect();
        let indices = shown.triangles.concat();
        let mut tile = Tile {
            origin,
            geometry: tile.geometry,
            vertices: 0..vertices.len() as u32,
            indices: 0..indices.len() as u32,
            texcoords: NONE,
            bounds,
        };
        // As they are rounded.
        let place =
            |index: &u32| tile.origin.as_dvec3() + glam::Vec3::from(vertices[*index as usize].position).as_dvec3();
        tile.bounds = Aabb::from_points(indices.iter().map(place));
        Self { tile, vertices, indices }
    }
}

/// The geometries of a city that it shows, where deformations show them; of all others nothing.
fn displayed(city: ShownCity, moved: &Moved) -> CityModel {
    let model = city.model;
    let showing = Showing::of_city(moved);
    let tiles: Vec<&Tile> = city.geometries.iter().flat_map(|&g| &model.tiles[tile_range(model, g)]).collect();
    let made: Vec<MadeTile> = tiles
        .par_iter()
        .map(|tile| {
            let object = model.geometries[tile.geometry as usize].object;
            match !showing.standing(object).is_moved() && showing.leaves(&tile.bounds) {
                true => MadeTile::left(model, tile),
                false => MadeTile::new(model, tile, &showing.tile(model, tile, object)),
            }
        })
        .collect();
    let mut out = CityModel {
        strings: model.strings.clone(),
        objects: model.objects.clone(),
        attributes: model.attributes.clone(),
        geometries: model.geometries.clone(),
        surfaces: model.surfaces.clone(),
        details: model.details.clone(),
        ..CityModel::default()
    };
    for geometry in &mut out.geometries {
        (geometry.tiles, geometry.triangles, geometry.bounds) = (0..0, 0, Aabb::EMPTY);
    }
    for MadeTile { tile, vertices, indices } in made {
        let (first_vertex, first_index, number) =
            (out.vertices.len() as u32, out.indices.len() as u32, out.tiles.len() as u32);
        let geometry = &mut out.geometries[tile.geometry as usize];
        if geometry.tiles.is_empty() {
            geometry.tiles = number..number;
        }
        geometry.tiles.end = number + 1;
        geometry.triangles += indices.len() as u32 / 3;
        geometry.bounds = geometry.bounds.union(tile.bounds);
        out.planes.extend(std::iter::repeat_n(0, indices.len() / 3));
        out.tiles.push(Tile {
            vertices: first_vertex..first_vertex + vertices.len() as u32,
            indices: first_index..first_index + indices.len() as u32,
            ..tile
        });
        out.vertices.extend(vertices);
        out.indices.extend(indices);
    }
    out
}

fn tile_range(model: &CityModel, geometry: u32) -> std::ops::Range<usize> {
    let tiles = &model.geometries[geometry as usize].tiles;
    tiles.start as usize..tiles.end as usize
}
