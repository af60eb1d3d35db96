//! Pipelines by canonical key, made when first needed, or off the frame; how many were made and met again is counted.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    gpu::Gpu,
    render::{cut, edges::Edge, layout, sprite_passes::SolidStage, stored::LIST_TARGET, worker::Worker},
    shader::{Module, Program, VolumeTest},
};

/// Depth everywhere: reversed, f32.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Surface number + 1.
pub const CODES: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// The same and a packed normal, in cities with smooth faces.
pub const SMOOTH_CODES: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// sRGB base colours, only in cities with textures.
pub const COLORS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Interpolated depth, only where the depth AOV is asked for.
pub const OWN_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// One bit per lens and class.
pub const MASKS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Four colours or opacities as `lib/packed.wgsl` packs them: what neighbourhood filters read and write.
pub const FILTERED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Stored depths of an entry and of an exit: the sides of solids.
pub const SPRITES: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// The picture: sRGB bytes.
pub const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Lines before they are laid over the picture: linear, premultiplied.
pub const LINES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Furniture before it is laid over a transparent picture: linear, premultiplied.
pub const FURNITURE_LAYER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What makes a pipeline the one it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// Opaque triangles.
    Geometry {
        /// How vertices are laid out and where depth comes from.
        section: GeometryKind,
        /// Whether base colours are written.
        colored: bool,
        /// Whether normals are interpolated.
        smooth: bool,
        /// Whether they are in other cities of the picture, and this one has flat faces alone.
        flat: bool,
        /// Whether interpolated depth is written, for the AOV.
        measured: bool,
        /// What is hidden.
        cut: Option<Program>,
    },
    /// Depth from the sun, and what is hidden from it.
    Shadow(Option<Program>),
    /// One of the draws that make the depth sprite of a solid.
    SolidSprite(SolidStage),
    /// One of those of a combination, and what its leaves are.
    CombinedSprite(SolidStage, Vec<VolumeTest>),
    /// The stored depth sprite of a volume that has a closed form, by its kind.
    StoredForm(VolumeTest),
    /// That of a lens of several leaves, or of a solid, and what the leaves are.
    StoredLayers(Vec<VolumeTest>),
    /// Where rays go through the faces of its solids.
    SpriteList,
    /// Shading.
    Shade {
        /// What the context and the lenses do.
        program: Program,
        /// Which pixels.
        shown: Shown,
        /// Base colours come from a target.
        textured: bool,
        /// One clay colour.
        clay: bool,
        /// Where it goes.
        target: ShadeTarget,
        /// There is a shadow map.
        shadows: bool,
        /// Normals are in the target.
        smooth: bool,
        /// What is behind the city.
        behind: Behind,
    },
    /// Edges as lines, and whether normals are in the target.
    Lines {
        /// What lines go through.
        program: Program,
        /// Normals are in the target.
        smooth: bool,
    },
    /// One direction of a neighbourhood filter, by its handler.
    Filter(u32),
    /// The mean of samples.
    Resolve,
    /// Titles, captions and legends; over the picture, or into a layer of their own where it is transparent.
    Furniture {
        /// Into a layer.
        layered: bool,
    },
    /// The layer of furniture over a transparent picture.
    FurnitureOver,
    /// One lit pass without anything else: what benchmarks compare with.
    Bare,
}

/// Pixels that shading is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shown {
    /// Those that show a surface.
    Surface,
    /// Those that show what is behind the city.
    Background,
    /// All; four at once.
    Any,
}

/// Where shading goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShadeTarget {
    /// The picture.
    Picture,
    /// The sum of samples, weighted by coverage.
    Sums,
    /// What a filter reads: colours weighted by coverage, and where the picture is transparent their opacity.
    Unfiltered,
}

/// What is behind the city, as `lib/light.wgsl` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Behind {
    /// The sky.
    Sky = 0,
    /// One colour.
    OneColor = 1,
    /// The picture is transparent.
    Nothing = 2,
}

impl Behind {
    /// Images that a neighbourhood filter has of such a picture: colours, and of a transparent one opacity.
    pub fn images(self) -> usize {
        1 + usize::from(self == Self::Nothing)
    }
}

/// Kinds of geometry sections, as far as pipelines differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometryKind {
    /// Ordinary.
    Plain,
    /// Textured, with the bits of the alpha cutoff.
    Textured(u32),
    /// Depth from the shared plane.
    Coplanar,
}

