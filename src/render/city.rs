//! The city on the GPU: made once, then only read.
//!
//! Tiles are put in the order of their cells ([`crate::render::cells`]) and cut into chunks of about [`CHUNK_TRIANGLES`] triangles; a
//! view draws the chunks its frustum meets, near ones first. Block models, once small views ask for them, are chunks beside the others. Textured faces stand apart by texture, and those that
//! overlap in exactly one plane by layer: one layer is drawn after the other.

use std::{collections::BTreeMap, ops::Range, sync::Arc};

use bytemuck::Zeroable;
use glam::{DVec3, IVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    city::{
        CityModel, NONE, Tile, Vertex,
        coplanar::CoplanarTriangle,
        encode_normal,
        ground::{Fade, Ground},
    },
    geom::{Aabb, plane::Plane},
    gpu::{Gpu, GpuError},
    render::{
        cells::{CellFigures, Cells, Detail, NO_CELL},
        facades::Facades,
        layout::{self, CityVertex},
        shells::{Shells, closed_shells},
        surfaces::{self, SurfaceTable},
        textures::Textures,
        weld::{Corner, Weld},
    },
    view::Frustum,
};

/// Triangles per chunk: few enough to cull a street scene finely, many enough that a draw call's cost
/// (some microseconds on a software adapter) vanishes beside them.
pub(super) const CHUNK_TRIANGLES: usize = 256;

/// Visible chunks are drawn near to far in at most so many groups.
const SORTED_GROUPS: usize = 512;

/// A run of the index buffer that is drawn or culled as one.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Its part of the section's indices.
    pub range: Range<u32>,
    /// Box around it, metres.
    pub bounds: Aabb,
    /// The cell that it is of; of terrain, or what lies flat on it, none.
    pub cell: u32,
    /// Bits of the details of that cell that it is drawn in.
    pub details: u8,
    /// Which of its fragments are translucent, whatever lenses do.
    pub translucency: Translucency,
    /// Whether it is plain ground around the city: so far off that nothing throws shadows there.
    pub is_around: bool,
    /// Whether it is plain ground that gives way to a deformation of the whole city: around it, and where it only fills gaps.
    pub gives_way: bool,
    /// Whose its triangles are, run by run.
    pub runs: Arc<[ObjectRun]>,
    /// Whether the runs say where among the section's indices they end; what was moved lies in another order.
    pub has_run_ends: bool,
}

impl Chunk {
    /// Whether it is terrain, or what lies flat on it.
    pub fn has_terrain(&self) -> bool {
        self.cell == NO_CELL
    }
}

/// Triangles of one object that follow each other in an index buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectRun {
    /// Where they end among the section's indices.
    pub end: u32,
    /// Their object; [`NONE`]: plain ground.
    pub object: u32,
}

/// Which fragments are translucent by material and texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Translucency {
    /// None.
    #[default]
    None,
    /// Some, by the opacity of a texture.
    Some,
    /// All.
    All,
}

/// What the opacity of a texture does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Texels {
    /// Nothing.
    Opaque,
    /// Texels below an opacity are holes: the bits of its f32.
    Holes(u32),
    /// Texels let through what is behind by their opacity.
    Translucent,
}

/// Images of triangles: numbers of textures, [`NONE`] where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Images {
    /// Of colours.
    pub color: u32,
    /// Of shares of their own light.
    pub emission: u32,
    /// Of normals in tangent space.
    pub normals: u32,
    /// What the x and y of these are multiplied with: the bits of its f32; 0 where there are none.
    pub normal_scale: u32,
    /// What the opacity of the first does.
    pub texels: Texels,
    /// Whether there is no image: coordinates are those of storeys and windows ([`crate::render::facades`]).
    pub facade: bool,
}

impl Images {
    /// Storeys and windows.
    const FACADE: Self =
        Self { color: NONE, emission: NONE, normals: NONE, normal_scale: 0, texels: Texels::Opaque, facade: true };
}

/// One draw: part of a section.
pub type Draw = Range<u32>;

/// Triangles that share a pipeline and its bindings.
#[derive(Debug)]
pub struct Section {
    /// What the pipeline must do.
    pub kind: SectionKind,
    /// [`CityVertex`]s.
    pub vertices: wgpu::Buffer,
    /// Three per triangle.
    pub indices: wgpu::Buffer,
    /// Texture coordinates or planes or both, one per vertex.
    pub extra: Option<wgpu::Buffer>,
    /// In drawing order.
    pub chunks: Vec<Chunk>,
    /// Which layer of their planes its faces are in, where they overlap others; the lowest is 0.
    pub layer: u32,
    /// Whether it throws shadows: what lets more than half of the light through does not.
    pub has_shadow: bool,
}

