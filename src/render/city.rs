//! The city on the graphics card: made once, then only read.
//!
//! Tiles are put in Morton order and cut into chunks of about [`CHUNK_TRIANGLES`] triangles; a view
//! draws the chunks its frustum meets, neighbours merged into one draw. Faces of exactly one plane
//! that overlap stand apart, in the order of their priority, and textured ones by texture.

use std::ops::Range;

use glam::{DVec3, IVec3, Vec3};
use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, NONE, Tile, Vertex, coplanar::CoplanarTriangle, ground::Ground},
    geom::{Aabb, plane::Plane},
    gpu::{Gpu, GpuError},
    render::{layout, palette, textures::Textures},
    view::Frustum,
};

/// Triangles per chunk: few enough to cull a street scene finely, many enough that a draw call's cost
/// (some microseconds on a software adapter) vanishes beside them.
const CHUNK_TRIANGLES: usize = 512;

/// Up to this many visible chunks are drawn near to far.
const SORTED_CHUNKS: usize = 256;

/// A run of the index buffer that is drawn or culled as one.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Its part of the section's indices (or vertices, where the section has no indices).
    pub range: Range<u32>,
    /// Box around it, metres.
    pub bounds: Aabb,
}

/// One draw: part of a section.
pub type Draw = Range<u32>;

/// Triangles that share a pipeline and its bindings.
#[derive(Debug)]
pub struct Section {
    /// What the pipeline must do.
    pub kind: SectionKind,
    /// Vertices, 20 bytes each.
    pub vertices: wgpu::Buffer,
    /// Indices, where the section is indexed.
    pub indices: Option<wgpu::Buffer>,
    /// Texture coordinates or plane numbers, one per vertex.
    pub extra: Option<wgpu::Buffer>,
    /// In drawing order.
    pub chunks: Vec<Chunk>,
}

/// What a section's pipeline must do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SectionKind {
    /// Ordinary opaque triangles.
    Plain,
    /// Triangles with a texture: index of it, and the opacity below which texels are holes.
    Textured {
        /// Its number in the model.
        texture: u32,
        /// Opacity below which texels are holes; 0 = none.
        alpha_cutoff: f32,
    },
    /// Overlapping triangles of shared planes.
    Coplanar,
}

/// The city's buffers.
#[derive(Debug)]
pub struct CityBuffers {
    /// What is drawn, in order.
    pub sections: Vec<Section>,
    /// `layout::Surface` of every drawn (surface, normal, tile).
    pub surfaces: wgpu::Buffer,
    /// The same on the CPU, for whoever reads surface numbers back.
    pub surface_table: Vec<layout::Surface>,
    /// `layout::Plane` of every shared plane.
    pub planes: wgpu::Buffer,
    /// Textures by number.
    pub textures: Textures,
    /// Whether some faces have smooth normals.
    pub smooth: bool,
    /// Drawn triangles, the plain ground included.
    pub triangles: u64,
    /// Drawn vertices, the plain ground included.
    pub vertices: u64,
    /// Bytes on the card.
    pub bytes: u64,
    /// Box around everything drawn.
    pub bounds: Aabb,
}

/// What is drawn of a model.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The model.
    pub model: &'a CityModel,
    /// Its geometries that are shown.
    pub geometries: &'a [u32],
    /// Overlapping triangles among them that share a plane.
    pub coplanar: &'a [CoplanarTriangle],
    /// The plain ground, where the city has none.
    pub ground: Option<&'a Ground>,
}

/// Collects surfaces as the shader wants them: one entry per (surface, normal, tile).
struct SurfaceTable<'a> {
    model: &'a CityModel,
    textures: &'a Textures,
    entries: Vec<layout::Surface>,
    in_tile: FxHashMap<(u32, u32), u32>,
}

impl SurfaceTable<'_> {
    fn begin_tile(&mut self) {
        self.in_tile.clear();
    }

    /// The entry of a model surface and a packed normal.
    fn number(&mut self, surface: (u32, u32), origin: IVec3) -> u32 {
        let Self { model, textures, entries, in_tile } = self;
        *in_tile.entry(surface).or_insert_with(|| {
            entries.push(entry(model, textures, surface, origin));
            (entries.len() - 1) as u32
        })
    }
}

