//! The deformed city (D1, D2): what deformation lenses move, made fine enough and moved on the host, as sections beside those of what
//! they leave.
//!
//! ```text
//!   chunks of the city ──── meet no support ─────────────────────── drawn as they are
//!        │
//!        └ meet one: each triangle ── meets none ───────────────── drawn from its own section, in runs
//!                          └ refined and moved (geom::deform) ──── sections of a city of its own, with a normal per vertex
//! ```
//!
//! Whatever draws the city asks [`Renderer::drawn_sections`] and so draws this too: shadows, translucent layers, sections and sprites know
//! nothing of deformations. Kept while nothing that it was made of changes: the view is part of that, since edges are as fine as their error
//! in pixels asks for.

use std::{ops::Range, sync::Arc};

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use crate::{
    city::{decode_normal, encode_normal},
    geom::{
        Aabb,
        deform::{
            Deformers,
            refine::{Limits, RefinedVertex, Refiner, Report, refined},
        },
    },
    gpu::{Gpu, GpuError},
    render::{
        city::{Chunk, CityBuffers, Section, SectionKind, provoking_corner},
        deformed_edges::deformed_edges,
        edges::EdgeBuffers,
        frame::FrameInput,
        layout::CityVertex,
        renderer::{CityOnGpu, Renderer},
    },
    view::View,
};

/// How far the edges of what is shown may be from where they should be, pixels.
pub const TOLERANCE_PX: f64 = 0.25;
/// Whole metres that origins of moved vertices are multiples of: offsets up to this are rounded by 2 µm at most.
const ORIGIN_STEP_M: f64 = 32.0;
/// Of the angle between the view's axis and what is refined for it.
const LEAST_COSINE: f64 = 0.25;
/// How far a layer of coplanar faces is lifted off the one below, pixels: two chords of one curved plane are no further apart.
const LIFT_PX: f64 = 2.0 * TOLERANCE_PX;

/// The corners of a section, on the host.
#[derive(Debug)]
pub(super) struct Source {
    /// Whether each vertex has a normal of its own.
    is_smooth: bool,
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

/// What deformations make of the city in a view.
#[derive(Debug)]
pub(super) struct Deformed {
    of: Of,
    /// What each section of the city still draws.
    pub left: Vec<Vec<Chunk>>,
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
    /// The least exact part.
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
            let sources =
                city.buffers.sections.iter().map(|section| Source::read(&self.gpu, section, city.buffers.smooth));
            city.sources = Some(sources.collect::<Result<_, _>>()?);
        }
        if let (None, Some(edges)) = (&city.edge_sources, &city.edges) {
            city.edge_sources = Some(bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(&edges.instances)?));
        }
        let Some(city) = &self.city else { return Ok(()) };
        self.deformed = Some(self.deform(city, of)?);
        Ok(())
    }

    /// What the deformations of the last frame took; `None`: there were none.
    pub fn deformed_figures(&self) -> Option<DeformedFigures> {
        self.deformed.as_ref().map(|deformed| deformed.figures)
    }

    fn deform(&self, city: &CityOnGpu, of: Of) -> Result<Deformed, GpuError> {
        let view = &of.view;
        let pixels_per_m = move |place: DVec3| pixels_per_m(view, place);
        let work = Work { deformers: &of.deformers, pixels_per_m: &pixels_per_m };
        let (mut left, mut sections) = (Vec::new(), Vec::new());
        let mut figures = DeformedFigures::default();
        let (mut bounds, mut layer) = (Aabb::EMPTY, 0);
        for (section, source) in city.buffers.sections.iter().zip(city.sources.iter().flatten()) {
            let lift = if section.kind == SectionKind::Coplanar { f64::from(layer) * LIFT_PX } else { 0.0 };
            layer += u32::from(section.kind == SectionKind::Coplanar);
            let made = work.section(section, source, lift);
            figures.add(&made);
            bounds = made.chunks.iter().fold(bounds, |all, chunk| all.union(chunk.bounds));
            if !made.indices.is_empty() {
                sections.push((section.kind, made.upload(&self.gpu, section.kind)?));
            }
            left.push(made.left);
        }
        let refiner = Refiner {
            deformers: &of.deformers,
            pixels_per_m: &pixels_per_m,
            tolerance_px: TOLERANCE_PX,
            shortest_m: Limits::default().shortest_m,
        };
        let of_city = city.edges.as_ref().zip(city.edge_sources.as_ref());
        let edges = of_city.map(|(edges, all)| deformed_edges(&self.gpu, edges, all, &refiner)).transpose()?;
        let images = sections.iter().map(|(kind, _)| self.image_of(&city.buffers, *kind)).collect();
        let buffers = CityBuffers::of_sections(
            sections.into_iter().map(|(_, section)| section).collect(),
            city.buffers.surfaces.clone(),
            bounds,
        );
        let city =
            CityOnGpu { group: city.group.clone(), images, buffers, edges: None, sources: None, edge_sources: None };
        Ok(Deformed { of, left, city, edges, figures })
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

/// How a section is deformed.
struct Work<'a> {
    deformers: &'a Deformers,
    pixels_per_m: &'a (dyn Fn(DVec3) -> f64 + Sync),
}