impl Section {
    /// Whether its corners can be read by each other.
    pub fn is_read(&self) -> bool {
        self.vertices.usage().contains(wgpu::BufferUsages::STORAGE)
    }
}

/// What a section's pipeline must do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SectionKind {
    /// Ordinary opaque triangles.
    Plain,
    /// Triangles with images.
    Textured(Images),
    /// Overlapping triangles of shared planes, one layer of them, with images or without.
    Coplanar(Option<Images>),
}

impl SectionKind {
    /// Its images.
    pub fn images(self) -> Option<Images> {
        match self {
            Self::Plain | Self::Coplanar(None) => None,
            Self::Textured(images) | Self::Coplanar(Some(images)) => Some(images),
        }
    }

    /// Whether it is a layer of shared planes.
    pub fn is_layer(self) -> bool {
        matches!(self, Self::Coplanar(_))
    }

    /// What it is where it stands in no plane any more.
    pub fn out_of_plane(self) -> Self {
        self.images().map_or(Self::Plain, Self::Textured)
    }
}

/// The city's buffers.
#[derive(Debug)]
pub struct CityBuffers {
    /// What is drawn, in order.
    pub sections: Vec<Section>,
    /// `layout::Surface` of every drawn (surface, normal, tile), as a texture.
    pub surfaces: wgpu::TextureView,
    /// The same on the CPU, for whoever reads surface numbers back.
    pub surface_table: Vec<layout::Surface>,
    /// Which objects are closed shells.
    pub(super) shells: Shells,
    /// Textures by number.
    pub textures: Textures,
    /// What its cells take.
    pub(super) cells: Vec<CellFigures>,
    /// Whether it has block models too.
    pub has_blocks: bool,
    /// Whether its walls were given storeys and windows.
    pub has_facades: bool,
    /// Whether some faces have smooth normals.
    pub smooth: bool,
    /// Whether some have light of their own.
    pub emits: bool,
    /// Whether texels of some say how much of it.
    pub texels_emit: bool,
    /// Drawn triangles, the plain ground included.
    pub triangles: u64,
    /// Drawn vertices, the plain ground included.
    pub vertices: u64,
    /// Bytes on the GPU.
    pub bytes: u64,
    /// Box around everything drawn but plain ground around the city, metres.
    pub bounds: Aabb,
    /// Box around that too, metres.
    pub reach: Aabb,
    /// How its plain ground fades, where there is one.
    pub fade: Option<Fade>,
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
    /// Whether faces are lit by normals that they do not have where they lie: then these are not turned to the eye.
    pub is_lit_as_before: bool,
    /// Whether walls without textures have storeys and windows.
    pub facades: bool,
    /// The box around what else the scene shows of this city, which is drawn beside it, metres.
    pub beside: Aabb,
}

impl<'a> Shown<'a> {
    /// Geometries of a model, and nothing else.
    pub fn of(model: &'a CityModel, geometries: &'a [u32]) -> Self {
        Self {
            model,
            geometries,
            coplanar: &[],
            ground: None,
            is_lit_as_before: false,
            facades: false,
            beside: Aabb::EMPTY,
        }
    }
}

/// Triangles gathered for one section.
struct Gathered {
    weld: Weld,
    /// One per vertex, where the section has a texture; its vertices are not shared then.
    texcoords: Vec<[f32; 2]>,
    runs: Vec<Run>,
    group: Group,
}

/// What triangles of a section have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Group {
    /// Their images.
    pub images: Option<Images>,
    /// Which of their fragments are translucent.
    pub translucency: Translucency,
    /// Whether they throw shadows.
    pub has_shadow: bool,
}

impl Group {
    /// Opaque ones without a texture.
    pub const PLAIN: Self = Self { images: None, translucency: Translucency::None, has_shadow: true };
    /// All without a texture.
    const UNTEXTURED: [Self; 3] = [
        Self::PLAIN,
        Self { translucency: Translucency::All, ..Self::PLAIN },
        Self { translucency: Translucency::All, has_shadow: false, ..Self::PLAIN },
    ];
}

/// What one tile has among the indices.
struct Run {
    /// Where it ends.
    end: usize,
    bounds: Aabb,
    cell: u32,
    details: u8,
    is_around: bool,
    gives_way: bool,
    /// The tile's object; [`NONE`]: plain ground.
    object: u32,
}

/// How corners become vertices.
#[derive(Clone, Copy)]
struct WeldKind {
    /// With a normal each.
    smooth: bool,
    /// Which corner of a triangle flat values come from.
    provoking: usize,
}

