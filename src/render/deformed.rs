//! The deformed city (D1, D2): what deformation lenses move, made fine enough and moved on the card, as sections beside those of what
//! they leave.
//!
//! ```text
//!   chunks of the city ──── meet no support ─────────────────────── drawn as they are
//!        │
//!        └ meet one: each triangle ── meets none ───────────────── drawn from its own section, in runs
//!                          └ refined and moved (render::refinery) ─ sections of a city of its own, with a normal per vertex
//! ```
//!
//! Whatever draws the city asks [`Renderer::drawn_sections`] and so draws this too: shadows, translucent layers, sections and sprites know
//! nothing of deformations. Which triangles are met is found on the host, once for deformations that stay; what they become, anew for every
//! view, since edges are as fine as their error in pixels asks for.

use std::{ops::Range, sync::Arc};

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use crate::{
    geom::{
        Aabb,
        deform::{
            Deformers, Support,
            refine::{Limits, Refiner, Report, order},
        },
    },
    gpu::{Gpu, GpuError},
    render::{
        city::{Chunk, CityBuffers, Section, SectionKind, provoking_corner},
        deform_words::{DeformNumbers, Lattice, plan_of},
        deformed_edges::deformed_edges,
        edges::EdgeBuffers,
        frame::FrameInput,
        layout::{self, CityVertex},
        refinery::{LAYER_SHIFT, Made, Refinery, Rest, TURNED},
        renderer::{CityOnGpu, Renderer},
    },
    view::View,
};

/// How far the edges of what is shown may be from where they should be, pixels.
pub const TOLERANCE_PX: f64 = 0.25;
/// Chunks that a thread looks at at a time.
const CHUNKS_PER_PART: usize = 16;
/// Whole metres that origins of moved vertices are multiples of: offsets up to this are rounded by 2 µm at most.
const ORIGIN_STEP_M: f64 = 32.0;
/// Of the angle between the view's axis and what is refined for it.
const LEAST_COSINE: f64 = 0.25;
/// How far a layer of coplanar faces is lifted off the one below, pixels across their plane: two chords of one curved plane are no further
/// apart. Towards the eye, so that it stays where it is in the picture.
const LIFT_PX: f64 = 2.0 * TOLERANCE_PX;

/// By how much supports are taken to be wider where triangles are found: what the card's numbers may be off, of the way to the pivot, and
/// at least.
const SUPPORT_ERROR: f64 = 4.0 / (1 << 23) as f64;
const LEAST_SUPPORT_ERROR_M: f64 = 1e-3;

/// The corners of a section, on the host.
#[derive(Debug)]
pub(super) struct Source {
    /// Which corner of a triangle flat values come from.
    provoking: usize,
    vertices: Vec<CityVertex>,
    indices: Vec<u32>,
    texcoords: Vec<[f32; 2]>,
}

/// What a deformed city was made of.
#[derive(Clone, Debug, PartialEq)]
struct Of {
    deformers: Arc<Deformers>,
    view: View,
    city: u64,
    /// Whether its edges are there.
    edges: bool,
}

/// What deformations meet of the city, whatever the view.
#[derive(Debug)]
pub(super) struct Met {
    deformers: Arc<Deformers>,
    city: u64,
    /// What each section of the city still draws.
    left: Arc<Vec<Vec<Chunk>>>,
    /// Sections that are met, and which of the chunks are theirs.
    sections: Vec<(SectionKind, Range<usize>)>,
    /// Whose triangles are met; without bounds of what they become.
    chunks: Vec<Chunk>,
    rest: Rest,
}

/// What deformations make of the city in a view.
#[derive(Debug)]
pub(super) struct Deformed {
    of: Of,
    /// What each section of the city still draws.
    pub left: Arc<Vec<Vec<Chunk>>>,
    /// What is moved.
    pub city: CityOnGpu,
    /// The edges that stay as they are, and those that are moved.
    pub edges: Option<[EdgeBuffers; 2]>,
    /// What it took.
    pub figures: DeformedFigures,
}

/// Counts of a deformed city.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeformedFigures {
    /// Triangles of the city that meet a deformation.
    pub met: u64,
    /// What they became.
    pub triangles: u64,
    /// How exact that is.
    pub report: Report,
}

