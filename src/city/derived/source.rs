//! The objects that derived ones are made of, and what is asked of their faces.

use std::ops::Range;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::ground::GroundFaces;
use crate::{
    city::{
        model::{CityModel, CityObject, Geometry, NONE, StringId, Surface, Tile},
        strings::Strings,
    },
    geom::Aabb,
};

/// Cosine of the slope from which on a face without semantics is a wall: 75°.
pub(super) const STEEPEST_ROOF: f64 = 0.259;

/// The name of groups: their members are no parts of them.
const GROUP: &str = "CityObjectGroup";

/// One object that is derived, with all that stands for it.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// The object of the derived faces.
    pub object: u32,
    /// Its geometries, in [`Source::geometries`].
    pub geometries: Range<usize>,
    /// Box around its triangles, metres; empty without any.
    pub bounds: Aabb,
}

/// The city from which another is derived.
#[derive(Debug)]
pub(super) struct Source<'a> {
    pub model: &'a CityModel,
    /// Indices of geometries, unit by unit.
    pub geometries: Vec<u32>,
    /// By object.
    pub units: Vec<Unit>,
    /// The ground that flattened objects lie on; `None` where there is none, or it is not asked for.
    pub ground: Option<GroundFaces>,
    roof: Option<StringId>,
    wall: Option<StringId>,
}

/// A triangle of a unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Metres.
    pub corners: [DVec3; 3],
    /// Index into [`CityModel::surfaces`].
    pub surface: u32,
}

/// The part of a building that a face belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Roof,
    Wall,
    Ground,
}

impl Face {
    /// Twice its vector area, square metres.
    pub fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }
}

impl<'a> Source<'a> {
    pub fn new(model: &'a CityModel, shown: &[u32], parts: bool) -> Self {
        let wholes = if parts { Vec::new() } else { wholes(model) };
        let is_derived = |g: &Geometry| g.triangles > 0 && !model.objects[g.object as usize].class.is_ground();
        let mut pairs: Vec<(u32, u32)> = shown
            .iter()
            .map(|&number| (number, &model.geometries[number as usize]))
            .filter(|(_, g)| is_derived(g))
            .map(|(number, g)| (wholes.get(g.object as usize).copied().unwrap_or(g.object), number))
            .collect();
        pairs.sort_unstable();
        let mut units: Vec<Unit> = Vec::new();
        for (at, &(object, number)) in pairs.iter().enumerate() {
            let geometry = &model.geometries[number as usize];
            let tiles = &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
            let bounds = tiles.iter().fold(Aabb::EMPTY, |all, tile| all.union(tile.bounds));
            match units.last_mut().filter(|unit| unit.object == object) {
                Some(unit) => (unit.geometries.end, unit.bounds) = (at + 1, unit.bounds.union(bounds)),
                None => units.push(Unit { object, geometries: at..at + 1, bounds }),
            }
        }
        let (roof, wall) = (model.strings.find("RoofSurface"), model.strings.find("WallSurface"));
        Self { model, geometries: pairs.into_iter().map(|(_, g)| g).collect(), units, ground: None, roof, wall }
    }

    /// The geometries of a unit.
    pub fn geometries_of(&self, unit: &Unit) -> impl Iterator<Item = &'a Geometry> {
        self.geometries[unit.geometries.clone()].iter().map(|&g| &self.model.geometries[g as usize])
    }

    /// The tiles of a geometry.
    pub fn tiles_of(&self, geometry: &Geometry) -> &'a [Tile] {
        &self.model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize]
    }

    /// The triangles of a unit.
    pub fn faces_of(&self, unit: &Unit) -> impl Iterator<Item = Face> {
        let tiles = self.geometries_of(unit).flat_map(|geometry| self.tiles_of(geometry));
        tiles.flat_map(|tile| (tile.indices.start / 3..tile.indices.end / 3).map(|t| self.face(tile, t)))
    }

    /// A triangle of a tile, by its number in the model.
    pub fn face(&self, tile: &Tile, triangle: u32) -> Face {
        Self::triangle(self.model, tile, triangle)
    }

    /// The same of any model.
    pub fn triangle(model: &CityModel, tile: &Tile, triangle: u32) -> Face {
        let first = tile.vertices.start + model.indices[3 * triangle as usize];
        Face { corners: model.corners(tile, triangle), surface: model.vertices[first as usize].surface }
    }

    /// The part that a face belongs to: by its semantics; where it has none that say so, by which way it looks.
    pub fn part(&self, face: &Face) -> Part {
        let kind = self.model.surfaces.get(face.surface as usize).map(|surface| surface.kind);
        let known = |wanted: Option<StringId>| wanted.is_some() && kind == wanted;
        if known(self.roof) {
            return Part::Roof;
        }
        if known(self.wall) {
            return Part::Wall;
        }
        let normal = face.normal();
        match normal.z / normal.length() {
            slope if slope.abs() < STEEPEST_ROOF => Part::Wall,
            slope if slope > 0.0 => Part::Roof,
            _ => Part::Ground,
        }
    }
}