impl Gathered {
    fn new(kind: WeldKind, group: Group) -> Self {
        Self { weld: Weld::new(kind.smooth, kind.provoking), texcoords: Vec::new(), runs: Vec::new(), group }
    }

    /// Adds a corner that no other triangle has.
    fn push(&mut self, vertex: CityVertex, texcoord: [f32; 2]) {
        self.weld.indices.push(self.weld.vertices.len() as u32);
        self.weld.vertices.push(vertex);
        self.texcoords.push(texcoord);
    }

    fn close_run(&mut self, bounds: Aabb, cell: u32, details: u8, object: u32) {
        let end = self.weld.indices.len();
        if end > self.runs.last().map_or(0, |run| run.end) {
            self.runs.push(Run { end, bounds, cell, details, is_around: false, gives_way: false, object });
        }
    }

    /// A run of plain ground.
    fn close_ground(&mut self, bounds: Aabb, is_around: bool, is_filling: bool) {
        let before = self.runs.len();
        self.close_run(bounds, NO_CELL, details_of(NO_CELL, Detail::Full), NONE);
        for run in &mut self.runs[before..] {
            (run.is_around, run.gives_way) = (is_around, is_around || is_filling);
        }
    }

    /// Cuts the runs into chunks: where another cell begins, and where one has more than a chunk; a run longer than that is cut by triangles.
    fn chunks(&self) -> Vec<Chunk> {
        let runs = |from: usize, to: usize| -> Arc<[ObjectRun]> {
            let first = self.runs.partition_point(|run| run.end <= from);
            let begins = |run: usize| run.checked_sub(1).map_or(0, |before| self.runs[before].end);
            let own = (first..self.runs.len()).take_while(|&run| begins(run) < to).map(|run| &self.runs[run]);
            let mut runs: Vec<ObjectRun> = Vec::new();
            for run in own {
                let end = run.end.min(to) as u32;
                match runs.last_mut().filter(|last| last.object == run.object) {
                    Some(last) => last.end = end,
                    None => runs.push(ObjectRun { end, object: run.object }),
                }
            }
            runs.into()
        };
        let position = |i: u32| {
            let vertex = &self.weld.vertices[i as usize];
            IVec3::from(vertex.origin).as_dvec3() + Vec3::from(vertex.position).as_dvec3()
        };
        let step = CHUNK_TRIANGLES * 3;
        let chunk = |(from, to): (usize, usize),
                     bounds: Aabb,
                     (cell, details, is_around, gives_way): (u32, u8, bool, bool)| Chunk {
            range: from as u32..to as u32,
            bounds,
            cell,
            details,
            translucency: self.group.translucency,
            is_around,
            gives_way,
            runs: runs(from, to),
            has_run_ends: true,
        };
        let mut chunks: Vec<Chunk> = Vec::new();
        let (mut start, mut bounds, mut done, mut of) = (0, Aabb::EMPTY, 0, (NO_CELL, 0, false, false));
        for run in &self.runs {
            let is_long = run.end - done > 2 * step;
            // Terrain is cut as soon as there is a chunk of it; cells are about that long.
            let is_full = done - start >= if of.0 == NO_CELL { step } else { 2 * step };
            let of_run = (run.cell, run.details, run.is_around, run.gives_way);
            if done > start && (is_long || is_full || of_run != of) {
                chunks.push(chunk((start, done), bounds, of));
                (start, bounds) = (done, Aabb::EMPTY);
            }
            of = of_run;
            if is_long {
                for from in (done..run.end).step_by(step) {
                    let to = (from + step).min(run.end);
                    let bounds = Aabb::from_points(self.weld.indices[from..to].iter().map(|&i| position(i)));
                    chunks.push(chunk((from, to), bounds, of));
                }
                start = run.end;
            } else {
                bounds = bounds.union(run.bounds);
            }
            done = run.end;
        }
        if done > start {
            chunks.push(chunk((start, done), bounds, of));
        }
        chunks
    }
}

/// The object that a tile is of.
fn object_of(model: &CityModel, tile: &Tile) -> u32 {
    model.geometries.get(tile.geometry as usize).map_or(NONE, |geometry| geometry.object)
}

/// The corner of a triangle that flat values come from: the first, in OpenGL the last.
pub(super) fn provoking_corner(gpu: &Gpu) -> usize {
    if gpu.info.backend == wgpu::Backend::Gl { 2 } else { 0 }
}

