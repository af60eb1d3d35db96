//! Edges on the GPU, for whoever draws lines: made when first asked for, then only read.
//!
//! One instance of [`Edge`] per edge, in the order of the city's tiles, cut into chunks as triangles are. A pass binds
//! [`EdgeBuffers::instances`] with [`Edge::LAYOUT`] and draws [`VERTICES`] vertices, a triangle strip, per instance;
//! `edge_vertex` in `lib/edge.wgsl` does the rest.

use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3};
use rustc_hash::FxHashMap;

use crate::{
    city::edges::{self, CreaseAngles},
    geom::Aabb,
    gpu::{Gpu, GpuError},
    render::{
        cells::Cells,
        city::{CityBuffers, Draw, Shown, corners_of, extent_of},
        layout, surfaces,
    },
    view::Frustum,
};

/// Vertices per edge: a triangle strip.
pub const VERTICES: u32 = 4;

/// Edges per chunk.
const CHUNK_EDGES: usize = 256;

/// The class stands above this bit of [`Edge::surface`].
const CLASS_SHIFT: u32 = 30;
/// `lib/edge.wgsl`: no surface of the table (none has this number: the table would have 16 GiB).
pub const NO_SURFACE: u32 = (1 << CLASS_SHIFT) - 1;

/// An edge as the GPU reads it: `Edge` in `lib/edge.wgsl`, where the members are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "each member is documented once, in its WGSL file")]
pub struct Edge {
    pub origin: [i32; 3],
    pub surface: u32,
    pub start: [f32; 3],
    pub normal_a: u32,
    pub end: [f32; 3],
    pub normal_b: u32,
    pub inward: [f32; 2],
    pub along: [u32; 2],
    pub other: u32,
}

impl Edge {
    /// One per instance, locations 0 to 8.
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![
            0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32, 4 => Float32x3, 5 => Uint32, 6 => Float32x2, 7 => Uint32x2, 8 => Uint32
        ],
    };

    /// The number of the surface that it is drawn for, in the table; [`NO_SURFACE`] for none.
    pub(super) fn surface_number(&self) -> u32 {
        self.surface & NO_SURFACE
    }

    /// An edge of a tile at `origin`, whole metres, where the table of surfaces has its faces under `surfaces`.
    pub fn new(edge: &edges::Edge, origin: IVec3, surfaces: [u32; 2]) -> Self {
        Self {
            origin: origin.to_array(),
            surface: surfaces[0].min(NO_SURFACE) | (edge.class as u32) << CLASS_SHIFT,
            start: edge.ends[0],
            normal_a: edge.normals[0],
            end: edge.ends[1],
            normal_b: edge.normals[1],
            inward: edge.extents.map(|e| e.inward_m),
            along: edge.extents.map(|e| u32::from(half(e.before_m)) | u32::from(half(e.beyond_m)) << 16),
            other: surfaces[1].min(NO_SURFACE),
        }
    }

    /// Box around it, metres.
    fn bounds(&self) -> Aabb {
        let world = |p: [f32; 3]| IVec3::from(self.origin).as_dvec3() + Vec3::from(p).as_dvec3();
        Aabb::from_points([world(self.start), world(self.end)])
    }
}

/// The half float nearest to a length: below 2⁻¹⁴ m zero, at most 65504 m.
pub(super) fn half(metres: f32) -> u16 {
    let metres = metres.clamp(0.0, 65_504.0);
    if metres < 1.0 / 16_384.0 {
        return 0;
    }
    // f32: 8 bits of exponent (bias 127), 23 of mantissa; f16: 5 (bias 15), 10.
    (((metres.to_bits() + (1 << 12)) >> 13) - ((127 - 15) << 10)).min(0x7bff) as u16
}

/// The length that a half float says.
pub(super) fn metres_of(half: u16) -> f32 {
    if half == 0 { 0.0 } else { f32::from_bits((u32::from(half) << 13) + ((127 - 15) << 23)) }
}

/// The edges of what is shown of a city.
#[derive(Debug)]
pub struct EdgeBuffers {
    /// [`Edge`]s.
    pub instances: wgpu::Buffer,
    /// Runs of instances that are drawn or left out as one.
    pub chunks: Vec<(Draw, Aabb)>,
    /// How many edges there are.
    pub count: u32,
    /// Bytes on the GPU.
    pub bytes: u64,
}

