//! Bent pictures: images of what the eye sees, and what pixels in lenses find in them (`pass/ray-warp.wgsl`).

use glam::DVec2;
use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    lens::ray::RayMethod,
    render::{
        bent,
        eye::{PictureTile, view_uniform},
        frame::FrameInput,
        layout,
        lens_numbers::LensNumbers,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            opaque::{CutBy, OpaqueEye, SectionPart, draw_opaque, in_order, visible},
        },
        plan::FramePlan,
        programs::Programs,
        ray_sources::{MOST_SOURCES, RaySource, sources},
        resource::{
            bindings::{
                DRAWN, GroupLayout, LAYERED_DEPTHS, LAYERED_FLOATS, LAYERED_NUMBERS, NUMBERS, UNIFORM, group, whole,
            },
            formats::{COLORS, DEPTH, EMISSIONS, OWN_DEPTH, codes},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, words},
            layouts::{CUT_CITY, LENSES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, kept_depth, scissor},
            synced::Synced,
        },
        shared::{Shared, of_volumes},
    },
    scene::Technique,
    shader::{Bends, Module},
    view::jitter_px,
};

/// Group 1: surfaces, and the images.
static SOURCES: GroupLayout = GroupLayout {
    label: "images of what the eye sees",
    entries: &[
        (0, S::FRAGMENT, NUMBERS),
        (1, DRAWN, UNIFORM),
        (2, S::FRAGMENT, LAYERED_NUMBERS),
        (3, S::FRAGMENT, LAYERED_DEPTHS),
        (4, S::FRAGMENT, LAYERED_FLOATS),
        (5, S::FRAGMENT, LAYERED_FLOATS),
    ],
};

/// Rays that are looked up.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct WarpKey {
    bends: Bends,
    colored: bool,
    smooth: bool,
    measured: bool,
    texels_emit: bool,
}

impl WarpKey {
    fn new(plan: &FramePlan) -> Self {
        Self {
            bends: plan.input.operations.bends,
            colored: plan.colored,
            smooth: plan.smooth,
            measured: plan.input.measured,
            texels_emit: plan.texels_emit,
        }
    }
}

impl PipelineKey for WarpKey {
    fn name(&self) -> String {
        let flags = words(&[
            (self.colored, "colored"),
            (self.smooth, "smooth"),
            (self.measured, "measured"),
            (self.texels_emit, "of light"),
        ]);
        format!("{}{flags}", Module::RayWarp(self.bends).name())
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::RayWarp(self.bends),
            groups: vec![Some(&VIEW), Some(&SOURCES), Some(&LENSES)],
            constants: vec![("SMOOTH", flag(self.smooth)), ("TEXELS_EMIT", flag(self.texels_emit))],
            stage: Stage::Draw(Draw {
                targets: in_order([
                    Some(codes(self.smooth).into()),
                    self.colored.then(|| COLORS.into()),
                    self.measured.then(|| OWN_DEPTH.into()),
                    None,
                    self.texels_emit.then(|| EMISSIONS.into()),
                ]),
                depth: Some(depth_test(wgpu::CompareFunction::Always, true)),
                ..Draw::new("vertex", Some("warp"))
            }),
        }
    }
}

/// What is looked into, and where in the picture.
#[derive(Clone, Debug)]
pub struct Looks {
    parts: Vec<PictureTile>,
    sources: Vec<RaySource>,
}

/// Textures of all images: one layer for each.
#[derive(Debug)]
struct Layers {
    /// Width, height, how many; what they were made for.
    size: [u32; 3],
    has: [bool; 4],
    /// Codes, colours, interpolated depth, shares of own light; depth.
    all: [wgpu::TextureView; 5],
    each: Vec<[wgpu::TextureView; 5]>,
}

/// How the layers of a frame are: their size, and which of colours, interpolated depth, own light and normals they have.
fn layers_of(plan: &FramePlan, sources: &[RaySource]) -> ([u32; 3], [bool; 4]) {
    let side =
        |axis: usize| sources.iter().map(|source| source.tile.size[axis]).max().unwrap_or(1).next_multiple_of(64);
    let has = [plan.colored, plan.input.measured, plan.texels_emit, plan.smooth];
    ([side(0), side(1), sources.len() as u32], has)
}