fn entry(model: &CityModel, textures: &Textures, (surface, normal): (u32, u32), origin: IVec3) -> layout::Surface {
    let Some(found) = model.surfaces.get(surface as usize) else {
        let [color_rg, color_ba] = packed(palette::linear_bytes(palette::PLAIN_GROUND));
        return layout::Surface {
            origin: origin.to_array(),
            object: layout::NO_OBJECT,
            color_rg,
            color_ba,
            flags: 0,
            normal,
        };
    };
    let material = model.materials.get(found.material as usize);
    let color = match material {
        // A texture brings the colour; the material's own only tints it.
        Some(m) if m.texture == NONE || textures.has(m.texture) => [m.base_color[0], m.base_color[1], m.base_color[2]],
        // A declared texture that is missing: most files say plain white beside it, so the quiet colours are better.
        _ => palette::linear_bytes(palette::natural(model, found)),
    };
    let [color_rg, color_ba] = packed(color);
    layout::Surface {
        origin: origin.to_array(),
        object: found.object,
        color_rg,
        color_ba,
        flags: if material.is_some_and(|m| m.unlit) { layout::SURFACE_UNLIT } else { 0 },
        normal,
    }
}

/// Linear light as four half floats.
fn packed(linear: [f32; 3]) -> [u32; 2] {
    let [r, g, b] = linear.map(|c| u32::from(palette::half(c)));
    [r | g << 16, b | u32::from(palette::half(1.0)) << 16]
}

/// Triangles gathered for one section.
#[derive(Default)]
struct Gathered {
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
    texcoords: Vec<[f32; 2]>,
    /// Box of every tile's run of indices.
    runs: Vec<(usize, Aabb)>,
}

impl Gathered {
    fn close_run(&mut self, bounds: Aabb) {
        if self.indices.len() > self.runs.last().map_or(0, |r| r.0) {
            self.runs.push((self.indices.len(), bounds));
        }
    }

    /// Cuts the runs into chunks; a run longer than a chunk is cut by triangles.
    fn chunks(&self, position: impl Fn(u32) -> DVec3) -> Vec<Chunk> {
        let step = CHUNK_TRIANGLES * 3;
        let mut chunks: Vec<Chunk> = Vec::new();
        let (mut start, mut bounds, mut done) = (0, Aabb::EMPTY, 0);
        for &(end, run_bounds) in &self.runs {
            if end - done > 2 * step {
                if done > start {
                    chunks.push(Chunk { range: start as u32..done as u32, bounds });
                }
                for from in (done..end).step_by(step) {
                    let to = (from + step).min(end);
                    let bounds = Aabb::from_points(self.indices[from..to].iter().map(|&i| position(i)));
                    chunks.push(Chunk { range: from as u32..to as u32, bounds });
                }
                (start, bounds) = (end, Aabb::EMPTY);
            } else {
                bounds = bounds.union(run_bounds);
                if end - start >= step {
                    chunks.push(Chunk { range: start as u32..end as u32, bounds });
                    (start, bounds) = (end, Aabb::EMPTY);
                }
            }
            done = end;
        }
        if done > start {
            chunks.push(Chunk { range: start as u32..done as u32, bounds });
        }
        chunks
    }
}

/// Interleaves the low 21 bits of x and y: near numbers are near places.
fn morton(x: u32, y: u32) -> u64 {
    (0..21).fold(0, |code, bit| code | u64::from(x >> bit & 1) << (2 * bit) | u64::from(y >> bit & 1) << (2 * bit + 1))
}

/// The shown tiles in Morton order of their centres.
fn ordered_tiles(shown: &Shown, extent: &Aabb) -> Vec<u32> {
    let model = shown.model;
    let scale = f64::from((1 << 21) - 1) / extent.size().x.max(extent.size().y).max(1.0);
    let mut tiles: Vec<(u64, u32)> = shown
        .geometries
        .iter()
        .flat_map(|&g| model.geometries[g as usize].tiles.clone())
        .map(|t| {
            let at = (model.tiles[t as usize].bounds.center() - extent.min) * scale;
            (morton(at.x.max(0.0) as u32, at.y.max(0.0) as u32), t)
        })
        .collect();
    tiles.sort_unstable();
    tiles.into_iter().map(|(_, t)| t).collect()
}