impl EdgeBuffers {
    /// Finds the edges of what is shown, whose triangles are in `city`, and uploads them.
    pub fn new(gpu: &Gpu, shown: &Shown, city: &CityBuffers, angles: &CreaseAngles) -> Result<Self, GpuError> {
        Self::of_edges(gpu, &gather(shown, city, angles))
    }

    /// Uploads edges.
    pub(super) fn of_edges(gpu: &Gpu, edges: &[Edge]) -> Result<Self, GpuError> {
        let before = gpu.allocated_bytes();
        // What deforms them reads them back.
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_SRC;
        let instances = gpu.buffer("edges", usage, edges)?;
        let count = edges.len() as u32;
        Ok(Self { instances, chunks: chunks(edges), count, bytes: gpu.allocated_bytes() - before })
    }

    /// Instances to draw: those of chunks that the frustum may see and whose box `is_wanted`.
    pub fn visible(&self, frustum: &Frustum, is_wanted: impl Fn(&Aabb) -> bool) -> Vec<Draw> {
        self.draws(|bounds| frustum.meets(bounds) && is_wanted(bounds))
    }

    /// Instances to draw: those of chunks whose box `is_wanted`, neighbours as one.
    pub fn draws(&self, is_wanted: impl Fn(&Aabb) -> bool) -> Vec<Draw> {
        let mut draws: Vec<Draw> = Vec::new();
        for (range, bounds) in &self.chunks {
            if !is_wanted(bounds) {
                continue;
            }
            match draws.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => draws.push(range.clone()),
            }
        }
        draws
    }
}

/// All edges, tile by tile in the order in which triangles are drawn.
fn gather(shown: &Shown, city: &CityBuffers, angles: &CreaseAngles) -> Vec<Edge> {
    let model = shown.model;
    let found = edges::edges(model, shown.geometries, angles);
    let mut of_tile: FxHashMap<u32, &[edges::Edge]> = FxHashMap::default();
    of_tile.extend(found.chunk_by(|a, b| a.tile == b.tile).map(|run| (run[0].tile, run)));
    let numbers = SurfaceNumbers::new(&city.surface_table);
    let mut gathered = Vec::with_capacity(found.len());
    let mut known: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    for (number, _) in Cells::new(shown, &extent_of(shown)).tiles {
        let (tile, run) = (&model.tiles[number as usize], of_tile.get(&number).copied().unwrap_or_default());
        known.clear();
        gathered.extend(run.iter().map(|edge| {
            let faces = [(number, edge.triangle), edge.other];
            let surfaces = faces.map(|(tile, triangle)| {
                let [first, ..] = corners_of(model, &model.tiles[tile as usize], triangle);
                *known.entry((first.surface, first.normal)).or_insert_with(|| {
                    numbers.find(&surfaces::entry(model, &city.textures, &city.shells, first.surface, first.normal))
                })
            });
            Edge::new(edge, tile.origin, surfaces)
        }));
    }
    gathered
}

/// The table of surfaces by what its entries say. Equal entries of different tiles are the same here: whoever looks one
/// up learns the same.
struct SurfaceNumbers(FxHashMap<[u32; 4], u32>);

impl SurfaceNumbers {
    fn new(table: &[layout::Surface]) -> Self {
        let mut numbers = FxHashMap::default();
        numbers.reserve(table.len());
        for (entry, number) in table.iter().zip(0..NO_SURFACE) {
            numbers.entry(bytemuck::cast(*entry)).or_insert(number);
        }
        Self(numbers)
    }

    fn find(&self, entry: &layout::Surface) -> u32 {
        self.0.get(&bytemuck::cast::<_, [u32; 4]>(*entry)).copied().unwrap_or(NO_SURFACE)
    }
}

fn chunks(edges: &[Edge]) -> Vec<(Draw, Aabb)> {
    let mut start = 0;
    let chunk = |run: &[Edge]| {
        let range = start..start + run.len() as u32;
        start = range.end;
        (range, run.iter().fold(Aabb::EMPTY, |all, edge| all.union(edge.bounds())))
    };
    edges.chunks(CHUNK_EDGES).map(chunk).collect()
}

#[cfg(test)]
mod bench;
#[cfg(test)]
mod tests;
