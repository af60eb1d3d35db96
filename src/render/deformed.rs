//! Deformed cities: what deformation lenses move of the scene's own city and of contents, made fine enough and moved on the GPU, as
//! sections beside those of what they leave.
//!
//! ```text
//!   chunks of the city ──── meet no support ─────────────────────── drawn as they are
//!        │
//!        └ meet one: each triangle ── meets none ───────────────── drawn from its own section, in runs
//!                          └ refined and moved (render::refinery) ─ sections of a city of its own, with a normal per vertex
//! ```
//!
//! Whatever draws the city asks [`Cities::drawn_sections`](crate::render::cities::Cities::drawn_sections) and so draws this too: shadows, translucent layers, sections and sprites know
//! nothing of deformations. Which triangles are met is found on the host, once for deformations that stay; what they become, anew for every
//! view, since edges are as fine as their error in pixels asks for.

use std::{ops::Range, sync::Arc};

use bytemuck::Zeroable;
use glam::DVec3;
use rayon::prelude::*;

use crate::{
    geom::{
        Aabb,
        deform::{
            Support,
            refine::{Limits, Refiner, Report, order},
        },
    },
    gpu::{Gpu, GpuError},
    render::{
        city::{Chunk, CityBuffers, Section, SectionKind},
        city_on_gpu::{CityOnGpu, image_of},
        city_source::Source,
        contents::Contents,
        deform_words::Lattice,
        deformed_edges::{RestEdges, deformed_edges},
        edges::EdgeBuffers,
        frame::FrameInput,
        heights::{Height, Heights},
        layout::{self, CityVertex},
        light::{casts_shadows, occludes_sky},
        moved::Moved,
        refinery::{LAYER_SHIFT, Made, Refinery, Rest, RestTriangles, TURNED},
        resource::pipelines::Pipelines,
        standing::{Placement, Standing, World},
        volume::LensVolume,
    },
    view::View,
};

/// Chunks that a thread looks at at a time.
const CHUNKS_PER_PART: usize = 16;
/// Whole metres that origins of moved vertices are multiples of: offsets up to this are rounded by 2 µm at most.
const ORIGIN_STEP_M: f64 = 32.0;
/// Places at which an edge is looked at where it is measured.
const CHORD_SAMPLES: u32 = 32;
/// Less than this is rounding, pixels.
const LEAST_CHORD_PX: f64 = 1e-4;
/// Of the angle between the view's axis and what is refined for it.
const LEAST_COSINE: f64 = 0.25;
/// How far a layer of coplanar faces is lifted off the one below, towards the eye, by the tolerance: it stays where it is in the picture. Two
/// chords of one curved plane may be twice the tolerance apart, but walls between houses that are lifted by so much come through the roofs.
const LIFT: f64 = 0.5;

/// What is narrower in the picture, of its longest side, is not drawn: corners are rounded to f32 before slopes are told from them.
const NARROWEST: f64 = 4.0 / (1 << 23) as f64;

/// By how much supports are taken to be wider where triangles are found: what the GPU's numbers may be off, of the way to the pivot, and
/// at least.
const SUPPORT_ERROR: f64 = 4.0 / (1 << 23) as f64;
const LEAST_SUPPORT_ERROR_M: f64 = 1e-3;

/// What a deformed city was made of.
#[derive(Clone, Debug, PartialEq)]
struct Of {
    world: World,
    moved: Moved,
    view: View,
    chord_px: f64,
    city: u64,
    /// Whether its edges are there.
    edges: bool,
}

/// What deformations meet of a city, whatever the view.
#[derive(Debug)]
pub(super) struct Met {
    world: World,
    moved: Moved,
    city: u64,
    /// What each section of the city still draws.
    left: Arc<Vec<Vec<Chunk>>>,
    /// Sections that are met, and which of the chunks are theirs.
    sections: Vec<MetSection>,
    /// Whose triangles are met; without bounds of what they become.
    chunks: Vec<Chunk>,
    rest: Rest,
}

/// What deformations make of a city in a view.
#[derive(Debug)]
pub(super) struct Deformed {
    of: Of,
    /// Whether the city has normals per vertex at rest.
    is_smooth: bool,
    /// What each section of the city still draws, where it stands.
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
    /// How far edges might be off, pixels.
    pub asked_px: f64,
    /// How exact it is.
    pub report: Report,
}