impl CityBuffers {
    /// Uploads what is shown.
    pub fn new(gpu: &Gpu, shown: &Shown) -> Result<Self, GpuError> {
        let textures = Textures::new(gpu, shown)?;
        let bytes_before = gpu.allocated_bytes();
        let extent =
            shown.geometries.iter().fold(Aabb::EMPTY, |all, &g| all.union(shown.model.geometries[g as usize].bounds));
        let mut table = SurfaceTable {
            model: shown.model,
            textures: &textures,
            entries: Vec::new(),
            in_tile: FxHashMap::default(),
        };
        let apart = shown.coplanar.iter().map(|c| c.triangle).collect::<std::collections::HashSet<_>>();
        let mut plain = Gathered::default();
        let mut textured: FxHashMap<(u32, u32), Gathered> = FxHashMap::default();
        let mut smooth = false;
        let mut coplanar_surfaces: FxHashMap<(u32, u32, u32), u32> = FxHashMap::default();
        for t in ordered_tiles(shown, &extent) {
            let tile = &shown.model.tiles[t as usize];
            table.begin_tile();
            gather_tile(shown.model, tile, &apart, &mut table, &mut plain, &mut textured, &mut smooth);
        }
        let mut sections = Vec::new();
        let mut bounds = extent;
        if let Some(ground) = shown.ground {
            bounds = bounds.union(gather_ground(ground, &mut table, &mut plain));
        }
        let (mut triangles, mut vertices) = (0, 0);
        let mut push = |section: Option<(Section, usize, usize)>| {
            if let Some((section, t, v)) = section {
                triangles += t as u64;
                vertices += v as u64;
                sections.push(section);
            }
        };
        let coplanar = gather_coplanar(shown, &mut table, &mut coplanar_surfaces);
        push(upload(gpu, SectionKind::Plain, &plain, &table.entries)?);
        let mut by_texture: Vec<_> = textured.into_iter().collect();
        by_texture.sort_unstable_by_key(|(key, _)| *key);
        for ((texture, cutoff), gathered) in &by_texture {
            let kind = SectionKind::Textured { texture: *texture, alpha_cutoff: f32::from_bits(*cutoff) };
            push(upload(gpu, kind, gathered, &table.entries)?);
        }
        push(coplanar.upload(gpu)?);
        let surfaces = gpu.buffer("surfaces", wgpu::BufferUsages::STORAGE, &table.entries)?;
        let planes = gpu.buffer("shared planes", wgpu::BufferUsages::STORAGE, &coplanar.planes)?;
        let surface_table = table.entries;
        let bytes = gpu.allocated_bytes() - bytes_before + textures.bytes();
        Ok(Self { sections, surfaces, surface_table, planes, textures, smooth, triangles, vertices, bytes, bounds })
    }

    /// The draws of one section that a frustum may see, and how many triangles they hold.
    ///
    /// Few chunks come near ones first, so that they hide the rest before it is shaded; many come in the order of the
    /// buffer, neighbours merged, because then draw calls cost more than hidden fragments. Coplanar sections always
    /// keep their order: it decides who wins.
    pub fn visible(section: &Section, frustum: &Frustum, eye: DVec3, draws: &mut Vec<Draw>) -> u64 {
        draws.clear();
        let seen: Vec<&Chunk> = section.chunks.iter().filter(|c| frustum.meets(&c.bounds)).collect();
        if seen.len() <= SORTED_CHUNKS && section.kind != SectionKind::Coplanar {
            let mut near_first: Vec<(f64, u32)> = Vec::with_capacity(seen.len());
            for (i, chunk) in seen.iter().enumerate() {
                let nearest = eye.clamp(chunk.bounds.min, chunk.bounds.max);
                near_first.push((nearest.distance_squared(eye), i as u32));
            }
            near_first.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            draws.extend(near_first.iter().map(|&(_, i)| seen[i as usize].range.clone()));
        } else {
            for chunk in &seen {
                match draws.last_mut() {
                    Some(last) if last.end == chunk.range.start => last.end = chunk.range.end,
                    _ => draws.push(chunk.range.clone()),
                }
            }
        }
        seen.iter().map(|c| u64::from(c.range.end - c.range.start)).sum::<u64>() / 3
    }
}

