//! Contents of lenses on the GPU: cities that are drawn beside the scene's own, and where they stand.
//!
//! A content is a city on the GPU, a placement and a number. Several contents may show one city: vertices are the same, only
//! the uniform `City` differs. The surfaces of all stand in one table, the scene's own first, so that a pixel's code says
//! all there is to know; directions in it are those after turning.

use std::sync::{Arc, OnceLock};

use glam::{DMat3, DQuat, DVec3};

use crate::{
    city::{CityModel, coplanar::stacked_triangles, decode_normal, encode_normal, ground::Ground},
    gpu::{Gpu, GpuError},
    render::{
        city::{Chunk, Shown},
        city_on_gpu::CityOnGpu,
        eye::{padded, relative, split_eye},
        footprints::Footprints,
        layout,
        resource::{
            bindings::{STAGE_STRIDE, strided},
            pipelines::Pipelines,
        },
        standing::{Placement, World},
        surfaces,
    },
};

/// A city as contents show it.
#[derive(Debug)]
pub struct ContentCity {
    /// Names it for the GPU; no other ever has the same, none is 0.
    pub id: u64,
    /// The model.
    pub model: Arc<CityModel>,
    /// Whose objects its objects are; the model itself, if it was not derived of another.
    pub source: Arc<CityModel>,
    /// Its geometries that are shown.
    pub geometries: Vec<u32>,
    /// Heights that tell faces in one plane apart, as [`crate::city::derived::Derived::heights`].
    pub heights: Vec<[f32; 3]>,
    /// Of a derived one, the geometries of the source that it was made of, and whether each object of these stands for itself.
    pub made_of: (Vec<u32>, bool),
    /// What its objects cover of the ground, once an effect asks for it.
    pub footprints: OnceLock<Footprints>,
    /// Its plain ground; `None` where there is none, or where it is the one of the scene's city.
    pub ground: Option<Ground>,
    /// Whether its objects are those of the scene's own model.
    pub is_own: bool,
    /// Whether it is something of the scene's own city that moves: without the plain ground.
    pub moves: bool,
    /// Whether it throws shadows: what is pressed flat to the ground does not.
    pub has_shadow: bool,
    /// Whether its faces are lit by normals that they do not have where they lie.
    pub is_lit_as_before: bool,
    /// Objects that were to be derived and are shown as they are, such of which nothing is left, and such that something else stands for.
    pub not_derived: [u32; 3],
}

impl ContentCity {
    /// Geometries of a model as they are, without a ground.
    pub fn plain(id: u64, model: Arc<CityModel>, geometries: Vec<u32>, is_own: bool) -> Self {
        Self {
            id,
            source: model.clone(),
            model,
            geometries,
            heights: Vec::new(),
            made_of: (Vec::new(), false),
            footprints: OnceLock::new(),
            ground: None,
            is_own,
            moves: false,
            has_shadow: true,
            is_lit_as_before: false,
            not_derived: [0; 3],
        }
    }

    /// Whether it is the scene's own model, or another data set, as it is.
    pub fn is_derived(&self) -> bool {
        !Arc::ptr_eq(&self.model, &self.source)
    }
}

/// A content that frames may show.
#[derive(Clone, Debug)]
pub struct WantedContent {
    /// Its number, from 1; 0: something of the scene's own city that moves.
    pub number: u32,
    /// Of what moves, for which of the moments it is drawn, from 1; else 0.
    pub turn: u32,
    /// Its city; `None`: the scene's own, as it is shown.
    pub city: Option<Arc<ContentCity>>,
    /// What its objects' indices are counted from.
    pub first_object: u32,
    /// Where it stands.
    pub placement: Placement,
}

impl WantedContent {
    fn id(&self) -> u64 {
        self.city.as_ref().map_or(0, |city| city.id)
    }
}

/// A part of the table of surfaces: of one city, its objects counted from here, turned so; and of what moves for which moment.
type Part = (u64, u32, DQuat, u32);

/// What the GPU holds of contents.
#[derive(Debug, Default)]
pub(super) struct Contents {
    cities: Vec<(u64, CityOnGpu)>,
    shown: Vec<ShownContent>,
    parts: Vec<Part>,
    /// Of the scene's own city and of all parts after it.
    table: Vec<layout::Surface>,
    /// The same on the GPU; `None` without contents.
    pub surfaces: Option<wgpu::TextureView>,
}

#[derive(Debug)]
struct ShownContent {
    number: u32,
    world: World,
    has_shadow: bool,
    first_surface: u32,
    /// Chunks of each section where they stand; empty: where they are.
    chunks: Vec<Vec<Chunk>>,
}

/// What of a content a frame draws, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedCity<'a> {
    pub city: &'a CityOnGpu,
    pub number: u32,
    pub world: &'a World,
    /// Whether it throws shadows.
    pub has_shadow: bool,
    /// Chunks of each section where they stand; empty: where they are.
    pub chunks: &'a [Vec<Chunk>],
    /// Offsets of its uniforms `City`: of what stands where the city has it, and of what was moved to where it is shown.
    pub offsets: [u32; 2],
}

