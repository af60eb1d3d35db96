//! The techniques that draw the city once for each region (C2), kept for comparison with accumulation: one pass per combination of
//! lenses, or Ropinski and Hinrichs' three.
//!
//! ```text
//! geometry               chunks that no lens reaches, as ever
//! geometry of a region   for each region that may occur: chunks that may reach into it; fragments in other regions are
//!                        discarded before visibility. Depth is kept from pass to pass, so that the nearest fragment of any
//!                        region wins, and every pass writes its number beside the code of the surface
//! regions                these numbers as depths, with those of the background
//! classes                the lens masks, where somebody asks for them
//! shade                  outside of where lenses may be seen
//! shade regions          each region by a shader of its own that tests no lens; the depth test chooses the pixels
//! ```
//!
//! What the geometry passes leave is what accumulation's one pass leaves.

use std::ops::Range;

use crate::{
    geom::Aabb,
    gpu::{Gpu, GpuError},
    lens::Class,
    render::{
        city::{Chunk, CityBuffers, SectionKind, draws_of},
        city_passes::{draw_ranges, geometry_key},
        contents::DrawnSection,
        eye::PictureTile,
        frame::{FrameInput, Recorder, color_attachment, depth_attachment, read_depth},
        hiding::{Reach, reaches_of},
        key::{Key, ShadeTarget, Shown},
        occurring::{combinations, may_meet},
        pipelines::{DEPTH, REGIONS},
        renderer::{Renderer, STAGE_STRIDE, group, whole},
        seen::SeenVolume,
        synced::Synced,
        volume::LensVolume,
    },
    scene::{Scene, SceneProblem, Technique, technique::MOST_WRITTEN_OUT},
    shader::{ClassTest, Plan, Program, Regions},
};

/// `STEP` and `BACKGROUND` of `pass/regions.wgsl`.
const STEPS: f32 = 4096.0;
const BACKGROUND: u32 = 2048;

/// One region that may occur.
#[derive(Clone, Debug)]
pub(super) struct RegionPass {
    /// Its number.
    pub number: u32,
    /// Lenses that it has to do with.
    pub lenses: Vec<u32>,
    /// Where fragments of it may be: in one of each of these.
    reaches: Vec<Vec<Reach>>,
    /// The part of the picture that it may be seen in.
    part: PictureTile,
    /// What shading does there.
    pub shade: Plan,
    /// Whether what is behind the city may be in it.
    pub has_background: bool,
}

/// The regions of a frame.
#[derive(Clone, Debug)]
pub(super) struct RegionPasses {
    /// How they are told apart.
    pub plan: Plan,
    /// Region 0 first.
    pub passes: Vec<RegionPass>,
    /// Where fragments may be in another region than 0.
    reaches: Vec<Reach>,
}

/// What the card has of them between frames.
#[derive(Debug)]
pub(super) struct RegionsOnGpu {
    numbers: Synced,
    /// The number of each pixel's region, and the same as depth.
    map: wgpu::Texture,
    depth: wgpu::Texture,
}

/// Pipelines of a frame's regions.
#[derive(Clone, Debug, Default)]
pub(super) struct RegionKeys {
    pub marks: Option<Key>,
    /// Surfaces and background of each.
    pub shade: Vec<Vec<Key>>,
    /// What writes the lens masks.
    pub classes: Vec<Key>,
}

impl RegionKeys {
    pub fn all(&self) -> impl Iterator<Item = &Key> {
        self.marks.iter().chain(self.shade.iter().flatten()).chain(&self.classes)
    }
}