impl Layers {
    fn new(gpu: &Gpu, size: [u32; 3], has: [bool; 4]) -> Self {
        use wgpu::TextureUsages as U;
        let [colored, measured, texels_emit, smooth] = has;
        let wanted = [
            (true, "codes of images", codes(smooth)),
            (colored, "colours of images", COLORS),
            (measured, "own depth of images", OWN_DEPTH),
            (texels_emit, "own light of images", EMISSIONS),
            (true, "depth of images", DEPTH),
        ];
        let textures = wanted.map(|(is_there, label, format)| {
            // What nothing writes is there to be bound.
            let size = if is_there { size } else { [1, 1, size[2]] };
            gpu.texture(label, size, 1, format, U::RENDER_ATTACHMENT | U::TEXTURE_BINDING)
        });
        let view = |texture: &wgpu::Texture, layer: Option<u32>| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(match layer {
                    Some(_) => wgpu::TextureViewDimension::D2,
                    None => wgpu::TextureViewDimension::D2Array,
                }),
                base_array_layer: layer.unwrap_or(0),
                array_layer_count: layer.map(|_| 1),
                ..Default::default()
            })
        };
        let each = (0..size[2]).map(|layer| std::array::from_fn(|i| view(&textures[i], Some(layer)))).collect();
        Self { size, has, all: std::array::from_fn(|i| view(&textures[i], None)), each }
    }
}

/// What an image is drawn with: its view, and where its axes are others than the picture's, lenses in its space.
#[derive(Debug)]
struct Eye {
    view: Synced,
    regions: Synced,
    planes: Synced,
}

impl Eye {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            view: Synced::new(gpu, "view of an image", wgpu::BufferUsages::UNIFORM)?,
            regions: Synced::new(gpu, "lens shapes of an image", wgpu::BufferUsages::UNIFORM)?,
            planes: Synced::new(gpu, "lens planes of an image", wgpu::BufferUsages::STORAGE)?,
        })
    }

    fn fit(&mut self, stage: &Preparing, source: &RaySource) -> Result<layout::View, GpuError> {
        let (gpu, plan) = (stage.gpu, stage.plan);
        let input = plan.input;
        // Of several samples each looks elsewhere into its texels: not where pixels look to, or what is off by a part of a texel would be so in all.
        let jitter = if input.is_summed() { jitter_px(input.sample).perp() } else { DVec2::ZERO };
        let uniform = view_uniform(&source.view, source.tile, jitter, input.sample, 0.0);
        self.view.sync(gpu, &[uniform])?;
        if plan.cuts.picture.is_some() && source.is_turned(&input.view) {
            let own = FrameInput { view: source.view, ..input.clone() };
            let numbers = LensNumbers::new(&own, &plan.seen.volumes, &plan.requests, plan.own_sprites);
            self.regions.sync(gpu, &of_volumes(&numbers.regions, stage.programs.is_uber))?;
            self.planes.sync(gpu, &numbers.planes)?;
        }
        Ok(uniform)
    }
}

/// What the pass keeps, once a lens bent pictures.
#[derive(Debug)]
struct Kept {
    eyes: Vec<Eye>,
    uniform: Synced,
    layers: Layers,
}

/// Bent pictures.
#[derive(Debug)]
pub struct RayWarp(Option<Kept>);

impl Kept {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let uniform = Synced::new(gpu, "images of what the eye sees", wgpu::BufferUsages::UNIFORM)?;
        Ok(Self { eyes: Vec::new(), uniform, layers: Layers::new(gpu, [1; 3], [false; 4]) })
    }

    /// Draws an image.
    fn draw_source(&self, number: usize, source: &RaySource, frame: &FrameContext, recording: &mut Recording) {
        let FrameContext { gpu, pipelines, cities, shared, groups, targets, plan, .. } = *frame;
        let Eye { view, regions, planes } = &self.eyes[number];
        let made = |layout: &GroupLayout, entries: &[(u32, wgpu::BindingResource)]| {
            group(gpu, layout.label, &pipelines.layout(layout), entries)
        };
        let view = made(&VIEW, &[(0, whole(view.buffer()))]);
        let cut = CutBy::of_picture(frame);
        let turned = (cut.is_some() && source.is_turned(&plan.input.view)).then(|| {
            let lenses = Shared::lenses(shared, targets, &shared.sprite_places, regions);
            [made(&LENSES, &lenses), made(&CUT_CITY, &shared.cut_city(&cities, planes))]
        });
        let [lenses, cut_city] = match &turned {
            Some([lenses, cut_city]) => [lenses, cut_city],
            None => [&groups.lenses, &groups.cut_city],
        };
        let [codes, colors, own_depth, lights, depth] = &self.layers.each[number];
        let eye = OpaqueEye {
            name: "image",
            view: &source.view,
            groups: [&view, lenses, cut_city],
            targets: [codes, colors, own_depth, lights],
            depth,
            size: source.tile.size,
        };
        let hidden = cut.map(|by| by.cut);
        let sections = cities.drawn_sections(&plan.details, hidden);
        let part = |drawn| {
            let seen = visible(&drawn, eye.view, hidden);
            SectionPart { drawn, chunks: seen.into_iter().map(|seen| seen.chunk).collect() }
        };
        let parts: Vec<SectionPart> = sections.into_iter().map(part).collect();
        draw_opaque(frame, recording, &eye, "images of lenses", &parts, cut, true);
    }
}