/// The layouts that pipelines share, and the device that makes them.
#[derive(Clone, Debug)]
pub struct Layouts {
    device: wgpu::Device,
    /// Group 0 everywhere: the view.
    pub view: wgpu::BindGroupLayout,
    /// Geometry and shadow, group 1: surfaces.
    pub city: wgpu::BindGroupLayout,
    /// Geometry, group 3: a texture.
    pub image: wgpu::BindGroupLayout,
    /// Sprite, group 1: planes of convex volumes, faces of solids.
    pub planes: wgpu::BindGroupLayout,
    /// Sprite, group 2: the stage, at a dynamic offset.
    pub stage: wgpu::BindGroupLayout,
    /// Stored sprites, group 2: the stage, at a dynamic offset, and the sprites.
    pub stored: wgpu::BindGroupLayout,
    /// Shade, group 1: surfaces, planes of convex volumes, faces of solids, light, targets.
    pub shade: wgpu::BindGroupLayout,
    /// Shade, and geometry where something is hidden, group 2: sprites, object values, parameters, volumes, masks,
    /// invokers, filtered images, shapes.
    pub lenses: wgpu::BindGroupLayout,
    /// Geometry and shadow where something is hidden, group 1: surfaces, planes of convex volumes, faces of solids; the city, for
    /// the view and for the main eye, at dynamic offsets.
    pub cut_city: wgpu::BindGroupLayout,
    /// Shadow where something is hidden, group 2.
    pub shapes: wgpu::BindGroupLayout,
    /// Shade where there are lines, group 3: their layer.
    pub lines: wgpu::BindGroupLayout,
    /// Lines, group 3: the stage and the city, at dynamic offsets.
    pub line_stage: wgpu::BindGroupLayout,
    /// Filter, group 0: the stage at a dynamic offset, the image, parameters.
    pub filter: wgpu::BindGroupLayout,
    /// Resolve, group 0.
    pub resolve: wgpu::BindGroupLayout,
    /// Furniture, group 0: the target, coverage of text.
    pub furniture: wgpu::BindGroupLayout,
    /// Furniture over a transparent picture, group 0: both.
    pub furniture_over: wgpu::BindGroupLayout,
    /// Where samples are summed: f32 where it can be blended, else f16.
    pub sums: wgpu::TextureFormat,
}

/// A pipeline that draws, or computes.
#[derive(Clone, Debug)]
pub(super) enum Pipeline {
    Render(wgpu::RenderPipeline),
    Compute(wgpu::ComputePipeline),
}

/// Shader modules by what is in them.
pub(super) type Modules = FxHashMap<Module, wgpu::ShaderModule>;

/// All pipelines.
#[derive(Debug)]
pub struct Pipelines {
    /// What they share.
    pub layouts: Layouts,
    modules: Modules,
    made: FxHashMap<Key, Pipeline>,
    /// Pipelines that a frame waited for, since the last [`Pipelines::begin_picture`].
    pub compiled: u32,
    /// Whether lists were narrowed since then, and whether the pipeline for it was made.
    pub narrowing: Option<bool>,
    /// Pipelines that were made off the frame and arrived since then.
    pub arrived: u32,
    /// Keys of the pipelines used since then, in order of first use.
    pub used: Vec<Key>,
    /// Made off the frame: what was asked for and is not there yet, and the worker that makes it.
    asked: FxHashSet<Key>,
    worker: Option<Worker>,
}

use wgpu::{BindingType as B, ShaderStages as S};

fn buffer(ty: wgpu::BufferBindingType, has_dynamic_offset: bool) -> B {
    B::Buffer { ty, has_dynamic_offset, min_binding_size: None }
}

pub(super) fn uniform() -> B {
    buffer(wgpu::BufferBindingType::Uniform, false)
}

pub(super) fn storage() -> B {
    buffer(wgpu::BufferBindingType::Storage { read_only: true }, false)
}

fn image(sample_type: wgpu::TextureSampleType, view_dimension: wgpu::TextureViewDimension) -> B {
    B::Texture { sample_type, view_dimension, multisampled: false }
}