/// What of a scene's volumes its technique cannot do.
pub(super) fn refused(scene: &Scene, volumes: &[LensVolume]) -> Option<SceneProblem> {
    let technique = scene.style.technique;
    if technique == Technique::Accumulate {
        return None;
    }
    let name = |volume: &LensVolume| &scene.lenses[volume.lens as usize].name;
    let why = || {
        if volumes.len() > MOST_WRITTEN_OUT {
            let count = volumes.len();
            return Some(format!("takes at most {MOST_WRITTEN_OUT} volumes of lenses; the scene has {count}"));
        }
        if technique != Technique::ThreePass {
            return None;
        }
        if let Some(volume) = volumes.iter().find(|v| !v.body.is_form()) {
            let name = name(volume);
            return Some(format!(
                "needs volumes with one front and one back, and that of lens \"{name}\" has no such form"
            ));
        }
        let pairs = volumes.iter().enumerate().flat_map(|(i, a)| volumes[..i].iter().map(move |b| (b, a)));
        let (a, b) = pairs.filter(|(a, b)| a.lens != b.lens).find(|(a, b)| may_meet(a, b))?;
        Some(format!("takes lenses that do not meet, and lenses \"{}\" and \"{}\" may", name(a), name(b)))
    };
    why().map(|why| technique.refusal(&why))
}

/// Has volumes tested as a technique tests them.
pub(super) fn set_tests(technique: Technique, volumes: &mut [LensVolume]) {
    if technique == Technique::ThreePass {
        // The two depth maps.
        volumes.iter_mut().for_each(|volume| volume.sprite = Some(volume.sprite.unwrap_or_default()));
    }
}

impl RegionPasses {
    /// The regions that may occur in a picture of lenses; `plan`: of shading, and `lenses` the numbers of its lenses.
    pub fn new(input: &FrameInput, seen: &[SeenVolume], plan: &Plan, lenses: &[u32]) -> Self {
        let regions = match input.technique {
            Technique::ThreePass => Regions::passes(plan),
            _ => Regions::combinations(plan),
        };
        let (plan, whole_plan) = {
            let mut told = plan.clone();
            told.steps.clear();
            (told.haze, told.masks) = (false, false);
            told.lenses.iter_mut().zip(0..).for_each(|(lens, number)| lens.number = number);
            told.regions = Some(regions.clone());
            (told, Plan { regions: Some(regions.clone()), ..plan.clone() })
        };
        let whole = PictureTile::whole(input.tile.size);
        let pass = |number: u32| {
            let mut pass = RegionPass {
                number,
                lenses: Vec::new(),
                reaches: Vec::new(),
                part: whole,
                shade: whole_plan.of_region(number),
                has_background: true,
            };
            for (lens, class) in regions.classes_of(number) {
                let lens = lenses[lens as usize];
                pass.lenses.push(lens);
                pass.reaches.push(reaches_of(Some(lens), Class::from(class), input.volumes, &input.view));
                let own = || seen.iter().filter(|v| v.lens == lens);
                if class != ClassTest::Rest {
                    let around = own().map(|v| v.bounds).reduce(around);
                    pass.part = common(pass.part, around.unwrap_or(PictureTile { origin: [0; 2], size: [0; 2] }));
                }
                let is_endless = || own().any(|v| !input.volumes[v.index].body.is_bounded());
                pass.has_background &= match class {
                    ClassTest::Inside => is_endless(),
                    ClassTest::Front => false,
                    ClassTest::Behind | ClassTest::Rest => true,
                };
            }
            pass
        };
        let occurring = match &regions {
            Regions::Combinations(classes) => occurring(input, classes, lenses),
            Regions::Passes(_) => (0..regions.count().unwrap_or(0)).collect(),
        };
        let passes: Vec<RegionPass> =
            occurring.into_iter().map(pass).filter(|p| p.number == 0 || !p.part.is_empty()).collect();
        let others = passes.iter().filter(|p| p.number > 0);
        // What every other region asks for first is enough to know that it may be there.
        let mut reaches: Vec<Reach> = Vec::new();
        for reach in others.flat_map(|p| p.reaches.first().into_iter().flatten()) {
            if !reaches.contains(reach) {
                reaches.push(reach.clone());
            }
        }
        Self { plan, passes, reaches }
    }

    fn is_reached(&self, bounds: &Aabb, input: &FrameInput) -> bool {
        self.reaches.iter().any(|reach| reach.touches(bounds, &input.view))
    }
}