/// Box around what is shown but for the plain ground, metres.
pub(super) fn extent_of(shown: &Shown) -> Aabb {
    shown.geometries.iter().fold(Aabb::EMPTY, |all, &g| all.union(shown.model.geometries[g as usize].bounds))
}

impl CityBuffers {
    /// Uploads what is shown, and the block models of its objects where there are some.
    pub fn new(gpu: &Gpu, shown: &Shown, blocks: Option<&CityModel>) -> Result<Self, GpuError> {
        let textures = Textures::new(gpu, shown)?;
        let bytes_before = gpu.allocated_bytes();
        let extent = extent_of(shown);
        let cells = Cells::new(shown, &extent);
        let tiles = &cells.tiles;
        let tile_numbers = || tiles.iter().map(|(tile, _)| *tile);
        let mut shells = closed_shells(shown, tile_numbers(), extent.center());
        if shown.is_lit_as_before {
            let objects =
                tile_numbers().map(|t| shown.model.geometries[shown.model.tiles[t as usize].geometry as usize].object);
            objects.for_each(|object| *shells.entry(object).or_default() |= layout::SURFACE_LIT_AS_BEFORE);
        }
        let mut table = SurfaceTable::of(shown, &textures, &shells);
        let apart: FxHashSet<u32> = shown.coplanar.iter().map(|c| c.triangle).collect();
        let smooth = is_smooth(shown, &apart) || has_normals(shown, &textures);
        let kind = WeldKind { smooth, provoking: provoking_corner(gpu) };
        let mut plain = Group::UNTEXTURED.map(|group| Gathered::new(kind, group));
        let mut textured: FxHashMap<Group, Gathered> = FxHashMap::default();
        let facades = if shown.facades { Facades::new(shown, &textures) } else { Facades::default() };
        for &(t, cell) in tiles {
            let tile = &shown.model.tiles[t as usize];
            let details = details_of(cell, Detail::Full);
            table.begin_tile();
            let look = Walls { apart: &apart, facades: &facades };
            gather_tile(shown.model, tile, look, &mut table, &mut plain, &mut textured);
            for gathered in plain.iter_mut().chain(textured.values_mut()) {
                gathered.close_run(tile.bounds, cell, details, object_of(shown.model, tile));
            }
        }
        let mut sections = Vec::new();
        let mut bounds = extent.union(shown.beside);
        if let Some(ground) = shown.ground {
            bounds = bounds.union(gather_ground(ground, &mut table, &mut plain[0]));
        }
        let (mut triangles, mut vertices) = (0, 0);
        let mut push = |section: Option<(Section, usize, usize)>| {
            if let Some((section, t, v)) = section {
                triangles += t as u64;
                vertices += v as u64;
                sections.push(section);
            }
        };
        let layers = gather_layers(shown, tiles, &facades, &mut table, kind);
        let mut entries = table.entries;
        let flat_roofs = blocks.map(|_| surfaces::flat_roofs(shown)).unwrap_or_default();
        let blocks = blocks.map(|model| gather_blocks(model, &flat_roofs, &cells, &mut entries, extent.center(), kind));
        for gathered in &plain {
            push(upload(gpu, SectionKind::Plain, gathered, Extra::NONE)?);
        }
        let mut by_texture: Vec<_> = textured.into_iter().collect();
        by_texture.sort_unstable_by_key(|(group, _)| *group);
        for (group, gathered) in &by_texture {
            let Some(images) = group.images else { continue };
            let kind = SectionKind::Textured(images);
            push(upload(gpu, kind, gathered, Extra { name: "texture coordinates", each: &gathered.texcoords })?);
        }
        for (number, layer) in (0..).zip(&layers) {
            for layer in layer {
                let section = layer.upload(gpu)?;
                push(section.map(|(section, t, v)| (Section { layer: number, ..section }, t, v)));
            }
        }
        if let Some(blocks) = &blocks {
            push(upload(gpu, SectionKind::Plain, blocks, Extra::NONE)?);
        }
        let surfaces = surfaces::upload(gpu, &entries)?;
        let surface_table = entries;
        let emits = surface_table.iter().any(layout::Surface::emits);
        let texels_emit =
            sections.iter().filter_map(|section| section.kind.images()).any(|images| images.emission != NONE);
        let figures = CellFigures::of_all(cells.count, sections.iter().flat_map(|section| &section.chunks));
        let bytes = gpu.allocated_bytes() - bytes_before + textures.bytes();
        Ok(Self {
            sections,
            surfaces,
            surface_table,
            shells,
            textures,
            cells: figures,
            has_blocks: blocks.is_some(),
            has_facades: shown.facades,
            smooth,
            emits,
            texels_emit,
            triangles,
            vertices,
            bytes,
            bounds,
            reach: shown.ground.map_or(bounds, |ground| bounds.union(ground.bounds)),
            fade: shown.ground.map(|ground| ground.fade),
        })
    }