#[allow(clippy::too_many_arguments, reason = "one tile goes to several places; a struct would only rename them")]
fn gather_tile(
    model: &CityModel,
    tile: &Tile,
    apart: &std::collections::HashSet<u32>,
    table: &mut SurfaceTable,
    plain: &mut Gathered,
    textured: &mut FxHashMap<(u32, u32), Gathered>,
    smooth: &mut bool,
) {
    let vertices = &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize];
    let base = plain.vertices.len() as u32;
    let mut any_plain = false;
    for triangle in tile.indices.start / 3..tile.indices.end / 3 {
        if apart.contains(&triangle) {
            continue;
        }
        let at = triangle as usize * 3;
        let corners: [u32; 3] = std::array::from_fn(|k| model.indices[at + k]);
        let first = &vertices[corners[0] as usize];
        *smooth |= corners.iter().any(|&c| vertices[c as usize].normal != first.normal);
        match texture_of(model, table.textures, tile, first.surface) {
            None => {
                any_plain = true;
                plain.indices.extend(corners.map(|c| base + c));
            }
            Some(key) => {
                let target = textured.entry(key).or_default();
                for c in corners {
                    let number = table.number((first.surface, first.normal), tile.origin);
                    target.indices.push(target.vertices.len() as u32);
                    target.vertices.push(Vertex { surface: number, ..vertices[c as usize] });
                    target.texcoords.push(model.texcoords[(tile.texcoords + c) as usize]);
                }
            }
        }
    }
    if any_plain {
        plain.vertices.extend(
            vertices.iter().map(|v| Vertex { surface: table.number((v.surface, v.normal), tile.origin), ..*v }),
        );
    }
    plain.close_run(tile.bounds);
    for gathered in textured.values_mut() {
        gathered.close_run(tile.bounds);
    }
}

/// Texture number and bits of the alpha cutoff, where a surface's texture was found.
fn texture_of(model: &CityModel, textures: &Textures, tile: &Tile, surface: u32) -> Option<(u32, u32)> {
    if tile.texcoords == NONE {
        return None;
    }
    let material = model.materials.get(model.surfaces.get(surface as usize)?.material as usize)?;
    textures.has(material.texture).then(|| (material.texture, material.alpha_cutoff.to_bits()))
}

fn gather_ground(ground: &Ground, table: &mut SurfaceTable, plain: &mut Gathered) -> Aabb {
    let mut all = Aabb::EMPTY;
    for tile in &ground.tiles {
        table.begin_tile();
        let base = plain.vertices.len() as u32;
        let vertices = &ground.vertices[tile.vertices.start as usize..tile.vertices.end as usize];
        plain
            .vertices
            .extend(vertices.iter().map(|v| Vertex { surface: table.number((NONE, v.normal), tile.origin), ..*v }));
        let indices = &ground.indices[tile.indices.start as usize..tile.indices.end as usize];
        plain.indices.extend(indices.iter().map(|i| base + i));
        plain.close_run(tile.bounds);
        all = all.union(tile.bounds);
    }
    all
}

/// Overlapping triangles of shared planes, unindexed, in drawing order.
struct Coplanar {
    vertices: Vec<Vertex>,
    plane_numbers: Vec<u32>,
    planes: Vec<layout::Plane>,
    chunks: Vec<Chunk>,
}