pub(super) fn layout(gpu: &Gpu, label: &str, entries: &[(u32, S, B)]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries
        .iter()
        .map(|&(binding, visibility, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

impl Layouts {
    fn new(gpu: &Gpu) -> Self {
        use wgpu::{TextureSampleType as T, TextureViewDimension as D};
        let float = image(T::Float { filterable: false }, D::D2);
        let depth = image(T::Depth, D::D2);
        let surfaces = image(T::Uint, D::D2);
        let floats = image(T::Float { filterable: false }, D::D2Array);
        let packed = image(T::Uint, D::D2Array);
        let masks = B::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: MASKS,
            view_dimension: D::D2Array,
        };
        let sums = if gpu.device.features().contains(wgpu::Features::FLOAT32_BLENDABLE) {
            wgpu::TextureFormat::Rgba32Float
        } else {
            wgpu::TextureFormat::Rgba16Float
        };
        let all = S::VERTEX | S::FRAGMENT;
        let computed = S::FRAGMENT | S::COMPUTE;
        let written = buffer(wgpu::BufferBindingType::Storage { read_only: false }, false);
        let dynamic = buffer(wgpu::BufferBindingType::Uniform, true);
        let filtered = B::Sampler(wgpu::SamplerBindingType::Filtering);
        let compared = B::Sampler(wgpu::SamplerBindingType::Comparison);
        Self {
            device: gpu.device.clone(),
            view: layout(gpu, "view", &[(0, all, uniform())]),
            city: layout(gpu, "city", &[(0, S::FRAGMENT, surfaces)]),
            image: layout(
                gpu,
                "image",
                &[(0, S::FRAGMENT, image(T::Float { filterable: true }, D::D2)), (1, S::FRAGMENT, filtered)],
            ),
            planes: layout(gpu, "planes", &[(1, computed, storage()), (2, computed, storage())]),
            stage: layout(gpu, "stage", &[(0, all, dynamic)]),
            stored: layout(
                gpu,
                "stored sprites",
                &[
                    (0, all | S::COMPUTE, dynamic),
                    (1, S::COMPUTE, written),
                    (2, computed, written),
                    (3, computed, written),
                    (4, computed, written),
                ],
            ),
            shade: layout(
                gpu,
                "shade",
                &[
                    (0, S::FRAGMENT, surfaces),
                    (1, S::FRAGMENT, storage()),
                    (2, S::FRAGMENT, storage()),
                    (3, all, uniform()),
                    (4, S::FRAGMENT, depth),
                    (5, S::FRAGMENT, compared),
                    (6, S::FRAGMENT, image(T::Uint, D::D2)),
                    (7, S::FRAGMENT, depth),
                    (8, S::FRAGMENT, float),
                ],
            ),
            lenses: layout(
                gpu,
                "lenses",
                &[
                    (0, S::FRAGMENT, floats),
                    (1, S::FRAGMENT, storage()),
                    (2, all, uniform()),
                    (3, S::FRAGMENT, uniform()),
                    (4, S::FRAGMENT, masks),
                    (5, S::FRAGMENT, uniform()),
                    (6, S::FRAGMENT, packed),
                    (7, all, uniform()),
                    (8, S::FRAGMENT, storage()),
                    (9, S::FRAGMENT, storage()),
                    (10, S::FRAGMENT, storage()),
                ],
            ),
            cut_city: layout(
                gpu,
                "surfaces and planes",
                &[
                    (0, S::FRAGMENT, surfaces),
                    (1, S::FRAGMENT, storage()),
                    (2, S::FRAGMENT, storage()),
                    (3, all, dynamic),
                    (4, S::VERTEX, dynamic),
                ],
            ),
            shapes: cut::shapes_layout(gpu),
            lines: layout(gpu, "lines", &[(0, S::FRAGMENT, float)]),
            line_stage: layout(gpu, "line stage", &[(0, all, dynamic), (1, all, dynamic)]),
            filter: layout(gpu, "filter", &[(0, all, dynamic), (1, S::FRAGMENT, packed), (2, all, uniform())]),
            resolve: layout(gpu, "resolve", &[(0, S::FRAGMENT, uniform()), (1, S::FRAGMENT, float)]),
            furniture: layout(gpu, "furniture", &[(0, all, uniform()), (1, S::FRAGMENT, storage())]),
            furniture_over: layout(gpu, "furniture over", &[(0, S::FRAGMENT, float), (1, S::FRAGMENT, float)]),
            sums,
        }
    }

    fn module(&self, modules: &mut Modules, module: Module) -> wgpu::ShaderModule {
        let room = self.device.limits().max_inter_stage_shader_variables;
        let make = |m: &Module| {
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&m.name()),
                source: wgpu::ShaderSource::Wgsl(m.source_for_people(crate::shader::handlers(), &[], room).into()),
            })
        };
        modules.entry(module.clone()).or_insert_with(|| make(&module)).clone()
    }

    pub(super) fn make(&self, modules: &mut Modules, key: &Key) -> Pipeline {
        let module = self.module(modules, key.module());
        let groups: Vec<Option<&wgpu::BindGroupLayout>> = match key {
            Key::Geometry { section, cut, .. } => {
                let lenses = cut.is_some().then_some(&self.lenses);
                let image = matches!(section, GeometryKind::Textured(_)).then_some(&self.image);
                let city = if cut.is_some() { &self.cut_city } else { &self.city };
                vec![Some(&self.view), Some(city), lenses, image]
            }
            Key::Shadow(Some(_)) => vec![Some(&self.view), Some(&self.cut_city), Some(&self.shapes)],
            Key::Shadow(None) | Key::Bare => vec![Some(&self.view), Some(&self.city)],
            Key::SolidSprite(_) | Key::CombinedSprite(..) => {
                vec![Some(&self.view), Some(&self.planes), Some(&self.stage)]
            }
            Key::Shade { program, .. } => {
                let lines = program.has().lines.then_some(&self.lines);
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), lines]
            }
            Key::Lines { .. } => {
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), Some(&self.line_stage)]
            }
            Key::Filter(_) => vec![Some(&self.filter)],
            Key::Resolve => vec![Some(&self.resolve)],
            Key::StoredForm(_) | Key::StoredLayers(_) => vec![None, Some(&self.planes), Some(&self.stored)],
            Key::SpriteList => vec![None, None, Some(&self.stored)],
            Key::Furniture { .. } => vec![Some(&self.furniture)],
            Key::FurnitureOver => vec![Some(&self.furniture_over)],
        };
        let name = key.name();
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&name),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let constants = key.constants();
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        if let Some(entry) = key.compute_entry() {
            return Pipeline::Compute(self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: options,
                cache: None,
            }));
        }
        let (vertex_entry, fragment_entry) = key.entry_points();
        let targets = key.targets(self.sums);
        let buffers = key.vertex_buffers();
        Pipeline::Render(self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex_entry),
                compilation_options: options.clone(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState { topology: key.topology(), ..Default::default() },
            depth_stencil: key.depth_test(),
            multisample: wgpu::MultisampleState::default(),
            fragment: fragment_entry.map(|entry| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        }))
    }
}