/// What a section becomes.
#[derive(Default)]
struct Made {
    left: Vec<Chunk>,
    vertices: Vec<CityVertex>,
    texcoords: Vec<[f32; 2]>,
    indices: Vec<u32>,
    chunks: Vec<Chunk>,
    met: u64,
    report: Report,
}

impl Work<'_> {
    fn section(&self, section: &Section, source: &Source, lift_px: f64) -> Made {
        let mut made = Made::default();
        let is_met = |chunk: &Chunk| self.deformers.supports().any(|support| support.reaches(&chunk.bounds));
        let (met, left): (Vec<&Chunk>, Vec<&Chunk>) = section.chunks.iter().partition(|chunk| is_met(chunk));
        if met.is_empty() {
            made.left = section.chunks.clone();
            return made;
        }
        made.left = left.into_iter().cloned().collect();
        let (mut positions, mut triangles, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for chunk in &met {
            for triangle in source.indices[range_of(chunk)].chunks_exact(3) {
                let first = positions.len() as u32;
                positions.extend(triangle.iter().map(|&i| source.place(i)));
                triangles.push([first, first + 1, first + 2]);
                corners.push([triangle[0], triangle[1], triangle[2]]);
            }
        }
        let refined =
            refined(&positions, &triangles, self.deformers, self.pixels_per_m, TOLERANCE_PX, Limits::default());
        made.report = refined.report;
        made.met = (triangles.len() - refined.kept.len()) as u64;
        let moved: Vec<Moved> =
            refined.vertices.par_iter().map(|vertex| self.vertex(source, &corners, vertex, lift_px)).collect();
        made.vertices = moved.iter().map(|moved| moved.vertex).collect();
        if !source.texcoords.is_empty() {
            made.texcoords = moved.iter().map(|moved| moved.texcoord).collect();
        }
        made.indices = refined.triangles.iter().flatten().copied().collect();
        // Both kept and refined triangles stand in the order of those given.
        let mut kept = refined.kept.iter().copied().peekable();
        let mut next = 0;
        let source_of = |triangle: &[u32; 3]| refined.vertices[triangle[0] as usize].source;
        let mut number = 0;
        for chunk in met {
            let (mut run, from, mut bounds) = (None, next, Aabb::EMPTY);
            for start in chunk.range.clone().step_by(3) {
                if kept.next_if_eq(&number).is_some() {
                    run = Some(run.map_or(start, |run: Range<u32>| run.start)..start + 3);
                } else {
                    close(&mut run, chunk, source, &mut made.left);
                    while refined.triangles.get(next).is_some_and(|triangle| source_of(triangle) == number) {
                        bounds =
                            bounds.union(Aabb::from_points(refined.triangles[next].map(|i| moved[i as usize].place)));
                        next += 1;
                    }
                }
                number += 1;
            }
            close(&mut run, chunk, source, &mut made.left);
            if next > from {
                made.chunks.push(Chunk { range: 3 * from as u32..3 * next as u32, bounds, ..chunk.clone() });
            }
        }
        made
    }

    /// A corner of what a triangle became, as the card reads it; `corners`: of the triangles that were given.
    fn vertex(&self, source: &Source, corners: &[[u32; 3]], vertex: &RefinedVertex, lift_px: f64) -> Moved {
        let corners = corners[vertex.source as usize];
        let own = corners.map(|i| &source.vertices[i as usize]);
        let weights = vertex.weights.to_array();
        // What is flat is that of the provoking corner.
        let flat = own[source.provoking];
        let normal = match source.is_smooth {
            true => (0..3).map(|i| weights[i] * decode_normal(own[i].normal)).sum(),
            false => decode_normal(flat.normal),
        };
        let normal = (vertex.normals * normal).try_normalize().unwrap_or(DVec3::Z);
        let lift = if lift_px == 0.0 { 0.0 } else { lift_px / (self.pixels_per_m)(vertex.shown) };
        let place = vertex.shown + lift * normal;
        let origin = origin_of(place);
        let offset = (place - origin).as_vec3().to_array();
        let texcoord = [0, 1].map(|axis| {
            let of = |i: usize| source.texcoords.get(corners[i] as usize).map_or(0.0, |t| f64::from(t[axis]));
            (0..3).map(|i| weights[i] * of(i)).sum::<f64>() as f32
        });
        let vertex = CityVertex::new(origin.as_ivec3(), flat.surface, offset, encode_normal(normal));
        Moved { vertex, texcoord, place }
    }
}