/// A placement as the shader reads it, for an eye.
fn uniform(placement: &Placement, eye: DVec3, number: u32, first_surface: u32) -> layout::City {
    let (from, to) =
        if placement.is_none() { (eye, [0.0; 3]) } else { (placement.from, relative(placement.to, eye).to_array()) };
    let (from_whole, from_fraction) = split_eye(from);
    layout::City {
        linear: padded(DMat3::from_quat(placement.rotation) * placement.scale),
        from_whole,
        number,
        from_fraction,
        first_surface,
        to,
        scale: placement.scale as f32,
    }
}

/// How contents look beside what they are.
#[derive(Clone, Copy)]
pub(super) struct ContentLook<'a> {
    /// The plain ground of the scene's city.
    pub ground: Option<&'a Ground>,
    /// Whether something draws lines.
    pub edges: bool,
    /// Whether walls have storeys and windows.
    pub facades: bool,
}

impl Contents {
    /// Makes the GPU hold these contents beside the scene's `own` city, and no others; with their
    /// edges where something draws lines, and facades. Between frames with the same contents nothing is made. Whether the table of surfaces is another
    /// one now.
    pub fn set(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        own: &CityOnGpu,
        wanted: &[WantedContent],
        how: ContentLook,
    ) -> Result<bool, GpuError> {
        if wanted.is_empty() && self.shown.is_empty() {
            return Ok(false);
        }
        let ContentLook { ground, edges, facades } = how;
        self.cities.retain(|(id, _)| wanted.iter().any(|w| w.id() == *id));
        if self.cities.iter().any(|(_, city)| city.buffers.has_facades != facades) {
            // The table of surfaces is another one then, too.
            self.cities.clear();
            self.parts.clear();
        }
        for city in wanted.iter().filter_map(|w| w.city.as_ref()) {
            let plain = Shown {
                is_lit_as_before: city.is_lit_as_before,
                facades,
                ground: if city.is_own && !city.moves && !city.is_derived() { ground } else { city.ground.as_ref() },
                ..Shown::of(&city.model, &city.geometries)
            };
            if !self.cities.iter().any(|(id, _)| *id == city.id) {
                let coplanar = stacked_triangles(&city.model, &city.geometries, &city.heights);
                let made = CityOnGpu::new(gpu, pipelines, &Shown { coplanar: &coplanar, ..plain }, None)?;
                self.cities.push((city.id, made));
            }
            if let Some((_, on_gpu)) = self.cities.iter_mut().find(|(id, _)| edges && *id == city.id) {
                on_gpu.find_edges(gpu, &plain)?;
            }
        }
        let is_other = self.set_parts(gpu, own, wanted)?;
        self.place(own, wanted);
        Ok(is_other)
    }

    /// The table of surfaces, where it is not the one that is there.
    fn set_parts(&mut self, gpu: &Gpu, own: &CityOnGpu, wanted: &[WantedContent]) -> Result<bool, GpuError> {
        let mut parts: Vec<Part> = Vec::new();
        for w in wanted {
            let part = (w.id(), w.first_object, w.placement.rotation, w.turn);
            if part != (0, 0, DQuat::IDENTITY, 0) && !parts.contains(&part) {
                parts.push(part);
            }
        }
        if parts == self.parts && self.surfaces.is_some() != wanted.is_empty() {
            return Ok(false);
        }
        // What is of the scene's own city stays.
        let own_count = own.buffers.surface_table.len();
        let mut table = std::mem::take(&mut self.table);
        let keeps_own = self.surfaces.is_some() && !wanted.is_empty() && table.len() >= own_count;
        match keeps_own {
            true => table.truncate(own_count),
            false if wanted.is_empty() => table.clear(),
            false => table.clone_from(&own.buffers.surface_table),
        }
        for part in &parts {
            let turned = |normal: u32| {
                let is_turned = part.2 != DQuat::IDENTITY;
                if is_turned { encode_normal(part.2 * decode_normal(normal)) } else { normal }
            };
            let entry = |s: &layout::Surface| layout::Surface {
                object: if s.object == layout::NO_OBJECT {
                    s.object
                } else {
                    layout::drawn_for(s.object + part.1, part.3)
                },
                normal: turned(s.normal),
                ..*s
            };
            let city = self.city(own, part.0);
            table.extend(city.into_iter().flat_map(|city| &city.buffers.surface_table).map(entry));
        }
        let there = self.surfaces.as_ref().filter(|_| keeps_own);
        let is_written = there.is_some_and(|there| surfaces::replace_from(gpu, there, own_count, &table));
        if !is_written {
            self.surfaces = if wanted.is_empty() { None } else { Some(surfaces::upload(gpu, &table)?) };
        }
        (self.table, self.parts) = (table, parts);
        Ok(!is_written)
    }