impl Pipelines {
    /// The layouts; no pipeline yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            layouts: Layouts::new(gpu),
            modules: Modules::default(),
            made: FxHashMap::default(),
            compiled: 0,
            narrowing: None,
            arrived: 0,
            used: Vec::new(),
            asked: FxHashSet::default(),
            worker: None,
        }
    }

    /// Starts counting anew.
    pub fn begin_picture(&mut self) {
        (self.compiled, self.arrived) = (0, 0);
        self.narrowing = None;
        self.used.clear();
    }

    /// Makes a pipeline if it is not there yet.
    pub fn prepare(&mut self, key: &Key) {
        if !self.made.contains_key(key) {
            let pipeline = self.layouts.make(&mut self.modules, key);
            self.made.insert(key.clone(), pipeline);
            self.compiled += 1;
        }
        if !self.used.contains(key) {
            self.used.push(key.clone());
        }
    }

    /// Whether a pipeline is there; if it is not, it is made off the frame, and is there in a later one.
    pub fn is_ready(&mut self, key: &Key) -> bool {
        while let Some(Ok((key, pipeline))) = self.worker.as_ref().map(|w| w.ready.try_recv()) {
            self.asked.remove(&key);
            // The frame may have made it meanwhile.
            self.made.entry(key).or_insert(pipeline);
            self.arrived += 1;
        }
        if self.made.contains_key(key) {
            return true;
        }
        if self.asked.insert(key.clone()) {
            if self.worker.is_none() {
                self.worker = Worker::start(self.layouts.clone());
            }
            let sent = self
                .worker
                .as_ref()
                .is_some_and(|w| w.wanted.as_ref().is_some_and(|wanted| wanted.send(key.clone()).is_ok()));
            if !sent {
                self.worker = None;
                self.asked.clear();
            }
        }
        false
    }

    /// How many pipelines are being made off the frame.
    pub fn pending(&self) -> usize {
        self.asked.len()
    }

    /// A prepared pipeline.
    pub fn get(&self, key: &Key) -> &wgpu::RenderPipeline {
        match self.made.get(key) {
            Some(Pipeline::Render(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }

    /// A prepared pipeline that computes.
    pub fn get_compute(&self, key: &Key) -> &wgpu::ComputePipeline {
        match self.made.get(key) {
            Some(Pipeline::Compute(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }
}

const VERTEX: &[wgpu::VertexAttribute] =
    &wgpu::vertex_attr_array![0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32];
const TEXCOORD: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x2];
const PLANE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x3, 5 => Sint32x3, 6 => Float32];
const SOLID_CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x3];
const CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x2];
const FURNITURE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32x2, 2 => Float32x4, 3 => Float32x4, 4 => Float32, 5 => Float32, 6 => Uint32, 7 => Uint32];