impl Renderer {
    /// Makes the deformed city fit a frame; nothing is made where it does.
    pub(super) fn fit_deformed(&mut self, input: &FrameInput) -> Result<(), GpuError> {
        let Some(city) = &mut self.city else { return Ok(()) };
        if input.deformers.0.is_empty() {
            // What was moved cast another shadow.
            if self.deformed.take().is_some() {
                self.shadow_of = None;
            }
            return Ok(());
        }
        let of = Of {
            deformers: input.deformers.clone(),
            view: input.view,
            city: self.city_number,
            edges: city.edges.is_some(),
        };
        if self.deformed.as_ref().is_some_and(|deformed| deformed.of == of) {
            return Ok(());
        }
        self.shadow_of = None;
        if city.sources.is_none() {
            let sources = city.buffers.sections.iter().map(|section| Source::read(&self.gpu, section));
            city.sources = Some(sources.collect::<Result<_, _>>()?);
        }
        if let (None, Some(edges)) = (&city.edge_sources, &city.edges) {
            city.edge_sources = Some(bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(&edges.instances)?));
        }
        let is_met = |met: &Met| met.deformers == of.deformers && met.city == of.city;
        let met = match self.met.take().filter(is_met) {
            Some(met) => met,
            None => Met::new(&self.gpu, city, &of)?,
        };
        let mut refinery = match self.refinery.take() {
            Some(refinery) => refinery,
            None => Refinery::new(&self.gpu)?,
        };
        let stage = stage_of(&of.view, &met.rest.lattice, city.buffers.smooth);
        let made = refinery.refined(&self.gpu, &met.rest, &stage)?;
        self.refinery = Some(refinery);
        self.deformed = self.deformed_of(&met, made, of)?;
        self.met = Some(met);
        Ok(())
    }

    /// What the deformations of the last frame took; `None`: there were none.
    pub fn deformed_figures(&self) -> Option<DeformedFigures> {
        self.deformed.as_ref().map(|deformed| deformed.figures)
    }

    fn deformed_of(&self, met: &Met, made: Made, of: Of) -> Result<Option<Deformed>, GpuError> {
        let Some(city) = &self.city else { return Ok(None) };
        let figures = DeformedFigures {
            met: u64::from(met.rest.triangles),
            triangles: u64::from(made.triangles),
            report: made.report,
        };
        let bounds = made.chunks.iter().fold(Aabb::EMPTY, |all, (_, bounds)| all.union(*bounds));
        let sections = met.sections.iter().map(|(kind, chunks)| Section {
            // What is bent is in no plane.
            kind: if *kind == SectionKind::Coplanar { SectionKind::Plain } else { *kind },
            vertices: made.vertices.clone(),
            indices: made.indices.clone(),
            extra: made.texcoords.clone().filter(|_| matches!(kind, SectionKind::Textured { .. })),
            chunks: met.chunks[chunks.clone()]
                .iter()
                .zip(&made.chunks[chunks.clone()])
                .map(|(chunk, (range, bounds))| Chunk {
                    range: 3 * range.start..3 * range.end,
                    bounds: *bounds,
                    ..chunk.clone()
                })
                .collect(),
        });
        let sections: Vec<Section> = sections.collect();
        let images = met.sections.iter().map(|(kind, _)| self.image_of(&city.buffers, *kind)).collect();
        let buffers = CityBuffers::of_sections(sections, city.buffers.surfaces.clone(), bounds);
        let view = of.view;
        let pixels_per_m = move |place: DVec3| pixels_per_m(&view, place);
        let refiner = Refiner {
            deformers: &of.deformers,
            pixels_per_m: &pixels_per_m,
            tolerance_px: TOLERANCE_PX,
            shortest_m: Limits::default().shortest_m,
        };
        let of_city = city.edges.as_ref().zip(city.edge_sources.as_ref());
        let edges = of_city.map(|(edges, all)| deformed_edges(&self.gpu, edges, all, &refiner)).transpose()?;
        let city =
            CityOnGpu { group: city.group.clone(), images, buffers, edges: None, sources: None, edge_sources: None };
        Ok(Some(Deformed { of, left: met.left.clone(), city, edges, figures }))
    }
}