/// A moved corner.
struct Moved {
    vertex: CityVertex,
    texcoord: [f32; 2],
    /// Where it is shown, metres.
    place: DVec3,
}

impl Source {
    /// What the card has of a section.
    fn read(gpu: &Gpu, section: &Section, is_smooth: bool) -> Result<Self, GpuError> {
        let of = |buffer: &wgpu::Buffer| gpu.read_buffer(buffer);
        let texcoords = match (section.kind, &section.extra) {
            (SectionKind::Textured { .. }, Some(extra)) => bytemuck::pod_collect_to_vec(&of(extra)?),
            _ => Vec::new(),
        };
        let vertices = bytemuck::pod_collect_to_vec(&of(&section.vertices)?);
        let provoking = provoking_corner(gpu);
        Ok(Self {
            is_smooth,
            provoking,
            vertices,
            indices: bytemuck::pod_collect_to_vec(&of(&section.indices)?),
            texcoords,
        })
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

fn range_of(chunk: &Chunk) -> Range<usize> {
    chunk.range.start as usize..chunk.range.end as usize
}

/// Ends a run of triangles that stay: a chunk of them.
fn close(run: &mut Option<Range<u32>>, chunk: &Chunk, source: &Source, left: &mut Vec<Chunk>) {
    let Some(range) = run.take() else { return };
    let indices = &source.indices[range.start as usize..range.end as usize];
    let bounds = Aabb::from_points(indices.iter().map(|&i| source.place(i)));
    left.push(Chunk { range, bounds, ..chunk.clone() });
}

impl Made {
    fn upload(&self, gpu: &Gpu, kind: SectionKind) -> Result<Section, GpuError> {
        let extra = match self.texcoords.is_empty() {
            true => None,
            false => Some(gpu.buffer("deformed texture coordinates", wgpu::BufferUsages::VERTEX, &self.texcoords)?),
        };
        Ok(Section {
            // What is bent is in no plane.
            kind: if kind == SectionKind::Coplanar { SectionKind::Plain } else { kind },
            vertices: gpu.buffer("deformed vertices", wgpu::BufferUsages::VERTEX, &self.vertices)?,
            indices: gpu.buffer("deformed indices", wgpu::BufferUsages::INDEX, &self.indices)?,
            extra,
            chunks: self.chunks.clone(),
        })
    }
}

impl DeformedFigures {
    fn add(&mut self, made: &Made) {
        self.met += made.met;
        self.triangles += made.indices.len() as u64 / 3;
        let (all, own) = (&mut self.report, &made.report);
        all.tolerance_px = all.tolerance_px.max(own.tolerance_px);
        all.shortest_m = all.shortest_m.max(own.shortest_m);
        all.too_coarse += own.too_coarse;
        all.unusable += own.unusable;
    }
}