fn per_vertex(array_stride: u64, attributes: &[wgpu::VertexAttribute]) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
}

impl Key {
    fn module(&self) -> Module {
        match self {
            Self::Geometry { cut, .. } => Module::Geometry(cut.clone()),
            Self::Shadow(cut) => Module::Shadow(cut.clone()),
            Self::CombinedSprite(_, kinds) => Module::CombinedSprite(kinds.clone()),
            Self::StoredForm(_) => Module::StoredForm,
            Self::StoredLayers(kinds) => Module::StoredLayers(kinds.clone()),
            Self::SpriteList => Module::SpriteList,
            Self::SolidSprite(_) => Module::Sprite,
            Self::Shade { program, .. } => Module::Shade(program.clone()),
            Self::Lines { program, .. } => Module::Lines(program.clone()),
            Self::Filter(effect) => Module::Filter(*effect),
            Self::Resolve => Module::Resolve,
            Self::Furniture { .. } => Module::Furniture,
            Self::FurnitureOver => Module::FurnitureOver,
            Self::Bare => Module::Bare,
        }
    }

    /// A name for people and statistics.
    pub fn name(&self) -> String {
        let flags = |list: &[(bool, &str)]| -> String {
            list.iter().filter(|(on, _)| *on).map(|(_, name)| format!(" {name}")).collect()
        };
        match self {
            Self::Geometry { section, colored, smooth, flat, measured, .. } => {
                let kind = match section {
                    GeometryKind::Plain => "",
                    GeometryKind::Textured(0) => " textured",
                    GeometryKind::Textured(_) => " textured with holes",
                    GeometryKind::Coplanar => " coplanar",
                };
                format!(
                    "{}{kind}{}",
                    self.module().name(),
                    flags(&[(*colored, "colored"), (*smooth, "smooth"), (*flat, "flat"), (*measured, "measured")])
                )
            }
            Self::Shadow(_) => self.module().name(),
            Self::StoredForm(kind) => format!("depth sprite of a {}", kind.constant().to_lowercase()),
            Self::StoredLayers(_) => "depth sprite in layers".to_owned(),
            Self::SpriteList => "crossings of a sprite".to_owned(),
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => match stage {
                SolidStage::Missed => "depth sprite of a solid",
                SolidStage::Nearest => "depth sprite of a solid, nearest",
                SolidStage::Farthest => "depth sprite of a solid, farthest",
                SolidStage::NearestForm => "depth sprite of a combination, nearest of its forms",
                SolidStage::FarthestForm => "depth sprite of a combination, farthest of its forms",
                SolidStage::NearestFace => "depth sprite of a combination, nearest of its faces",
                SolidStage::FarthestFace => "depth sprite of a combination, farthest of its faces",
            }
            .to_owned(),
            Self::Shade { shown, textured, clay, target, shadows, .. } => {
                let list = [
                    (*shown == Shown::Background, "background"),
                    (*textured, "textured"),
                    (*clay, "clay"),
                    (*target == ShadeTarget::Sums, "summed"),
                    (*target == ShadeTarget::Unfiltered, "unfiltered"),
                    (*shadows, "shadows"),
                ];
                format!("{}{}", self.module().name(), flags(&list))
            }
            Self::Filter(_) | Self::Lines { .. } => self.module().name(),
            Self::Resolve => "resolve".to_owned(),
            Self::Furniture { layered: false } => "furniture".to_owned(),
            Self::Furniture { layered: true } => "furniture in a layer".to_owned(),
            Self::FurnitureOver => "furniture over a transparent picture".to_owned(),
            Self::Bare => "bare lit draw".to_owned(),
        }
    }