impl DeformedFigures {
    /// Those of all deformed cities of a picture: sums, and the worst of what was kept. `None` without any.
    pub(super) fn of_all(all: &[Deformed]) -> Option<Self> {
        let worst = |a: Report, b: Report| Report {
            tolerance_px: a.tolerance_px.max(b.tolerance_px),
            shortest_m: a.shortest_m.max(b.shortest_m),
            too_coarse: a.too_coarse + b.too_coarse,
            unusable: a.unusable + b.unusable,
        };
        all.iter().map(|deformed| deformed.figures).reduce(|a, b| Self {
            met: a.met + b.met,
            triangles: a.triangles + b.triangles,
            asked_px: a.asked_px,
            report: worst(a.report, b.report),
        })
    }
}

/// What deforms cities, and what deformations meet of each, whatever the view.
#[derive(Debug, Default)]
pub(super) struct Deforming {
    met: Vec<Met>,
    refinery: Option<Refinery>,
    /// Cities that were there so far.
    cities: u64,
}

impl Deforming {
    /// Another city is there now.
    pub fn begin_city(&mut self) {
        self.met.clear();
        self.cities += 1;
    }

    /// Makes the deformed cities fit a frame: the scene's own first, then those contents of which a lens may show something. Nothing is
    /// made where they do. Whether some are others now.
    pub fn fit(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        own: &mut CityOnGpu,
        contents: &mut Contents,
        deformed: &mut Vec<Deformed>,
        input: &FrameInput,
    ) -> Result<bool, GpuError> {
        if input.moved.is_nothing() {
            // What is met stays for the next view in which something is moved.
            let had_some = !deformed.is_empty();
            deformed.clear();
            return Ok(had_some);
        }
        let worlds = worlds_of(contents, input);
        self.met.retain(|met| met.world == World::OWN || worlds.contains(&met.world));
        let mut before = std::mem::take(deformed);
        let count = before.len();
        let mut is_other = false;
        for world in worlds {
            let city = match world.city {
                0 => &mut *own,
                id => match contents.city_mut(id) {
                    Some(city) => city,
                    None => continue,
                },
            };
            let of = Of {
                world,
                moved: input.moved.clone(),
                view: input.view,
                chord_px: input.chord_px,
                city: self.cities,
                edges: city.edges.is_some(),
            };
            if let Some(at) = before.iter().position(|deformed| deformed.of == of) {
                deformed.push(before.swap_remove(at));
                continue;
            }
            if let Some(made) = self.deformed(gpu, pipelines, city, of)? {
                deformed.push(made);
                is_other = true;
            }
        }
        Ok(is_other || deformed.len() != count)
    }

    /// What becomes of a city; `None` of a content that deformations do not reach.
    fn deformed(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        city: &mut CityOnGpu,
        of: Of,
    ) -> Result<Option<Deformed>, GpuError> {
        if city.sources.is_none() {
            let sources = city.buffers.sections.iter().map(|section| Source::read(gpu, section));
            city.sources = Some(sources.collect::<Result<_, _>>()?);
        }
        if let (None, Some(edges)) = (&city.edge_sources, &city.edges) {
            city.edge_sources = Some(bytemuck::pod_collect_to_vec(&gpu.read_buffer(&edges.instances)?));
        }
        let known = self.met.iter().position(|met| met.world == of.world);
        let met =
            match known.map(|at| self.met.swap_remove(at)).filter(|met| met.moved == of.moved && met.city == of.city) {
                Some(met) => met,
                None => Met::new(gpu, city, &of)?,
            };
        let mut made = None;
        if of.world == World::OWN || met.rest.triangles > 0 {
            let mut refinery = match self.refinery.take() {
                Some(refinery) => refinery,
                None => Refinery::new(gpu)?,
            };
            let stage = stage_of(&of.view, &met.rest.lattice, of.chord_px, city.buffers.smooth);
            let refined = refinery.refined(gpu, &met.rest, &stage)?;
            self.refinery = Some(refinery);
            made = Some(Deformed::new(gpu, pipelines, city, &met, refined, of)?);
        }
        self.met.push(met);
        Ok(made)
    }

