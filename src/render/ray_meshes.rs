//! Triangles of what is drawn, and hierarchies of boxes over them, as `pass/rays.wgsl` follows rays through them.
//!
//! They are read back from what the geometry passes draw, so that contents, what moves and what deformations make are there as they are drawn.
//! Corners are whole steps of a grid: those of neighbours are the same to the bit. The grid is as fine as i32 lets it be, for a city of a
//! kilometre 2 µm.

use std::ops::Range;

use glam::{DMat3, DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    city::NONE,
    geom::{
        Aabb,
        bvh::{Bvh, FlatNode},
    },
    gpu::{Gpu, GpuError},
    render::{
        cells::Detail,
        cities::{Cities, DrawnSection},
        city::{Chunk, Section, SectionKind},
        city_source::Source,
        layout,
        plan::FramePlan,
        ray_tracer::TracedCity,
        ray_vertices::CityTriangles,
        resource::synced::Room,
    },
    view::View,
};

/// As `pass/rays.wgsl` has them.
pub(super) const NO_BOXES: u32 = u32::MAX;
pub(super) const IN_PLANE: u32 = 1;
const FACADE: u32 = 2;
const SMOOTH: u32 = 4;
const PLACED: u32 = 8;
pub(super) const LAYER_SHIFT: u32 = 8;
pub(super) const LAYER_MASK: u32 = 0xff;
const SECTION_SHIFT: u32 = 16;
/// Sections with images of a city, at most.
const MOST_SECTIONS: usize = 0xffff;
/// Boxes below each other, at most.
const MOST_DEPTH: usize = 60;
/// Cities that rays are followed through, at most.
pub const MOST_RAY_CITIES: usize = 128;
/// Steps of the grid from its middle, at most.
const MOST_STEPS: f64 = (1 << 29) as f64;
/// Steps of the grid to an eye that is told by whole ones.
const FARTHEST_EYE: f64 = (1 << 30) as f64;
/// A step of the grid, at least: as a power of two, of metres.
const FINEST: i32 = -20;
/// Boxes are larger by this part of the city: what places of rays are rounded by where boxes are counted.
const PADDING: f64 = 1.0 / (1 << 22) as f64;

pub(super) type Word = [u32; 4];

/// What a mesh was made of: buffers, and the runs of their indices.
type MadeOf = Vec<(wgpu::Buffer, Vec<Range<u32>>)>;

/// Triangles that stand together.
#[derive(Debug)]
struct Mesh {
    of: MadeOf,
    words: Vec<Word>,
    /// Whether rays can be followed through it.
    has_boxes: bool,
    /// Where its triangles begin among them, and how many there are.
    first_triangle: u32,
    triangles: u32,
    /// The middle of its grid and of its boxes, whole metres, and the length of a step, metres.
    origin: DVec3,
    step: f64,
}

/// Where a drawn city stands: its mesh, and the offset of its `City`.
#[derive(Clone, Copy, Debug)]
struct Standing {
    mesh: usize,
    offset: u32,
}

/// What rays are followed through, between frames.
#[derive(Debug)]
pub(super) struct RayMeshes {
    meshes: Vec<Mesh>,
    /// All of their words, and where those of each begin.
    pub words: Room,
    begins: Vec<u32>,
    standing: Vec<Standing>,
    /// Triangles of all of them.
    pub triangles: u64,
    /// The images of what is drawn, and which city and section they are of.
    pub images: Vec<(u32, RayImages)>,
}

/// The images of a section, and whether one says how much of its own light there is.
#[derive(Clone, Debug)]
pub(super) struct RayImages {
    pub group: wgpu::BindGroup,
    pub emits: bool,
}

/// A triangle on its way to the GPU.
struct Triangle {
    corners: [IVec3; 3],
    surface: u32,
    kind: u32,
    rest: Vec<Word>,
}

/// The parts of sections that stand together.
struct Group<'a> {
    offset: u32,
    parts: Vec<(DrawnSection<'a>, Vec<&'a Chunk>)>,
}