/// Per object the root that it is part of. Of a group an object is a member, not a part.
fn wholes(model: &CityModel) -> Vec<u32> {
    let group = model.strings.find(GROUP);
    let is_group = |object: u32| group == Some(model.objects[object as usize].kind);
    let mut wholes = vec![NONE; model.objects.len()];
    let mut path = Vec::new();
    for object in 0..model.objects.len() as u32 {
        let mut at = object;
        while wholes[at as usize] == NONE {
            path.push(at);
            match model.objects[at as usize].parents.iter().find(|&&parent| !is_group(parent)) {
                // Ways up end, as loaders see to; as far as there are objects, whatever a model says.
                Some(&parent) if path.len() <= model.objects.len() => at = parent,
                _ => wholes[at as usize] = at,
            }
        }
        let whole = wholes[at as usize];
        path.drain(..).for_each(|member| wholes[member as usize] = whole);
    }
    wholes
}

/// A model under way: the objects of another, and of its surfaces those that are asked for.
#[derive(Debug)]
pub(super) struct Target {
    pub model: CityModel,
    kinds: FxHashMap<StringId, StringId>,
    /// By surface of the source, what it is here.
    surfaces: FxHashMap<u32, u32>,
}

impl Target {
    /// The objects of a city, without attributes and geometries; its materials and textures.
    pub fn new(source: &CityModel) -> Self {
        let (mut strings, mut kinds) = (Strings::default(), FxHashMap::default());
        let objects = source.objects.iter().map(|object| {
            let kind = *kinds.entry(object.kind).or_insert_with(|| strings.intern(source.strings.get(object.kind)));
            CityObject {
                id: object.id.clone(),
                kind,
                class: object.class,
                parents: object.parents.clone(),
                children: object.children.clone(),
                attributes: 0..0,
                geometries: 0..0,
            }
        });
        let objects = objects.collect();
        let model = CityModel {
            sources: source.sources.clone(),
            crs: source.crs.clone(),
            crs_raw: source.crs_raw.clone(),
            frames: source.frames,
            strings,
            objects,
            materials: source.materials.clone(),
            shown_materials: source.shown_materials,
            textures: source.textures.clone(),
            ..CityModel::default()
        };
        Self { model, kinds, surfaces: FxHashMap::default() }
    }

    /// The surface that stands for one of the source.
    pub fn surface(&mut self, source: &CityModel, surface: u32) -> u32 {
        let Self { model, kinds, surfaces } = self;
        *surfaces.entry(surface).or_insert_with(|| {
            let of = source.surfaces[surface as usize];
            let kind = match of.kind {
                StringId(NONE) => of.kind,
                kind => *kinds.entry(kind).or_insert_with(|| model.strings.intern(source.strings.get(kind))),
            };
            model.surfaces.push(Surface { kind, detail: NONE, ..of });
            model.surfaces.len() as u32 - 1
        })
    }

    /// The grid of this step.
    pub fn grid(&mut self, step: DVec3) -> u32 {
        let steps = &mut self.model.steps;
        let known = steps.iter().position(|known| *known == step);
        known.unwrap_or_else(|| {
            steps.push(step);
            steps.len() - 1
        }) as u32
    }

    /// Adds a surface of its own.
    pub fn own_surface(&mut self, object: u32, kind: Option<&str>, material: u32) -> u32 {
        let kind = kind.map_or(StringId(NONE), |kind| self.model.strings.intern(kind));
        self.model.surfaces.push(Surface { object, material, kind, detail: NONE });
        self.model.surfaces.len() as u32 - 1
    }

    /// The finished model: each object knows its geometries, which stand together.
    pub fn finish(mut self) -> CityModel {
        for (number, geometry) in self.model.geometries.iter().enumerate() {
            let object = &mut self.model.objects[geometry.object as usize];
            let start = if object.geometries.is_empty() { number as u32 } else { object.geometries.start };
            object.geometries = start..number as u32 + 1;
        }
        let bounds = self.model.geometries.iter().map(|geometry| geometry.bounds);
        self.model.extent_as_read = bounds.fold(Aabb::EMPTY, Aabb::union);
        self.model
    }
}