    /// How far the bent edges of a deformed city are from where they should be, by brute force in f64, pixels: the median of those that are
    /// off at all, and the farthest. `None`: nothing is refined.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn chords(&mut self, gpu: &Gpu, deformed: &Deformed) -> Result<Option<[f64; 2]>, GpuError> {
        let Of { world, moved, view, .. } = &deformed.of;
        let met = self.met.iter().find(|met| met.world == *world);
        let (Some(refinery), Some(met)) = (&mut self.refinery, met) else { return Ok(None) };
        // What it worked on last may have been another city.
        let stage = stage_of(view, &met.rest.lattice, deformed.of.chord_px, deformed.is_smooth);
        let made = refinery.refined(gpu, &met.rest, &stage)?;
        let edges = refinery.edges(gpu, &met.rest, made.triangles)?;
        let off = |[a, b]: &[DVec3; 2]| {
            let [start, end] = [*a, *b].map(|place| moved.deformers.value(place));
            let at = |i: u32| {
                let t = f64::from(i) / f64::from(CHORD_SAMPLES);
                let shown = moved.deformers.value(a.lerp(*b, t));
                shown.distance(start.lerp(end, t)) * pixels_per_m(view, shown)
            };
            (1..CHORD_SAMPLES).map(at).fold(0.0, f64::max)
        };
        let mut all: Vec<f64> = edges.par_iter().map(off).filter(|px| *px > LEAST_CHORD_PX).collect();
        all.sort_by(f64::total_cmp);
        Ok(all.last().map(|worst| [all[all.len() / 2], *worst]))
    }
}

/// The cities that deformations may move in a frame, each once.
fn worlds_of(contents: &Contents, input: &FrameInput) -> Vec<World> {
    let has_shadows = casts_shadows(&input.sun) || occludes_sky(&input.sun, input.samples);
    let bends = !input.rays.is_empty();
    let may_show = |lens: u32| {
        let is_seen =
            |v: &LensVolume| bends || v.seen_part(&input.view, input.tile).is_some() || has_shadows && !v.keeps_shadows;
        input.volumes.iter().any(|v| v.lens == lens && is_seen(v))
    };
    // What moves by timetables is shown everywhere.
    let shown =
        |number: u32| number == 0 || input.operations.contents.iter().any(|c| c.city == number && may_show(c.lens));
    let mut worlds = vec![World::OWN];
    for (number, world) in contents.worlds() {
        if !worlds.contains(world) && shown(number) {
            worlds.push(*world);
        }
    }
    worlds
}

impl Deformed {
    /// The city that it was made of, where that stands.
    pub fn world(&self) -> &World {
        &self.of.world
    }

    fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        city: &CityOnGpu,
        met: &Met,
        made: Made,
        of: Of,
    ) -> Result<Self, GpuError> {
        let figures = DeformedFigures {
            met: u64::from(met.rest.triangles),
            triangles: u64::from(made.triangles),
            asked_px: of.chord_px,
            // As it was asked for, but for rounding.
            report: match made.report.tolerance_px > of.chord_px * (1.0 + 1e-6) {
                true => made.report,
                false => Report { tolerance_px: of.chord_px, ..made.report },
            },
        };
        let bounds = made.chunks.iter().fold(Aabb::EMPTY, |all, (_, bounds)| all.union(*bounds));
        let images = met.sections.iter().map(|met| image_of(gpu, pipelines, &city.buffers, met.kind)).collect();
        let buffers = CityBuffers::of_sections(sections_of(met, &made), city.buffers.surfaces.clone(), bounds);
        let view = of.view;
        let pixels_per_m = move |place: DVec3| pixels_per_m(&view, place);
        let refiner = Refiner {
            deformers: &of.moved.deformers,
            pixels_per_m: &pixels_per_m,
            tolerance_px: of.chord_px,
            shortest_m: Limits::default().shortest_m,
        };
        let of_city = city.edges.as_ref().zip(city.edge_sources.as_ref());
        let edges = of_city
            .map(|(edges, all)| {
                let rest = RestEdges { all, raised: &raised_of(&city.buffers, &of), placement: &of.world.placement };
                deformed_edges(gpu, edges, &rest, &refiner)
            })
            .transpose()?;
        let is_smooth = city.buffers.smooth;
        let city = CityOnGpu::beside(city, images, buffers);
        Ok(Self { of, is_smooth, left: met.left.clone(), city, edges, figures })
    }
}