impl RayMeshes {
    /// Nothing yet.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let advice = "a smaller city, or no lens that bends rays";
        let words =
            Room::new(gpu, "triangles of rays", wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST, advice)?;
        Ok(Self {
            meshes: Vec::new(),
            words,
            begins: Vec::new(),
            standing: Vec::new(),
            triangles: 0,
            images: Vec::new(),
        })
    }

    /// Makes them those of what a frame draws, with hierarchies where rays are followed; `true`: the buffer is another one now.
    pub fn fit(&mut self, gpu: &Gpu, plan: &FramePlan, cities: &Cities, follows: bool) -> Result<bool, GpuError> {
        let drawn = cities.drawn_sections(&plan.details, plan.cuts.picture.as_ref());
        let groups = groups_of(&drawn);
        let sections = groups.iter().map(|group| group.parts.len()).max().unwrap_or(0);
        for (what, count, most) in [
            (
                "cities, contents and things that move, seen through lenses that bend rays",
                groups.len(),
                MOST_RAY_CITIES,
            ),
            ("materials of a city that is seen through lenses that bend rays", sections, MOST_SECTIONS),
        ] {
            if count > most {
                return Err(GpuError::TooMany { what, count, most });
            }
        }
        let mut before: Vec<Option<Mesh>> = std::mem::take(&mut self.meshes).into_iter().map(Some).collect();
        let mut is_other = false;
        self.standing.clear();
        self.images.clear();
        for group in &groups {
            let of = made_of(group);
            let known = self.meshes.iter().position(|mesh| mesh.of == of);
            let mesh = match known {
                Some(mesh) => mesh,
                None => {
                    let serves = |mesh: &Mesh| mesh.of == of && (mesh.has_boxes || !follows);
                    let kept = before.iter().position(|mesh| mesh.as_ref().is_some_and(serves));
                    // One that has another place among them has its words elsewhere.
                    is_other |= kept != Some(self.meshes.len());
                    let mesh = match kept.and_then(|kept| before[kept].take()) {
                        Some(mesh) => mesh,
                        None => Mesh::new(gpu, group, of, follows)?,
                    };
                    self.meshes.push(mesh);
                    self.meshes.len() - 1
                }
            };
            self.images.extend(images_of(group, self.standing.len() as u32));
            self.standing.push(Standing { mesh, offset: group.offset });
        }
        if !is_other && self.meshes.len() == before.len() && self.begins.len() == before.len() {
            return Ok(false);
        }
        self.upload(gpu)
    }

    fn upload(&mut self, gpu: &Gpu) -> Result<bool, GpuError> {
        self.begins.clear();
        let mut count = 0;
        for mesh in &self.meshes {
            self.begins.push(count as u32);
            count += mesh.words.len();
        }
        self.triangles = self.meshes.iter().map(|mesh| u64::from(mesh.triangles)).sum();
        let grown = self.words.fit(gpu, (count * size_of::<Word>()) as u64)?;
        for (mesh, first) in self.meshes.iter().zip(&self.begins) {
            gpu.write_from(self.words.buffer(), u64::from(*first) * size_of::<Word>() as u64, &mesh.words);
        }
        Ok(grown)
    }

    /// The cities as the shader reads them.
    pub fn uniform(cities: &[TracedCity]) -> Vec<u8> {
        let mut all: Vec<layout::RayCity> = cities.iter().map(|city| city.own).collect();
        let count = all.len() as u32;
        all.resize(MOST_RAY_CITIES, bytemuck::Zeroable::zeroed());
        let mut bytes = bytemuck::bytes_of(&[count, 0, 0, 0]).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&all));
        bytes
    }

    /// What rays are followed through. `placed`: the `City` of each offset, or nothing where all stands where it is.
    pub fn traced(&self, view: &View, placed: &[u8]) -> Vec<TracedCity<'_>> {
        let view_from_world = view.basis.view_from_world();
        let of = |(number, standing): (u32, &Standing)| {
            let (mesh, first) = (&self.meshes[standing.mesh], self.begins[standing.mesh]);
            let Stand { own, linear, eye } = standing.stand(view, placed);
            let inverse = linear.inverse();
            let steps = (eye - mesh.origin) / mesh.step;
            let whole = steps.round().clamp(DVec3::splat(-FARTHEST_EYE), DVec3::splat(FARTHEST_EYE));
            let [from_view_x, from_view_y, from_view_z] = columns(inverse * view_from_world.transpose(), mesh.step);
            let [world_x, world_y, world_z] = columns(linear, own.scale.into());
            let own = layout::RayCity {
                from_view_x,
                from_view_y,
                from_view_z,
                eye: whole.as_ivec3().to_array(),
                surfaces: own.first_surface,
                eye_fraction: (steps - whole).as_vec3().to_array(),
                number: own.number,
                eye_in_boxes: (eye - mesh.origin).as_vec3().to_array(),
                boxes: if mesh.triangles == 0 { NO_BOXES } else { first },
                triangles: first + mesh.first_triangle,
                pad_0: [0; 3],
                world_x,
                world_y,
                world_z,
            };
            TracedCity { own, words: &mesh.words, first, number }
        };
        (0..).zip(&self.standing).map(of).collect()
    }

    /// The triangles of each, as a view has them.
    pub fn cities(&self, view: &View, placed: &[u8]) -> Vec<CityTriangles<'_>> {
        let of = |(city, standing): (u32, &Standing)| {
            let (mesh, begin) = (&self.meshes[standing.mesh], self.begins[standing.mesh]);
            let Stand { linear, eye, .. } = standing.stand(view, placed);
            let first = mesh.first_triangle;
            CityTriangles {
                words: &mesh.words[first as usize..(first + 3 * mesh.triangles) as usize],
                first: begin + first,
                city,
                to_view: view.basis.view_from_world() * linear * mesh.step,
                eye: (eye - mesh.origin) / mesh.step,
            }
        };
        (0..).zip(&self.standing).map(of).collect()
    }
}