/// The numbers of the combinations that may occur, ascending: of lenses that a place is inside of, the volumes have to meet.
fn occurring(input: &FrameInput, classes: &[Vec<ClassTest>], lenses: &[u32]) -> Vec<u32> {
    let acting: Vec<usize> = (0..lenses.len()).filter(|&i| classes[i].contains(&ClassTest::Inside)).collect();
    let numbers: Vec<u32> = acting.iter().map(|&i| lenses[i]).collect();
    let mut found = Vec::new();
    for mask in combinations(input.volumes, &numbers) {
        let mut own = vec![0];
        let mut place = 1;
        for (lens, asked) in classes.iter().enumerate() {
            let is_inside = acting.iter().position(|&i| i == lens).is_some_and(|bit| mask >> bit & 1 == 1);
            let states = (1..).zip(asked).filter(|(_, class)| (**class == ClassTest::Inside) == is_inside);
            let states: Vec<u32> = states.map(|(state, _)| state).chain((!is_inside).then_some(0)).collect();
            own = own.iter().flat_map(|number| states.iter().map(move |state| number + state * place)).collect();
            place *= asked.len() as u32 + 1;
        }
        found.append(&mut own);
    }
    found.sort_unstable();
    found
}

fn around(a: PictureTile, b: PictureTile) -> PictureTile {
    let origin: [u32; 2] = std::array::from_fn(|i| a.origin[i].min(b.origin[i]));
    let end = |i: usize| (a.origin[i] + a.size[i]).max(b.origin[i] + b.size[i]);
    PictureTile { origin, size: std::array::from_fn(|i| end(i) - origin[i]) }
}

fn common(a: PictureTile, b: PictureTile) -> PictureTile {
    let origin: [u32; 2] = std::array::from_fn(|i| a.origin[i].max(b.origin[i]));
    let end = |i: usize| (a.origin[i] + a.size[i]).min(b.origin[i] + b.size[i]);
    PictureTile { origin, size: std::array::from_fn(|i| end(i).saturating_sub(origin[i])) }
}

impl RegionsOnGpu {
    fn new(gpu: &Gpu, [w, h]: [u32; 2]) -> Result<Self, GpuError> {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(Self {
            numbers: Synced::new(gpu, "numbers of regions", wgpu::BufferUsages::UNIFORM)?,
            map: gpu.texture("regions", [w, h, 1], 1, REGIONS, usage),
            depth: gpu.texture("regions as depths", [w, h, 1], 1, DEPTH, usage),
        })
    }
}

/// Parts of the mesh, each with the rectangle that cuts it.
type Pieces = [(Range<u32>, PictureTile)];
/// The part of shading that is the lenses', as [`Renderer::draw_pieces`] numbers it.
const LENSES: u32 = 1;

impl Renderer {
    /// Makes room for the regions of a frame.
    pub(super) fn fit_regions(&mut self, size: [u32; 2], regions: &RegionPasses) -> Result<(), GpuError> {
        if self.regions.as_ref().is_none_or(|r| [r.map.width(), r.map.height()] != size) {
            self.regions = None;
            self.regions = Some(RegionsOnGpu::new(&self.gpu, size)?);
        }
        let count = regions.plan.regions.as_ref().and_then(Regions::count).unwrap_or(0);
        let mut numbers = vec![0_u32; count as usize * STAGE_STRIDE as usize / 4];
        (0..).zip(numbers.chunks_mut(STAGE_STRIDE as usize / 4)).for_each(|(number, stage)| stage[0] = number);
        if let Some(on_gpu) = &mut self.regions {
            on_gpu.numbers.sync(&self.gpu, &numbers)?;
        }
        Ok(())
    }