    /// Sections with a normal per vertex, whose surfaces and textures are those of another city.
    pub(super) fn of_sections(sections: Vec<Section>, surfaces: wgpu::TextureView, bounds: Aabb) -> Self {
        Self {
            sections,
            surfaces,
            surface_table: Vec::new(),
            shells: Shells::default(),
            textures: Textures::none(),
            cells: Vec::new(),
            has_blocks: false,
            has_facades: false,
            smooth: true,
            emits: false,
            texels_emit: false,
            triangles: 0,
            vertices: 0,
            bytes: 0,
            bounds,
            reach: bounds,
            fade: None,
        }
    }

    /// Those of the chunks of one section that a frustum may see, in drawing order.
    ///
    /// Near ones come first, so that they hide the rest before it is shaded; where many chunks are seen, runs of
    /// neighbours are sorted as one, because draw calls cost something too.
    pub fn visible<'a>(
        chunks: impl IntoIterator<Item = &'a Chunk>,
        frustum: &Frustum,
        eye: DVec3,
    ) -> Vec<SeenChunk<'a>> {
        let seen: Vec<&Chunk> = chunks.into_iter().filter(|c| frustum.meets(&c.bounds)).collect();
        let run_length = seen.len().div_ceil(SORTED_GROUPS).max(1);
        let mut runs: Vec<(f64, &[&Chunk])> = seen
            .chunks(run_length)
            .map(|run| {
                let bounds = run.iter().fold(Aabb::EMPTY, |all, c| all.union(c.bounds));
                (eye.clamp(bounds.min, bounds.max).distance(eye), run)
            })
            .collect();
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let chunks =
            runs.into_iter().flat_map(|(distance, run)| run.iter().map(move |&chunk| SeenChunk { chunk, distance }));
        chunks.collect()
    }
}

/// A chunk in a frustum.
#[derive(Clone, Copy, Debug)]
pub struct SeenChunk<'a> {
    /// Which.
    pub chunk: &'a Chunk,
    /// From the eye to the nearest point of what is sorted with it, metres.
    pub distance: f64,
}

/// Few draws for many runs of an index buffer: neighbours become one. And how many triangles they hold.
pub fn draws_of(ranges: impl Iterator<Item = Draw>) -> (Vec<Draw>, u64) {
    let mut draws: Vec<Draw> = Vec::new();
    let mut indices = 0;
    for range in ranges {
        indices += u64::from(range.end - range.start);
        match draws.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => draws.push(range),
        }
    }
    (draws, indices / 3)
}

/// The corners of a model triangle; `triangle` counts from the model's first.
pub(super) fn corners_of<'a>(model: &'a CityModel, tile: &Tile, triangle: u32) -> [&'a Vertex; 3] {
    [0, 1, 2].map(|k| &model.vertices[(tile.vertices.start + model.indices[triangle as usize * 3 + k]) as usize])
}

/// Whether some face that is drawn has a normal per corner.
fn is_smooth(shown: &Shown, apart: &FxHashSet<u32>) -> bool {
    let model = shown.model;
    shown.geometries.iter().flat_map(|&g| model.geometries[g as usize].tiles.clone()).any(|t| {
        let tile = &model.tiles[t as usize];
        (tile.indices.start / 3..tile.indices.end / 3).any(|triangle| {
            let [a, b, c] = corners_of(model, tile, triangle).map(|v| v.normal);
            (a != b || a != c) && !apart.contains(&triangle)
        })
    })
}

/// Whether some texture has normals.
fn has_normals(shown: &Shown, textures: &Textures) -> bool {
    shown.model.materials.iter().any(|material| textures.has(material.normal_texture))
}

/// What is known of triangles beside the model.
#[derive(Clone, Copy)]
struct Walls<'a> {
    /// Those that overlap others in their plane: they are gathered elsewhere.
    apart: &'a FxHashSet<u32>,
    facades: &'a Facades,
}