    fn constants(&self) -> Vec<(&'static str, f64)> {
        let flag = |on: bool| f64::from(u8::from(on));
        match self {
            Self::Geometry { section, smooth, flat, .. } => {
                let mut list = vec![("SMOOTH", flag(*smooth)), ("FLAT_CITY", flag(*flat))];
                if let GeometryKind::Textured(cutoff) = section {
                    list.push(("ALPHA_CUTOFF", f64::from(f32::from_bits(*cutoff))));
                }
                list
            }
            Self::Shade { textured, clay, target, shadows, smooth, behind, .. } => vec![
                ("TEXTURED", flag(*textured)),
                ("CLAY", flag(*clay)),
                ("SUMMED", flag(*target == ShadeTarget::Sums)),
                ("SHADOWS", flag(*shadows)),
                ("SMOOTH", flag(*smooth)),
                ("BACKGROUND", f64::from(*behind as u32)),
            ],
            Self::Lines { smooth, .. } => vec![("SMOOTH", flag(*smooth))],
            Self::StoredForm(kind) => vec![("KIND", f64::from(kind.number()))],
            _ => Vec::new(),
        }
    }

    fn compute_entry(&self) -> Option<&'static str> {
        matches!(self, Self::StoredForm(_) | Self::StoredLayers(_)).then_some("store")
    }

    fn entry_points(&self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Geometry { section, colored, measured, smooth, .. } => {
                let full = *colored || *measured;
                match (section, smooth) {
                    (GeometryKind::Plain, false) => ("vertex", Some(if full { "full" } else { "plain" })),
                    (GeometryKind::Plain, true) => {
                        ("vertex_smooth", Some(if full { "smooth_full" } else { "smooth_plain" }))
                    }
                    (GeometryKind::Textured(_), _) => ("vertex_textured", Some("textured")),
                    (GeometryKind::Coplanar, _) => {
                        ("vertex_coplanar", Some(if full { "coplanar_full" } else { "coplanar_plain" }))
                    }
                }
            }
            Self::Shadow(None) => ("vertex", None),
            Self::Shade { shown, .. } => {
                let fragment = match shown {
                    Shown::Surface => "surface",
                    Shown::Background => "background",
                    Shown::Any => "unfiltered",
                };
                ("vertex", Some(fragment))
            }
            Self::SpriteList => ("vertex", Some("note")),
            Self::SolidSprite(SolidStage::Missed) => ("vertex", Some("missed")),
            Self::SolidSprite(SolidStage::Nearest) => ("vertex_of_solid", Some("nearest")),
            Self::SolidSprite(SolidStage::Farthest) => ("vertex_of_solid", Some("farthest")),
            Self::CombinedSprite(SolidStage::NearestForm, _) => ("vertex", Some("nearest_form")),
            Self::CombinedSprite(SolidStage::FarthestForm, _) => ("vertex", Some("farthest_form")),
            Self::CombinedSprite(SolidStage::NearestFace, _) => ("vertex_of_solid", Some("nearest_face")),
            Self::CombinedSprite(SolidStage::FarthestFace, _) => ("vertex_of_solid", Some("farthest_face")),
            _ => ("vertex", Some("fragment")),
        }
    }

    fn vertex_buffers(&self) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
        let vertex = per_vertex(size_of::<layout::CityVertex>() as u64, VERTEX);
        match self {
            Self::Geometry { section: GeometryKind::Textured(_), .. } => vec![vertex, per_vertex(8, TEXCOORD)],
            Self::Geometry { section: GeometryKind::Coplanar, .. } => {
                vec![vertex, per_vertex(size_of::<layout::Plane>() as u64, PLANE)]
            }
            Self::Geometry { .. } | Self::Shadow(_) | Self::Bare => vec![vertex],
            Self::Lines { .. } => vec![Some(Edge::LAYOUT)],
            Self::Shade { .. } | Self::Filter(_) => vec![per_vertex(8, CORNER)],
            Self::SpriteList
            | Self::SolidSprite(SolidStage::Nearest | SolidStage::Farthest)
            | Self::CombinedSprite(SolidStage::NearestFace | SolidStage::FarthestFace, _) => {
                vec![per_vertex(12, SOLID_CORNER)]
            }
            Self::Furniture { .. } => vec![Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<layout::FurnitureItem>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: FURNITURE,
            })],
            _ => Vec::new(),
        }
    }

    fn topology(&self) -> wgpu::PrimitiveTopology {
        match self {
            Self::Lines { .. } => wgpu::PrimitiveTopology::TriangleStrip,
            _ => wgpu::PrimitiveTopology::TriangleList,
        }
    }

    fn targets(&self, sums: wgpu::TextureFormat) -> Vec<Option<wgpu::ColorTargetState>> {
        match self {
            Self::Geometry { colored, measured, smooth, .. } => {
                let codes = if *smooth { SMOOTH_CODES } else { CODES };
                let mut targets = vec![Some(codes.into()), colored.then(|| COLORS.into())];
                targets.extend(measured.then(|| Some(OWN_DEPTH.into())));
                // Without the colour target the list ends where it may.
                targets.truncate(if *measured { 3 } else { 1 + usize::from(*colored) });
                targets
            }
            Self::Shade { target: ShadeTarget::Sums, .. } => {
                let add = wgpu::BlendComponent {
                    src_factor: wgpu::BlendFactor::One,
                    dst_factor: wgpu::BlendFactor::One,
                    operation: wgpu::BlendOperation::Add,
                };
                vec![Some(wgpu::ColorTargetState {
                    format: sums,
                    blend: Some(wgpu::BlendState { color: add, alpha: add }),
                    write_mask: wgpu::ColorWrites::ALL,
                })]
            }
            Self::SpriteList => vec![Some(wgpu::ColorTargetState {
                format: LIST_TARGET,
                blend: None,
                write_mask: wgpu::ColorWrites::empty(),
            })],
            Self::SolidSprite(SolidStage::Missed) => vec![Some(SPRITES.into())],
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => {
                let write_mask = if stage.is_nearest() { wgpu::ColorWrites::RED } else { wgpu::ColorWrites::GREEN };
                vec![Some(wgpu::ColorTargetState { format: SPRITES, blend: None, write_mask })]
            }
            Self::Filter(_) => vec![Some(FILTERED.into()); 4],
            Self::Shade { target: ShadeTarget::Unfiltered, behind, .. } => {
                vec![Some(FILTERED.into()); behind.images()]
            }
            Self::Lines { .. } => vec![Some(wgpu::ColorTargetState {
                format: LINES,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
            Self::Furniture { layered } => vec![Some(wgpu::ColorTargetState {
                format: if *layered { FURNITURE_LAYER } else { PICTURE },
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
            Self::Shade { .. } | Self::Resolve | Self::FurnitureOver | Self::Bare => vec![Some(PICTURE.into())],
            _ => Vec::new(),
        }
    }

    fn depth_test(&self) -> Option<wgpu::DepthStencilState> {
        use wgpu::CompareFunction as C;
        let compare = match self {
            Self::SolidSprite(SolidStage::Missed) => return None,
            Self::Geometry { section: GeometryKind::Coplanar, .. } => C::GreaterEqual,
            Self::Geometry { .. } | Self::Shadow(_) | Self::Bare | Self::Lines { .. } => C::Greater,
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => {
                if stage.is_nearest() {
                    C::Greater
                } else {
                    C::Less
                }
            }
            // The triangle lies at depth 0, where nothing is stored.
            Self::Shade { shown: Shown::Surface, .. } => C::Less,
            Self::Shade { shown: Shown::Background, .. } => C::Equal,
            Self::Shade { shown: Shown::Any, .. }
            | Self::StoredForm(_)
            | Self::StoredLayers(_)
            | Self::SpriteList
            | Self::Filter(_)
            | Self::Resolve
            | Self::Furniture { .. }
            | Self::FurnitureOver => {
                return None;
            }
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(!matches!(self, Self::Shade { .. } | Self::Lines { .. })),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}