/// Where a city stands, and where the eye is in its own space.
struct Stand {
    own: layout::City,
    /// From its own space to the world's.
    linear: DMat3,
    eye: DVec3,
}

impl Standing {
    fn stand(&self, view: &View, placed: &[u8]) -> Stand {
        let at = self.offset as usize;
        let own: layout::City = match placed.get(at..at + size_of::<layout::City>()) {
            Some(bytes) => bytemuck::pod_read_unaligned(bytes),
            None => layout::City { scale: 1.0, linear: columns(DMat3::IDENTITY, 0.0), ..bytemuck::Zeroable::zeroed() },
        };
        let column = |c: [f32; 4]| DVec3::new(c[0].into(), c[1].into(), c[2].into());
        let linear = DMat3::from_cols(column(own.linear[0]), column(own.linear[1]), column(own.linear[2]));
        // Without a place of its own it is counted from the eye.
        let eye = match placed.is_empty() {
            true => view.camera.eye,
            false => {
                let from = IVec3::from(own.from_whole).as_dvec3() + glam::Vec3::from(own.from_fraction).as_dvec3();
                from - linear.inverse() * glam::Vec3::from(own.to).as_dvec3()
            }
        };
        Stand { own, linear, eye }
    }
}

/// Columns of a matrix, each with a number behind it.
fn columns(m: DMat3, w: f64) -> [[f32; 4]; 3] {
    [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3().extend(w as f32).to_array())
}