    /// The city: what no lens reaches, and then region by region.
    pub(super) fn region_geometry(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        regions: &RegionPasses,
    ) {
        let frustum = input.view.frustum(1.0);
        let sections = self.drawn_sections(None);
        let mut apart: Vec<(DrawnSection, Vec<&Chunk>)> = Vec::new();
        let mut reached: Vec<(DrawnSection, Vec<&Chunk>)> = Vec::new();
        for drawn in &sections {
            let shown = drawn.chunks.iter().filter(|c| drawn.shows(c, None, &input.view));
            let seen = CityBuffers::visible(shown, &frustum, input.view.camera.eye);
            // Layers of coplanar faces stay together: the later one wins where depths are equal.
            let is_layer = drawn.section.kind == SectionKind::Coplanar;
            let (own, others) =
                seen.iter().map(|s| s.chunk).partition(|chunk| is_layer || regions.is_reached(&chunk.bounds, input));
            reached.push((*drawn, own));
            apart.push((*drawn, others));
        }
        self.geometry_pass(encoder, recorder, input, (&apart, None), ("geometry", true));
        let mut is_first = true;
        for pass in &regions.passes {
            let is_in = |chunk: &&&Chunk| {
                pass.reaches.iter().all(|any| any.iter().any(|reach| reach.touches(&chunk.bounds, &input.view)))
            };
            let parts: Vec<(DrawnSection, Vec<&Chunk>)> = reached
                .iter()
                .map(|(drawn, chunks)| (*drawn, chunks.iter().filter(is_in).copied().collect()))
                .filter(|(_, chunks): &(DrawnSection, Vec<&Chunk>)| !chunks.is_empty())
                .collect();
            if is_first || !parts.is_empty() {
                self.region_pass(encoder, recorder, input, (regions, pass), (&parts, is_first));
                is_first = false;
            }
        }
    }