fn gather_tile(
    model: &CityModel,
    tile: &Tile,
    walls: Walls,
    table: &mut SurfaceTable,
    plain: &mut [Gathered],
    textured: &mut FxHashMap<Group, Gathered>,
) {
    plain.iter_mut().for_each(|gathered| gathered.weld.begin_tile(tile.origin));
    for triangle in tile.indices.start / 3..tile.indices.end / 3 {
        if walls.apart.contains(&triangle) {
            continue;
        }
        let corners = corners_of(model, tile, triangle);
        let [first, ..] = corners;
        let group = table.group(first.surface, tile.texcoords != NONE);
        let kind = WeldKind { smooth: false, provoking: 0 };
        if let Some((group, corners)) = facade_corners(model, tile, triangle, group, walls.facades, table) {
            let target = textured.entry(group).or_insert_with(|| Gathered::new(kind, group));
            corners.into_iter().for_each(|(vertex, place)| target.push(vertex, place));
            continue;
        }
        if let Some(gathered) = plain.iter_mut().find(|gathered| gathered.group == group) {
            let number = table.number(first.surface, first.normal, false);
            gathered.weld.triangle(number, corners.map(|v| Corner { position: v.position, normal: v.normal }));
            continue;
        }
        let target = textured.entry(group).or_insert_with(|| Gathered::new(kind, group));
        let corners = textured_corners(model, tile, triangle, table);
        corners.into_iter().for_each(|(vertex, texcoord)| target.push(vertex, texcoord));
    }
    plain.iter_mut().for_each(|gathered| gathered.weld.end_tile());
}

/// Corners of a triangle, each with its texture coordinate.
type TexturedCorners = [(CityVertex, [f32; 2]); 3];

/// The corners of a wall without a texture, with their places among storeys and windows, and the group that they are of then; `None`: it has none.
fn facade_corners(
    model: &CityModel,
    tile: &Tile,
    triangle: u32,
    group: Group,
    facades: &Facades,
    table: &mut SurfaceTable,
) -> Option<(Group, TexturedCorners)> {
    if group.images.is_some() {
        return None;
    }
    let places = facades.of(triangle, model.corners(tile, triangle))?;
    let corners = corners_of(model, tile, triangle);
    let mut corner = |k: usize| {
        let surface = table.number(corners[0].surface, corners[k].normal, false);
        (CityVertex::new(tile.origin, surface, corners[k].position, corners[k].normal), places[k])
    };
    Some((Group { images: Some(Images::FACADE), ..group }, [0, 1, 2].map(&mut corner)))
}

/// The corners of a model triangle that has texture coordinates; `triangle` counts from the model's first.
fn textured_corners(model: &CityModel, tile: &Tile, triangle: u32, table: &mut SurfaceTable) -> TexturedCorners {
    let corners = corners_of(model, tile, triangle);
    [0, 1, 2].map(|k| {
        let vertex = corners[k];
        let surface = table.number(corners[0].surface, vertex.normal, true);
        let texcoord = model.texcoords[(tile.texcoords + model.indices[triangle as usize * 3 + k]) as usize];
        (CityVertex::new(tile.origin, surface, vertex.position, vertex.normal), texcoord)
    })
}

/// Adds the plain ground; the box around what of it the city's extent has, metres.
fn gather_ground(ground: &Ground, table: &mut SurfaceTable, plain: &mut Gathered) -> Aabb {
    let up = encode_normal(DVec3::Z);
    for (number, tile) in ground.tiles.iter().enumerate() {
        table.begin_tile();
        plain.weld.begin_tile(tile.origin);
        let vertices = &ground.vertices[tile.vertices.start as usize..tile.vertices.end as usize];
        for corners in ground.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| vertices[corners[k] as usize].position);
            // Made up between footprints: shown as level, or its grid of triangles would catch the light.
            plain.weld.triangle(table.number(NONE, up, false), corners.map(|position| Corner { position, normal: up }));
        }
        plain.weld.end_tile();
        plain.close_ground(tile.bounds, !ground.below.contains(&number), ground.is_filling);
    }
    if ground.is_filling { Aabb::EMPTY } else { ground.bounds_below() }
}