/// What is drawn, by where it stands. The scene's own city is there in full detail.
fn groups_of<'a>(drawn: &[DrawnSection<'a>]) -> Vec<Group<'a>> {
    let mut groups: Vec<Group> = Vec::new();
    let mut numbers: FxHashMap<(usize, u32), usize> = FxHashMap::default();
    for section in drawn {
        let is_wanted = |chunk: &&Chunk| section.content.is_some() || chunk.details & Detail::Full.bit() != 0;
        let chunks: Vec<&Chunk> = section.chunks.iter().filter(is_wanted).collect();
        if chunks.is_empty() {
            continue;
        }
        let place = (std::ptr::from_ref(section.city) as usize, section.offset);
        let number = *numbers.entry(place).or_insert_with(|| {
            groups.push(Group { offset: section.offset, parts: Vec::new() });
            groups.len() - 1
        });
        groups[number].parts.push((*section, chunks));
    }
    groups
}

/// The images of a city's sections, those of storeys and windows left out.
fn images_of(group: &Group, city: u32) -> Vec<(u32, RayImages)> {
    let of = |(number, (drawn, _)): (u32, &(DrawnSection, Vec<&Chunk>))| {
        let images = drawn.section.kind.images().filter(|images| !images.facade)?;
        Some((
            city << SECTION_SHIFT | number,
            RayImages { group: drawn.image?.by_level.clone(), emits: images.emission != NONE },
        ))
    };
    (1..).zip(&group.parts).filter_map(of).collect()
}

fn made_of(group: &Group) -> MadeOf {
    let runs = |chunks: &[&Chunk]| {
        let mut runs: Vec<Range<u32>> = Vec::new();
        for chunk in chunks {
            match runs.last_mut().filter(|last| last.end == chunk.range.start) {
                Some(last) => last.end = chunk.range.end,
                None => runs.push(chunk.range.clone()),
            }
        }
        runs
    };
    group.parts.iter().map(|(drawn, chunks)| (drawn.section.vertices.clone(), runs(chunks))).collect()
}

impl Mesh {
    fn new(gpu: &Gpu, group: &Group, of: MadeOf, follows: bool) -> Result<Self, GpuError> {
        let sources: Result<Vec<(Source, Vec<layout::Plane>)>, GpuError> = group
            .parts
            .iter()
            .map(|(drawn, _)| Ok((Source::read(gpu, drawn.section)?, planes_of(gpu, drawn.section)?)))
            .collect();
        let sources = sources?;
        let parts =
            || group.parts.iter().zip(&sources).zip(&of).map(|(((drawn, _), source), (_, runs))| (drawn, source, runs));
        let mut bounds = Aabb::EMPTY;
        for (_, (source, _), runs) in parts() {
            for run in runs {
                let own = &source.indices[run.start as usize..run.end as usize];
                bounds = bounds.union(Aabb::from_points(own.iter().map(|&i| source.place(i))));
            }
        }
        let origin = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().round() };
        let reach = (bounds.min - origin).abs().max((bounds.max - origin).abs()).max_element().max(1.0);
        let exponent = ((reach / MOST_STEPS).log2().ceil() as i32).max(FINEST);
        let step = 2.0_f64.powi(exponent);
        let mut triangles: Vec<Triangle> = Vec::new();
        for (number, (drawn, (source, planes), runs)) in (1..).zip(parts()) {
            let made = Made { drawn, number, source, planes, origin, step };
            let starts: Vec<u32> = runs.iter().flat_map(|run| run.clone().step_by(3)).collect();
            let own: Vec<Triangle> = starts.par_iter().map(|&start| made.triangle(start as usize)).collect();
            triangles.extend(own);
        }
        let around = |t: &Triangle| {
            let around = Aabb::from_points(t.corners.iter().map(|c| c.as_dvec3() * step));
            let pad = PADDING * reach;
            Aabb { min: around.min - pad, max: around.max + pad }
        };
        let (nodes, items) = match follows {
            true => {
                let boxes: Vec<Aabb> = triangles.par_iter().map(around).collect();
                Bvh::build(&boxes).flat(MOST_DEPTH, &boxes)
            }
            false => (Vec::new(), (0..triangles.len() as u32).collect()),
        };
        Ok(Self { has_boxes: follows, ..Self::of_parts(of, &triangles, &nodes, &items, origin, step) })
    }

    fn of_parts(
        of: MadeOf,
        triangles: &[Triangle],
        nodes: &[FlatNode],
        items: &[u32],
        origin: DVec3,
        step: f64,
    ) -> Self {
        let first_triangle = 2 * nodes.len();
        let first_rest = first_triangle + 3 * items.len();
        let mut words: Vec<Word> = Vec::with_capacity(first_rest);
        for node in nodes {
            let corner = |c: [f32; 3], last: u32| [c[0].to_bits(), c[1].to_bits(), c[2].to_bits(), last];
            words.extend([corner(node.min, node.first), corner(node.max, node.count)]);
        }
        let mut rests: Vec<Word> = Vec::new();
        for &item in items {
            let Triangle { corners: [a, b, c], surface, kind, rest } = &triangles[item as usize];
            let corner = |c: &IVec3, last: u32| [c.x as u32, c.y as u32, c.z as u32, last];
            let at = (first_rest + rests.len()) as u32;
            words.extend([corner(a, *surface), corner(b, *kind), corner(c, at)]);
            rests.extend_from_slice(rest);
        }
        words.extend(rests);
        let (first_triangle, triangles) = (first_triangle as u32, items.len() as u32);
        Self { of, words, has_boxes: true, first_triangle, triangles, origin, step }
    }
}