impl Pass for RayWarp {
    type Input<'a> = Looks;

    const LIST: &'static [Line] = &[
        ("images of lenses", "of lenses that bend pictures: what the eye sees, as finely as they show it,"),
        ("bent pictures", "and what pixels in them find there, in place of what was drawn"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Looks> {
        let input = plan.input;
        let parts = bent::parts(input.rays, &input.view, input.tile, |method| method == RayMethod::Image);
        let is_asked = !parts.is_empty() && input.technique == Technique::Accumulate;
        is_asked.then(|| Looks { parts, sources: sources(input.rays, &input.view, input.tile) })
    }

    fn add_keys(&self, input: Option<&Looks>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        if input.is_some() {
            keys.add(24, [WarpKey::new(plan)]);
        }
    }

    fn prepare(&mut self, Looks { sources, .. }: &Looks, stage: &mut Preparing) -> Result<(), GpuError> {
        let mut kept = match self.0.take() {
            Some(kept) => kept,
            None => Kept::new(stage.gpu)?,
        };
        let (size, has) = layers_of(stage.plan, sources);
        if (kept.layers.size, kept.layers.has) != (size, has) {
            kept.layers = Layers::new(stage.gpu, size.map(|side| side.max(1)), has);
        }
        while kept.eyes.len() < sources.len() {
            kept.eyes.push(Eye::new(stage.gpu)?);
        }
        let mut uniform: layout::RaySources = bytemuck::Zeroable::zeroed();
        uniform.count = sources.len() as u32;
        for ((eye, source), slot) in kept.eyes.iter_mut().zip(sources).zip(&mut uniform.all) {
            *slot = source.row(&eye.fit(stage, source)?, &stage.plan.input.view);
        }
        kept.uniform.sync(stage.gpu, &[uniform])?;
        self.0 = Some(kept);
        Ok(())
    }

    fn record(
        &mut self,
        Looks { parts, sources }: &Looks,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(kept) = &self.0 else { return Ok(()) };
        debug_assert!(sources.len() <= MOST_SOURCES);
        for (number, source) in sources.iter().enumerate() {
            kept.draw_source(number, source, frame, recording);
        }
        let FrameContext { gpu, pipelines, cities, targets, groups, plan, .. } = *frame;
        let [codes, colors, _, lights, depth] = &kept.layers.all;
        let bound = |view| wgpu::BindingResource::TextureView(view);
        let entries = [
            (0, bound(cities.surfaces())),
            (1, whole(kept.uniform.buffer())),
            (2, bound(codes)),
            (3, bound(depth)),
            (4, bound(colors)),
            (5, bound(lights)),
        ];
        let own = group(gpu, SOURCES.label, &pipelines.layout(&SOURCES), &entries);
        let targeted = in_order([
            Some(&targets.codes),
            plan.colored.then_some(&targets.colors),
            plan.input.measured.then_some(&targets.own_depth),
            None,
            plan.texels_emit.then_some(&targets.emissions),
        ]);
        let colors: Vec<_> = targeted.into_iter().map(|target| target.map(|target| self::kept(&target.view))).collect();
        let lenses = plan.input.rays.lenses();
        let pass = DrawnPass {
            name: "bent pictures",
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            colors: &colors,
            depth: Some(kept_depth(&targets.depth.view)),
        };
        recording.draw(pass, |pass| {
            pass.set_pipeline(pipelines.get(&WarpKey::new(plan)));
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &own, &[]);
            pass.set_bind_group(2, &groups.lenses, &[]);
            for part in parts {
                scissor(pass, *part);
                pass.draw(0..3, 0..1);
            }
            Counted { draws: parts.len() as u32, triangles: parts.len() as u64 }
        });
        Ok(())
    }
}