/// The view as what is refined is seen in it.
fn stage_of(view: &View, lattice: &Lattice, is_smooth: bool) -> layout::Refinement {
    let (eye, offset) = lattice.cell_of(view.camera.eye);
    layout::Refinement {
        eye: eye.to_array(),
        eye_offset: offset.to_array(),
        forward: view.basis.forward.as_vec3().to_array(),
        pixels: (0.5 * f64::from(view.size[1]) / view.half_extent().y) as f32,
        near: view.camera.near_m as f32,
        orthographic: u32::from(view.is_orthographic()),
        tolerance: TOLERANCE_PX as f32,
        shortest: Limits::default().shortest_m as f32,
        lift: LIFT_PX as f32,
        is_smooth: u32::from(is_smooth),
        ..layout::Refinement::new()
    }
}

/// How many pixels a metre has at a place at most, whichever way it points. What is further aside than any picture reaches counts as if it
/// were nearer to its middle.
fn pixels_per_m(view: &View, place: DVec3) -> f64 {
    let px = 0.5 * f64::from(view.size[1]) / view.half_extent().y;
    if view.is_orthographic() {
        return px;
    }
    let from_eye = place - view.camera.eye;
    let distance = from_eye.length().max(view.camera.near_m);
    let depth = from_eye.dot(view.basis.forward).max(LEAST_COSINE * distance).max(view.camera.near_m);
    px * distance / (depth * depth)
}

/// What is met of some chunks of one section.
#[derive(Default)]
struct MetPart {
    left: Vec<Chunk>,
    /// With the number of triangles that are met of each.
    chunks: Vec<(Chunk, u32)>,
    corners: Vec<CityVertex>,
    texcoords: Vec<[f32; 2]>,
    bits: Vec<u32>,
}

impl Met {
    fn new(gpu: &Gpu, city: &CityOnGpu, of: &Of) -> Result<Self, GpuError> {
        let sections = || city.buffers.sections.iter().zip(city.sources.iter().flatten());
        let bounds = city.buffers.bounds;
        let supports: Vec<Support> = of
            .deformers
            .supports()
            .map(|support| {
                let farthest = bounds.grown(support.frame.pivot).size().length();
                support.grown((SUPPORT_ERROR * farthest).max(LEAST_SUPPORT_ERROR_M))
            })
            .collect();
        let has_textures = sections().any(|(section, _)| matches!(section.kind, SectionKind::Textured { .. }));
        let (mut left, mut met, mut chunks) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = MetPart::default();
        let (mut firsts, mut layer) = (vec![0], 0);
        for (section, source) in sections() {
            let is_coplanar = section.kind == SectionKind::Coplanar;
            let own_layer = if is_coplanar { layer } else { 0 };
            layer += u32::from(is_coplanar);
            // In parts that keep their order.
            let parts: Vec<MetPart> = section
                .chunks
                .par_chunks(CHUNKS_PER_PART)
                .map(|chunks| MetPart::of(chunks, source, &supports, own_layer, has_textures))
                .collect();
            let first = chunks.len();
            let mut own_left = Vec::new();
            for part in parts {
                own_left.extend(part.left);
                for (chunk, triangles) in part.chunks {
                    firsts.push(firsts.last().copied().unwrap_or(0) + triangles);
                    chunks.push(chunk);
                }
                all.corners.extend(part.corners);
                all.texcoords.extend(part.texcoords);
                all.bits.extend(part.bits);
            }
            left.push(own_left);
            if chunks.len() > first {
                met.push((section.kind, first..chunks.len()));
            }
        }
        use wgpu::BufferUsages as U;
        let reach = bounds.union(of.deformers.deformed_bounds(&bounds));
        let lattice = Lattice::around(&reach);
        let is_textured = met.iter().any(|(kind, _)| matches!(kind, SectionKind::Textured { .. }));
        let texcoords = is_textured.then(|| gpu.buffer("texture coordinates at rest", U::STORAGE, &all.texcoords));
        let plan = plan_of(&of.deformers);
        let DeformNumbers { numbers, tables } = DeformNumbers::new(&of.deformers, &plan, &lattice);
        let rest = Rest {
            corners: gpu.buffer("corners at rest", U::STORAGE, &all.corners)?,
            bits: gpu.buffer("triangles at rest", U::STORAGE, &all.bits)?,
            texcoords: texcoords.transpose()?,
            triangles: all.bits.len() as u32,
            firsts,
            lattice,
            numbers: gpu.buffer("numbers of deformations", U::UNIFORM, &numbers)?,
            tables: gpu.buffer("tables of deformations", U::STORAGE, &tables)?,
            plan,
        };
        Ok(Self { deformers: of.deformers.clone(), city: of.city, left: Arc::new(left), sections: met, chunks, rest })
    }
}