/// What triangles of a section are made of.
struct Made<'a> {
    drawn: &'a DrawnSection<'a>,
    /// Its number among the city's, from 1.
    number: u32,
    source: &'a Source,
    planes: &'a [layout::Plane],
    origin: DVec3,
    step: f64,
}

impl Made<'_> {
    /// The triangle whose indices begin there.
    fn triangle(&self, start: usize) -> Triangle {
        let Self { drawn, number, source, planes, origin, step } = *self;
        let indices = [0, 1, 2].map(|k| source.indices[start + k]);
        let grid = |place: DVec3| ((place - origin) / step).round().as_ivec3();
        let vertex = |i: u32| &source.vertices[i as usize];
        let provoking = vertex(indices[source.provoking]);
        let mut kind = drawn.layer.min(LAYER_MASK) << LAYER_SHIFT;
        let mut rest: Vec<Word> = Vec::new();
        if let Some(plane) = planes.get(indices[source.provoking] as usize) {
            kind |= IN_PLANE;
            let [x, y, z] = plane.normal.map(f32::to_bits);
            let at = grid(IVec3::from(plane.origin).as_dvec3());
            rest.extend([[x, y, z, plane.offset.to_bits()], [at.x as u32, at.y as u32, at.z as u32, 0]]);
        }
        if drawn.city.buffers.smooth {
            kind |= SMOOTH;
            let [a, b, c] = indices.map(|i| vertex(i).normal);
            rest.push([a, b, c, 0]);
        }
        if let Some(images) = drawn.section.kind.images() {
            kind |= PLACED | if images.facade { FACADE } else { number << SECTION_SHIFT };
            let [a, b, c] =
                indices.map(|i| source.texcoords.get(i as usize).copied().unwrap_or_default().map(f32::to_bits));
            rest.extend([[a[0], a[1], b[0], b[1]], [c[0], c[1], 0, 0]]);
        }
        let corners = indices.map(|i| grid(source.place(i)));
        Triangle { corners, surface: provoking.surface, kind, rest }
    }
}

/// The planes of the corners of a section whose faces share some.
fn planes_of(gpu: &Gpu, section: &Section) -> Result<Vec<layout::Plane>, GpuError> {
    let Some(extra) = &section.extra else { return Ok(Vec::new()) };
    Ok(match section.kind {
        SectionKind::Coplanar(None) => bytemuck::pod_collect_to_vec(&gpu.read_buffer(extra)?),
        SectionKind::Coplanar(Some(_)) => {
            let each: Vec<layout::TexturedPlane> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(extra)?);
            each.iter().map(|corner| corner.plane).collect()
        }
        SectionKind::Plain | SectionKind::Textured(_) => Vec::new(),
    })
}