    /// Where the contents stand.
    fn place(&mut self, own: &CityOnGpu, wanted: &[WantedContent]) {
        let mut before = std::mem::take(&mut self.shown);
        let shown = wanted.iter().map(|w| {
            let placement = w.placement;
            let city = w.city.as_ref();
            let (is_own, moves) = (city.is_none_or(|city| city.is_own), city.is_some_and(|city| city.moves));
            let world = World { city: w.id(), placement, is_own, moves };
            let first_surface = self.first_surface(own, (world.city, w.first_object, placement.rotation, w.turn));
            let same = before.iter().position(|s| s.world == world);
            let chunks = same.map_or_else(
                || {
                    let city = self.city(own, world.city).filter(|_| !placement.is_none());
                    let placed = |c: &Chunk| Chunk { bounds: placement.boxed(&c.bounds), ..c.clone() };
                    let sections = city.into_iter().flat_map(|city| &city.buffers.sections);
                    sections.map(|s| s.chunks.iter().map(placed).collect()).collect()
                },
                |i| before.swap_remove(i).chunks,
            );
            let has_shadow = w.city.as_ref().is_none_or(|city| city.has_shadow);
            ShownContent { number: w.number, world, has_shadow, first_surface, chunks }
        });
        self.shown = shown.collect();
    }

    /// The entry of the table of surfaces, of the scene's own city and of contents; of a section, whose it is.
    pub fn surface(&self, own: &CityOnGpu, number: u32) -> Option<layout::Surface> {
        if number & layout::SECTION != 0 {
            let object = Some(number & layout::SECTION_OBJECT).filter(|&object| object != layout::SECTION_OBJECT);
            return Some(layout::Surface::new(object.unwrap_or(layout::NO_OBJECT), 0, [0.0; 3], 0));
        }
        let table = if self.surfaces.is_some() { &self.table } else { &own.buffers.surface_table };
        let entry = table.get(number as usize)?;
        Some(layout::Surface { object: layout::object_of(entry.object), ..*entry })
    }

    /// The cities beside the scene's own that the GPU holds.
    pub fn others(&self) -> impl Iterator<Item = &CityOnGpu> {
        self.cities.iter().map(|(_, city)| city)
    }

    /// The contents that frames may show.
    pub fn placed<'a>(&'a self, own: &'a CityOnGpu) -> impl Iterator<Item = PlacedCity<'a>> {
        let count = self.shown.len();
        self.shown.iter().enumerate().filter_map(move |(i, content)| {
            Some(PlacedCity {
                city: self.city(own, content.world.city)?,
                number: content.number,
                world: &content.world,
                has_shadow: content.has_shadow,
                chunks: &content.chunks,
                offsets: [1 + i, 1 + count + i].map(|at| at as u32 * STAGE_STRIDE as u32),
            })
        })
    }

    /// The numbers of contents, and which city each shows where.
    pub fn worlds(&self) -> impl Iterator<Item = (u32, &World)> {
        self.shown.iter().map(|content| (content.number, &content.world))
    }

    /// The uniforms `City` of the scene's own city, of all contents, and (`is_moved`) of what is moved of each; for an eye. Programs that may show
    /// contents place the scene's own city by its uniform in frames without contents, too.
    pub fn uniforms(&self, eye: DVec3, is_moved: bool) -> Vec<u8> {
        let own = strided(&uniform(&Placement::NONE, eye, 0, 0));
        let of = |c: &ShownContent, placement: &Placement| strided(&uniform(placement, eye, c.number, c.first_surface));
        let placed = self.shown.iter().map(|c| of(c, &c.world.placement));
        let moved = self.shown.iter().filter(|_| is_moved).map(|c| of(c, &Placement::NONE));
        std::iter::once(own).chain(placed).chain(moved).flatten().collect()
    }

    /// The city that an id names.
    pub fn city<'a>(&'a self, own: &'a CityOnGpu, id: u64) -> Option<&'a CityOnGpu> {
        if id == 0 { Some(own) } else { self.cities.iter().find(|(i, _)| *i == id).map(|(_, city)| city) }
    }

    /// Those of them that are no city of the scene's own, to read them back.
    pub fn city_mut(&mut self, id: u64) -> Option<&mut CityOnGpu> {
        self.cities.iter_mut().find(|(i, _)| *i == id).map(|(_, city)| city)
    }

    /// Where the surfaces of a part begin.
    fn first_surface(&self, own: &CityOnGpu, part: Part) -> u32 {
        let length = |id| self.city(own, id).map_or(0, |city| city.buffers.surface_table.len() as u32);
        match self.parts.iter().position(|p| *p == part) {
            Some(at) => length(0) + self.parts[..at].iter().map(|(id, ..)| length(*id)).sum::<u32>(),
            None => 0,
        }
    }
}