impl MetPart {
    fn of(chunks: &[Chunk], source: &Source, supports: &[Support], layer: u32, has_textures: bool) -> Self {
        let mut part = Self::default();
        for chunk in chunks {
            let near: Vec<&Support> = supports.iter().filter(|support| support.reaches(&chunk.bounds)).collect();
            if near.is_empty() {
                part.left.push(chunk.clone());
                continue;
            }
            let before = part.bits.len();
            let mut run = None;
            for start in chunk.range.clone().step_by(3) {
                let at = start as usize;
                let corners = [source.indices[at], source.indices[at + 1], source.indices[at + 2]];
                let places = corners.map(|i| source.place(i));
                if near.iter().any(|support| support.meets_triangle(&places)) {
                    close(&mut run, chunk, source, &mut part.left);
                    part.add(source, corners, &places, layer, has_textures);
                } else {
                    run = Some(run.map_or(start, |run: Range<u32>| run.start)..start + 3);
                }
            }
            close(&mut run, chunk, source, &mut part.left);
            let count = (part.bits.len() - before) as u32;
            if count > 0 {
                part.chunks.push((chunk.clone(), count));
            }
        }
        part
    }

    fn add(&mut self, source: &Source, corners: [u32; 3], places: &[DVec3; 3], layer: u32, has_textures: bool) {
        let mut sorted = [0, 1, 2];
        sorted.sort_by(|&i, &j| order(places[i], places[j]));
        let is_turned = matches!(sorted, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
        let provoking = sorted.iter().position(|&i| i == source.provoking).unwrap_or(0) as u32;
        self.bits.push(provoking | if is_turned { TURNED } else { 0 } | layer << LAYER_SHIFT);
        for i in sorted.map(|i| corners[i] as usize) {
            self.corners.push(source.vertices[i]);
            if has_textures {
                self.texcoords.push(source.texcoords.get(i).copied().unwrap_or_default());
            }
        }
    }
}

impl Source {
    /// What the card has of a section.
    fn read(gpu: &Gpu, section: &Section) -> Result<Self, GpuError> {
        let of = |buffer: &wgpu::Buffer| gpu.read_buffer(buffer);
        let texcoords = match (section.kind, &section.extra) {
            (SectionKind::Textured { .. }, Some(extra)) => bytemuck::pod_collect_to_vec(&of(extra)?),
            _ => Vec::new(),
        };
        let vertices = bytemuck::pod_collect_to_vec(&of(&section.vertices)?);
        let provoking = provoking_corner(gpu);
        Ok(Self { provoking, vertices, indices: bytemuck::pod_collect_to_vec(&of(&section.indices)?), texcoords })
    }

    /// Where a vertex is, exactly.
    fn place(&self, index: u32) -> DVec3 {
        let CityVertex { origin, position, .. } = self.vertices[index as usize];
        IVec3::from(origin).as_dvec3() + Vec3::from(position).as_dvec3()
    }
}

/// The whole metres that a place which was moved is counted from: a function of the place, so that neighbours have the same.
pub(super) fn origin_of(place: DVec3) -> DVec3 {
    (place / ORIGIN_STEP_M).floor() * ORIGIN_STEP_M
}

/// Ends a run of triangles that stay: a chunk of them.
fn close(run: &mut Option<Range<u32>>, chunk: &Chunk, source: &Source, left: &mut Vec<Chunk>) {
    let Some(range) = run.take() else { return };
    let indices = &source.indices[range.start as usize..range.end as usize];
    let bounds = Aabb::from_points(indices.iter().map(|&i| source.place(i)));
    left.push(Chunk { range, bounds, ..chunk.clone() });
}