/// The chunks of a section that are met.
#[derive(Debug)]
struct MetSection {
    kind: SectionKind,
    has_shadow: bool,
    /// Among those of all sections.
    chunks: Range<usize>,
}

/// The sections that are moved, each of the chunks of one that is met.
fn sections_of(met: &Met, made: &Made) -> Vec<Section> {
    let section = |MetSection { kind, has_shadow, chunks }: &MetSection| Section {
        // What is bent is in no plane.
        kind: kind.out_of_plane(),
        vertices: made.vertices.clone(),
        indices: made.indices.clone(),
        extra: made.texcoords.clone().filter(|_| kind.images().is_some()),
        chunks: met.chunks[chunks.clone()]
            .iter()
            .zip(&made.chunks[chunks.clone()])
            .map(|(chunk, (range, bounds))| Chunk {
                range: 3 * range.start..3 * range.end,
                bounds: *bounds,
                has_run_ends: false,
                ..chunk.clone()
            })
            .collect(),
        layer: 0,
        has_shadow: *has_shadow,
    };
    met.sections.iter().map(section).collect()
}

/// The view as what is refined is seen in it.
fn stage_of(view: &View, lattice: &Lattice, chord_px: f64, is_smooth: bool) -> layout::Refinement {
    let (eye, offset) = lattice.cell_of(view.camera.eye);
    layout::Refinement {
        eye: eye.to_array(),
        eye_offset: offset.to_array(),
        forward: view.basis.forward.as_vec3().to_array(),
        pixels: (0.5 * f64::from(view.size[1]) / view.half_extent().y) as f32,
        near: view.camera.near_m as f32,
        orthographic: u32::from(view.is_orthographic()),
        tolerance: chord_px as f32,
        shortest: Limits::default().shortest_m as f32,
        lift: (LIFT * chord_px) as f32,
        narrowest: (NARROWEST * f64::from(view.size[0].max(view.size[1]))) as f32,
        is_smooth: u32::from(is_smooth),
        ..layout::Refinement::zeroed()
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
        let bounds = of.world.placement.boxed(&city.buffers.bounds);
        let supports: Vec<Support> = of
            .moved
            .deformers
            .supports()
            .map(|support| {
                let farthest = bounds.grown(support.frame.pivot).size().length();
                support.grown((SUPPORT_ERROR * farthest).max(LEAST_SUPPORT_ERROR_M))
            })
            .collect();
        let raised = raised_of(&city.buffers, of);
        let heights = of.world.is_own.then_some(of.moved.heights_in(of.world.moves));
        let reach = Reach { supports: &supports, heights, raised: &raised, placement: &of.world.placement };
        // What is placed is met as a whole or not at all.
        let mut all_chunks = city.buffers.sections.iter().flat_map(|section| &section.chunks);
        let is_met = reach.placement.is_none()
            || all_chunks.any(|chunk| reach.may_raise(&chunk.bounds) || !reach.near(&chunk.bounds).is_empty());
        // What goes on without end has no form that a deformation of all could give it.
        let moves_all = supports.iter().any(|support| bounds.corners().iter().all(|corner| support.contains(*corner)));
        let has_textures = sections().any(|(section, _)| section.kind.images().is_some());
        let (mut left, mut met, mut chunks) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = MetPart::default();
        let mut firsts = vec![0];
        for (section, source) in sections().filter(|_| is_met) {
            let kind = MetKind { layer: section.layer, has_textures };
            // In parts that keep their order.
            let stays: Vec<Chunk>;
            let chunks_here = match moves_all && section.chunks.iter().any(|chunk| chunk.gives_way) {
                true => {
                    stays = section.chunks.iter().filter(|chunk| !chunk.gives_way).cloned().collect();
                    &stays
                }
                false => &section.chunks,
            };
            let parts: Vec<MetPart> = chunks_here
                .par_chunks(CHUNKS_PER_PART)
                .map(|chunks| MetPart::of(chunks, source, &reach, kind))
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
                met.push(MetSection {
                    kind: section.kind,
                    has_shadow: section.has_shadow,
                    chunks: first..chunks.len(),
                });
            }
        }
        let reach = bounds.union(of.moved.bounds(&bounds));
        let is_textured = met.iter().any(|met| met.kind.images().is_some());
        let texcoords = is_textured.then_some(&all.texcoords[..]);
        let triangles = RestTriangles { corners: &all.corners, bits: &all.bits, texcoords, firsts };
        let rest = Rest::new(gpu, triangles, &of.moved.deformers, &reach)?;
        Ok(Self {
            world: of.world,
            moved: of.moved.clone(),
            city: of.city,
            left: Arc::new(left),
            sections: met,
            chunks,
            rest,
        })
    }
}