/// Block models by cell, of each first what looks up, and what the table of surfaces says of them; their roofs are flat where those of `flat_roofs` are.
fn gather_blocks(
    model: &CityModel,
    flat_roofs: &[bool],
    cells: &Cells,
    entries: &mut Vec<layout::Surface>,
    middle: DVec3,
    kind: WeldKind,
) -> Gathered {
    let mut tiles: Vec<(u32, u32)> = (0..model.tiles.len() as u32).map(|t| (cells.of(model, t), t)).collect();
    tiles.retain(|(cell, _)| *cell != NO_CELL);
    tiles.sort_unstable();
    let all: Vec<u32> = (0..model.geometries.len() as u32).collect();
    let shown = Shown::of(model, &all);
    let shells = closed_shells(&shown, tiles.iter().map(|(_, tile)| *tile), middle);
    let textures = Textures::none();
    let mut table = SurfaceTable::new(model, &textures, &shells);
    // Seen from afar, nothing is seen through.
    table.is_opaque = true;
    table.flat_roofs = Some(flat_roofs);
    table.entries = std::mem::take(entries);
    let mut gathered = Gathered::new(kind, Group::PLAIN);
    for of_cell in tiles.chunk_by(|a, b| a.0 == b.0) {
        for is_roof in [true, false] {
            let details = Detail::Blocks.bit() | if is_roof { Detail::Roofs.bit() } else { 0 };
            for &(cell, t) in of_cell {
                let tile = &model.tiles[t as usize];
                table.begin_tile();
                gathered.weld.begin_tile(tile.origin);
                for triangle in tile.indices.start / 3..tile.indices.end / 3 {
                    let corners = corners_of(model, tile, triangle);
                    let [first, ..] = corners;
                    let [a, b, c] = corners.map(|v| Vec3::from(v.position));
                    if ((b - a).cross(c - a).z > 0.0) == is_roof {
                        let number = table.number(first.surface, first.normal, false);
                        let corners = corners.map(|v| Corner { position: v.position, normal: v.normal });
                        gathered.weld.triangle(number, corners);
                    }
                }
                gathered.weld.end_tile();
                gathered.close_run(tile.bounds, cell, details, object_of(model, tile));
            }
        }
    }
    *entries = table.entries;
    gathered
}

/// The details that a chunk of a cell is drawn in, which is of one of them; terrain is drawn in all.
fn details_of(cell: u32, detail: Detail) -> u8 {
    if cell == NO_CELL { Detail::ALL.iter().fold(0, |all, detail| all | detail.bit()) } else { detail.bit() }
}

/// Overlapping triangles of shared planes: those of one layer, which do not overlap each other.
struct Layer {
    gathered: Gathered,
    /// One per vertex.
    planes: Vec<layout::Plane>,
    /// What vertices of the tile speak for: number of the surface, and its plane.
    owners: Vec<(u32, layout::Plane)>,
    numbers: FxHashMap<(u32, u32), u32>,
}

impl Layer {
    /// Its section, its triangles and its vertices.
    fn upload(&self, gpu: &Gpu) -> Result<Option<(Section, usize, usize)>, GpuError> {
        let Self { gathered, planes, .. } = self;
        let kind = SectionKind::Coplanar(gathered.group.images);
        if kind.images().is_none() {
            return upload(gpu, kind, gathered, Extra { name: "planes", each: planes });
        }
        let both = planes.iter().zip(&gathered.texcoords);
        let both = both.map(|(&plane, &texcoord)| layout::TexturedPlane { plane, texcoord });
        let each: Vec<layout::TexturedPlane> = both.collect();
        upload(gpu, kind, gathered, Extra { name: "planes and texture coordinates", each: &each })
    }

    fn new(kind: WeldKind, group: Group) -> Self {
        let gathered = Gathered::new(kind, group);
        Self { gathered, planes: Vec::new(), owners: Vec::new(), numbers: FxHashMap::default() }
    }

    fn begin_tile(&mut self, origin: IVec3) {
        self.gathered.weld.begin_tile(origin);
        self.owners.clear();
        self.numbers.clear();
    }

    /// Adds a triangle of a surface, by its number in the table, that lies in a shared plane.
    fn triangle(&mut self, surface: u32, group: u32, plane: layout::Plane, corners: [Corner; 3]) {
        let owner = *self.numbers.entry((surface, group)).or_insert_with(|| {
            self.owners.push((surface, plane));
            (self.owners.len() - 1) as u32
        });
        self.gathered.weld.triangle(owner, corners);
    }

    /// Adds one that has images: no vertex of it is shared.
    fn textured(&mut self, plane: layout::Plane, corners: [(CityVertex, [f32; 2]); 3]) {
        for (vertex, texcoord) in corners {
            self.gathered.push(vertex, texcoord);
            self.planes.push(plane);
        }
    }

    fn end_tile(&mut self, bounds: Aabb, cell: u32, object: u32) {
        let Self { gathered, planes, owners, .. } = self;
        gathered.weld.end_tile();
        if gathered.group.images.is_none() {
            gathered.weld.rename_tile(|vertex| {
                let (surface, plane) =
                    owners.get(vertex.surface as usize).copied().unwrap_or((NONE, Zeroable::zeroed()));
                vertex.surface = surface;
                planes.push(plane);
            });
        }
        gathered.close_run(bounds, cell, details_of(cell, Detail::Full), object);
    }
}