    fn region_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (regions, region): (&RegionPasses, &RegionPass),
        (parts, is_first): (&[(DrawnSection, Vec<&Chunk>)], bool),
    ) {
        let (Some(targets), Some(groups), Some(own)) = (&self.targets, &self.groups, &self.regions) else { return };
        let (colored, smooth) = (self.colored(), self.smooth());
        let map = own.map.create_view(&Default::default());
        let slot = recorder.begin("geometry of a region", "main", &region.lenses, true);
        let writes = recorder.timer.as_ref().and_then(|t| t.render_writes(slot));
        let kept = |view| {
            let mut attachment = color_attachment(view, wgpu::Color::TRANSPARENT);
            attachment.ops.load = wgpu::LoadOp::Load;
            attachment
        };
        let mut depth = depth_attachment(&targets.depth.view, 0.0);
        depth.depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("geometry of a region"),
            color_attachments: &[
                Some(kept(&targets.codes.view)),
                colored.then(|| kept(&targets.colors.view)),
                input.measured.then(|| kept(&targets.own_depth.view)),
                Some(if is_first { color_attachment(&map, wgpu::Color::TRANSPARENT) } else { kept(&map) }),
            ],
            depth_stencil_attachment: Some(depth),
            timestamp_writes: writes,
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        let number = wgpu::BufferBinding {
            buffer: own.numbers.buffer(),
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<[u32; 4]>() as u64),
        };
        let entries = [(0, whole(self.buffers.view.buffer())), (1, wgpu::BindingResource::Buffer(number))];
        let view = group(&self.gpu, "region", &self.pipelines.layouts.region, &entries);
        pass.set_bind_group(0, &view, &[region.number * STAGE_STRIDE as u32]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        let program = Program::Specialised(regions.plan.clone());
        let mut counted = (0, 0);
        for (DrawnSection { city, section, image, offset, .. }, chunks) in parts {
            pass.set_vertex_buffer(0, section.vertices.slice(..));
            if let Some(extra) = &section.extra {
                pass.set_vertex_buffer(1, extra.slice(..));
            }
            if let Some(image) = *image {
                pass.set_bind_group(3, image, &[]);
            }
            pass.set_bind_group(1, &groups.cut_city, &[*offset; 2]);
            let normals = [smooth, city.buffers.smooth];
            pass.set_pipeline(self.pipelines.get(&geometry_key(
                section.kind,
                colored,
                normals,
                input.measured,
                Some(program.clone()),
            )));
            let (draws, triangles) = draws_of(chunks.iter().copied());
            draw_ranges(&mut pass, &section.indices, &draws);
            counted = (counted.0 + draws.len() as u32, counted.1 + triangles);
        }
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(counted.0, counted.1);
    }

    /// The lens masks, where the frame keeps them: accumulation's shading with nothing to do. What it paints is painted over.
    pub(super) fn classes_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        pieces: &Pieces,
        keys: &RegionKeys,
    ) {
        let Some(targets) = &self.targets else { return };
        if keys.classes.is_empty() {
            return;
        }
        let attachment = color_attachment(&targets.picture.view, wgpu::Color::TRANSPARENT);
        let depth = read_depth(&targets.depth.view);
        self.picture_pass(encoder, recorder, ("classes", Some(attachment), depth), |pass| {
            let mut counted = (0, 0);
            keys.classes.iter().for_each(|key| self.draw_pieces(pass, key, LENSES, pieces, &mut counted));
            counted
        });
    }

    /// Where the surfaces and the background of each region are, and each region there.
    pub(super) fn shade_regions(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        pieces: &Pieces,
        (regions, keys): (&RegionPasses, &RegionKeys),
    ) {
        let (Some(targets), Some(own)) = (&self.targets, &self.regions) else { return };
        let Some(marks) = &keys.marks else { return };
        let depth = own.depth.create_view(&Default::default());
        let map = wgpu::BindingResource::TextureView(&own.map.create_view(&Default::default()));
        let numbers = group(&self.gpu, "regions", &self.pipelines.layouts.regions, &[(0, map)]);
        let written = depth_attachment(&depth, 0.0);
        self.picture_pass(encoder, recorder, ("regions", None, written), |pass| {
            pass.set_bind_group(3, &numbers, &[]);
            let mut counted = (0, 0);
            self.draw_pieces(pass, marks, LENSES, pieces, &mut counted);
            counted
        });
        let target = if input.samples > 1 { &targets.sums } else { &targets.picture };
        let mut attachment = color_attachment(&target.view, wgpu::Color::TRANSPARENT);
        attachment.ops.load = wgpu::LoadOp::Load;
        let [w, h] = input.tile.size.map(|side| side as f32);
        self.picture_pass(encoder, recorder, ("shade regions", Some(attachment), read_depth(&depth)), |pass| {
            let mut counted = (0, 0);
            for (region, keys) in regions.passes.iter().zip(&keys.shade) {
                let own = pieces.iter().map(|(corners, tile)| (corners.clone(), common(*tile, region.part)));
                let own: Vec<(Range<u32>, PictureTile)> = own.collect();
                for (key, first) in keys.iter().zip([0, BACKGROUND]) {
                    // The triangles lie at depth 0; the depth test finds what lies at the region's.
                    let depth = (first + region.number + 1) as f32 / STEPS;
                    pass.set_viewport(0.0, 0.0, w, h, depth, depth);
                    self.draw_pieces(pass, key, LENSES, &own, &mut counted);
                }
            }
            counted
        });
    }
}

/// The pipelines of regions; `shade_to` makes those of shading.
pub(super) fn keys(
    input: &FrameInput,
    regions: &RegionPasses,
    masks: Option<Plan>,
    shade_to: impl Fn(ShadeTarget, Shown, Program) -> Key,
) -> RegionKeys {
    let target = if input.samples > 1 { ShadeTarget::Sums } else { ShadeTarget::Picture };
    let of_pass = |pass: &RegionPass| {
        let shown = [Some(Shown::RegionSurface), pass.has_background.then_some(Shown::RegionBackground)];
        let key = |shown| shade_to(target, shown, Program::Specialised(pass.shade.clone()));
        shown.into_iter().flatten().map(key).collect()
    };
    let classes = masks.map(|plan| {
        [Shown::Surface, Shown::Background]
            .map(|shown| shade_to(ShadeTarget::Picture, shown, Program::Specialised(plan.clone())))
    });
    RegionKeys {
        marks: Some(Key::Regions(regions.plan.clone())),
        shade: regions.passes.iter().map(of_pass).collect(),
        classes: classes.into_iter().flatten().collect(),
    }
}