/// What is met: what a support reaches, and objects of another height.
struct Reach<'a> {
    supports: &'a [Support],
    /// Of a city whose objects have some.
    heights: Option<&'a Heights>,
    raised: &'a [Option<Height>],
    placement: &'a Placement,
}

impl Reach<'_> {
    /// Whether some object of another height may have something of a box at rest.
    fn may_raise(&self, bounds: &Aabb) -> bool {
        self.heights.is_some_and(|heights| heights.reaches(bounds))
    }

    /// The supports that may have something of a chunk.
    fn near(&self, bounds: &Aabb) -> Vec<&Support> {
        let raised = self.heights.filter(|heights| heights.reaches(bounds));
        let all = self.placement.boxed(&raised.map_or(*bounds, |heights| heights.changed_bounds(bounds)));
        self.supports.iter().filter(|support| support.reaches(&all)).collect()
    }
}

/// Of each surface of the table what its object's height becomes; none where no height does.
fn raised_of(city: &CityBuffers, of: &Of) -> Vec<Option<Height>> {
    let heights = of.moved.heights_in(of.world.moves);
    if heights.is_empty() || !of.world.is_own {
        return Vec::new();
    }
    city.surface_table.iter().map(|surface| heights.of(surface.object).copied()).collect()
}

/// What the triangles of a section have beside their corners.
#[derive(Clone, Copy)]
struct MetKind {
    /// The layer of coplanar faces.
    layer: u32,
    /// Whether some of what is met has texture coordinates.
    has_textures: bool,
}

impl MetPart {
    fn of(chunks: &[Chunk], source: &Source, reach: &Reach, kind: MetKind) -> Self {
        let mut part = Self::default();
        // What is placed by the GPU is rounded in another way than what is placed here: no triangle of one has a neighbour of the other.
        let is_placed = !reach.placement.is_none();
        for chunk in chunks {
            let near = reach.near(&chunk.bounds);
            if near.is_empty() && !reach.may_raise(&chunk.bounds) && !is_placed {
                part.left.push(chunk.clone());
                continue;
            }
            let before = part.bits.len();
            let mut run = None;
            for start in chunk.range.clone().step_by(3) {
                let at = start as usize;
                let corners = [source.indices[at], source.indices[at + 1], source.indices[at + 2]];
                let surface = source.vertices[corners[source.provoking] as usize].surface as usize;
                let raised = reach.raised.get(surface).copied().flatten();
                let standing = Standing { raised, placement: reach.placement };
                let places = corners.map(|i| standing.place(source.place(i)));
                if standing.is_moved() || near.iter().any(|support| support.meets_triangle(&places)) {
                    close(&mut run, chunk, source, &mut part.left);
                    part.add(source, corners, &places, standing, kind);
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

    fn add(
        &mut self,
        source: &Source,
        corners: [u32; 3],
        places: &[DVec3; 3],
        standing: Standing,
        MetKind { layer, has_textures }: MetKind,
    ) {
        let mut sorted = [0, 1, 2];
        sorted.sort_by(|&i, &j| order(places[i], places[j]));
        let is_turned = matches!(sorted, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
        let provoking = sorted.iter().position(|&i| i == source.provoking).unwrap_or(0) as u32;
        self.bits.push(provoking | if is_turned { TURNED } else { 0 } | layer << LAYER_SHIFT);
        for (i, place) in sorted.map(|i| (corners[i] as usize, places[i])) {
            let own = source.vertices[i];
            self.corners.push(match standing.is_moved() {
                false => own,
                true => {
                    let origin = origin_of(place);
                    let offset = (place - origin).as_vec3().to_array();
                    CityVertex::new(origin.as_ivec3(), own.surface, offset, standing.packed_normal(own.normal))
                }
            });
            if has_textures {
                self.texcoords.push(source.texcoords.get(i).copied().unwrap_or_default());
            }
        }
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