/// The overlapping triangles of all shared planes, lowest layer first; of each layer, one per group.
fn gather_layers(
    shown: &Shown,
    tiles: &[(u32, u32)],
    facades: &Facades,
    table: &mut SurfaceTable,
    kind: WeldKind,
) -> Vec<Vec<Layer>> {
    let model = shown.model;
    let mut of_tile: FxHashMap<u32, Vec<&CoplanarTriangle>> = FxHashMap::default();
    for c in shown.coplanar {
        of_tile.entry(c.tile).or_default().push(c);
    }
    let count = shown.coplanar.iter().map(|c| c.layer + 1).max().unwrap_or(0);
    let mut layers: Vec<BTreeMap<Group, Layer>> = (0..count).map(|_| BTreeMap::new()).collect();
    // All faces of a plane take their depth from the same numbers.
    let mut planes: FxHashMap<u32, layout::Plane> = FxHashMap::default();
    for (t, cell, triangles) in tiles.iter().filter_map(|(t, cell)| Some((*t, *cell, of_tile.get(t)?))) {
        let tile = &model.tiles[t as usize];
        table.begin_tile();
        layers.iter_mut().flat_map(BTreeMap::values_mut).for_each(|layer| layer.begin_tile(tile.origin));
        for c in triangles {
            let corners = corners_of(model, tile, c.triangle);
            let equation = &model.plane_equations[c.group as usize - 1];
            let plane = *planes.entry(c.group).or_insert_with(|| plane_of(equation, tile.origin));
            let surface = corners[0].surface;
            let group = table.group(surface, tile.texcoords != NONE);
            let facade = facade_corners(model, tile, c.triangle, group, facades, table);
            let group = facade.as_ref().map_or(group, |(group, _)| *group);
            let layer = layers[c.layer as usize].entry(group).or_insert_with(|| {
                let mut layer = Layer::new(kind, group);
                layer.begin_tile(tile.origin);
                layer
            });
            if let Some((_, corners)) = facade {
                layer.textured(plane, corners);
            } else if group.images.is_some() {
                layer.textured(plane, textured_corners(model, tile, c.triangle, table));
            } else {
                let number = table.number(surface, corners[0].normal, false);
                let corners = corners.map(|v| Corner { position: v.position, normal: v.normal });
                layer.triangle(number, c.group, plane, corners);
            }
        }
        layers
            .iter_mut()
            .flat_map(BTreeMap::values_mut)
            .for_each(|layer| layer.end_tile(tile.bounds, cell, object_of(shown.model, tile)));
    }
    layers.into_iter().map(|layer| layer.into_values().collect()).collect()
}

/// A group's plane, relative to a whole-metre origin near it.
fn plane_of(plane: &Plane, near: IVec3) -> layout::Plane {
    let normal = plane.normal.as_vec3();
    // The offset belongs to the rounded normal, measured at the foot of `near` on the exact plane.
    let foot = near.as_dvec3() + plane.normal * (plane.offset - plane.normal.dot(near.as_dvec3()));
    layout::Plane {
        normal: normal.to_array(),
        origin: near.to_array(),
        offset: normal.as_dvec3().dot(foot - near.as_dvec3()) as f32,
    }
}

/// What each vertex has beside a [`CityVertex`]: a name, and one of each.
#[derive(Clone, Copy)]
struct Extra<'a, T> {
    name: &'static str,
    each: &'a [T],
}

impl Extra<'_, u32> {
    const NONE: Self = Self { name: "", each: &[] };
}

/// A section of what was gathered, with what each vertex has beside a [`CityVertex`]; and its triangles and vertices.
fn upload<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    kind: SectionKind,
    gathered: &Gathered,
    extra: Extra<T>,
) -> Result<Option<(Section, usize, usize)>, GpuError> {
    // What deforms it reads it back.
    use wgpu::BufferUsages as U;
    let Weld { vertices, indices, .. } = &gathered.weld;
    if indices.is_empty() {
        return Ok(None);
    }
    let bytes = [size_of_val(&vertices[..]), size_of_val(&indices[..]), size_of_val(extra.each)];
    let usage = U::COPY_SRC | gpu.read_by_corners(bytes.into_iter().max().unwrap_or(0));
    let section = Section {
        kind,
        vertices: gpu.buffer("vertices", U::VERTEX | usage, vertices)?,
        indices: gpu.buffer("indices", U::INDEX | usage, indices)?,
        extra: match extra.each {
            [] => None,
            each => Some(gpu.buffer(extra.name, U::VERTEX | usage, each)?),
        },
        chunks: gathered.chunks(),
        layer: 0,
        has_shadow: gathered.group.has_shadow,
    };
    Ok(Some((section, indices.len() / 3, vertices.len())))
}