fn gather_coplanar(shown: &Shown, table: &mut SurfaceTable, known: &mut FxHashMap<(u32, u32, u32), u32>) -> Coplanar {
    let model = shown.model;
    let mut order: Vec<&CoplanarTriangle> = shown.coplanar.iter().collect();
    // Within a group the higher priority is drawn later and wins at equal depth.
    order.sort_by_key(|c| (c.group, c.priority, c.triangle));
    let mut out = Coplanar { vertices: Vec::new(), plane_numbers: Vec::new(), planes: Vec::new(), chunks: Vec::new() };
    let mut group = None;
    let (mut start, mut bounds) = (0, Aabb::EMPTY);
    for c in order {
        let tile = &model.tiles[c.tile as usize];
        let corners: [&Vertex; 3] = std::array::from_fn(|k| {
            &model.vertices[(tile.vertices.start + model.indices[c.triangle as usize * 3 + k]) as usize]
        });
        if group != Some(c.group) {
            group = Some(c.group);
            if out.vertices.len() - start >= 3 * CHUNK_TRIANGLES / 4 {
                out.chunks.push(Chunk { range: start as u32..out.vertices.len() as u32, bounds });
                (start, bounds) = (out.vertices.len(), Aabb::EMPTY);
            }
            out.planes.push(plane_of(&model.plane_equations[c.group as usize - 1], tile.origin));
        }
        let surface = *known.entry((c.tile, corners[0].surface, corners[0].normal)).or_insert_with(|| {
            table.entries.push(entry(model, table.textures, (corners[0].surface, corners[0].normal), tile.origin));
            (table.entries.len() - 1) as u32
        });
        for corner in corners {
            out.vertices.push(Vertex { surface, ..*corner });
            out.plane_numbers.push(out.planes.len() as u32 - 1);
            bounds = bounds.grown(tile.origin.as_dvec3() + Vec3::from(corner.position).as_dvec3());
        }
    }
    if out.vertices.len() > start {
        out.chunks.push(Chunk { range: start as u32..out.vertices.len() as u32, bounds });
    }
    out
}

/// A group's plane, relative to a whole-metre origin near it.
fn plane_of(plane: &Plane, near: IVec3) -> layout::Plane {
    let normal = plane.normal.as_vec3();
    // The offset belongs to the rounded normal, measured at the foot of `near` on the exact plane.
    let foot = near.as_dvec3() + plane.normal * (plane.offset - plane.normal.dot(near.as_dvec3()));
    layout::Plane {
        normal: normal.to_array(),
        reserved: 0.0,
        origin: near.to_array(),
        offset: normal.as_dvec3().dot(foot - near.as_dvec3()) as f32,
    }
}

impl Coplanar {
    fn upload(&self, gpu: &Gpu) -> Result<Option<(Section, usize, usize)>, GpuError> {
        if self.vertices.is_empty() {
            return Ok(None);
        }
        let section = Section {
            kind: SectionKind::Coplanar,
            vertices: gpu.buffer("coplanar vertices", wgpu::BufferUsages::VERTEX, &self.vertices)?,
            indices: None,
            extra: Some(gpu.buffer("plane numbers", wgpu::BufferUsages::VERTEX, &self.plane_numbers)?),
            chunks: self.chunks.clone(),
        };
        Ok(Some((section, self.vertices.len() / 3, self.vertices.len())))
    }
}

fn upload(
    gpu: &Gpu,
    kind: SectionKind,
    gathered: &Gathered,
    surfaces: &[layout::Surface],
) -> Result<Option<(Section, usize, usize)>, GpuError> {
    if gathered.indices.is_empty() {
        return Ok(None);
    }
    let position = |i: u32| {
        let v = &gathered.vertices[i as usize];
        IVec3::from(surfaces[v.surface as usize].origin).as_dvec3() + Vec3::from(v.position).as_dvec3()
    };
    let section = Section {
        kind,
        vertices: gpu.buffer("vertices", wgpu::BufferUsages::VERTEX, &gathered.vertices)?,
        indices: Some(gpu.buffer("indices", wgpu::BufferUsages::INDEX, &gathered.indices)?),
        extra: match kind {
            SectionKind::Textured { .. } => {
                Some(gpu.buffer("texture coordinates", wgpu::BufferUsages::VERTEX, &gathered.texcoords)?)
            }
            _ => None,
        },
        chunks: gathered.chunks(position),
    };
    Ok(Some((section, gathered.indices.len() / 3, gathered.vertices.len())))
}
