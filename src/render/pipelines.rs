//! Pipelines by canonical key, made when first needed, or off the frame; how many were made and met again is counted.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    gpu::Gpu,
    render::{
        cut,
        key::{FurniturePart, GeometryKind, Key},
        worker::Worker,
    },
    shader::Module,
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
/// Numbers of regions, only where a technique tells them apart by passes.
pub const REGIONS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
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
/// Translucent layers before they are laid over the picture: linear, premultiplied; alpha: what is let through.
pub const VEIL: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Furniture before it is laid over a transparent picture: linear, premultiplied.
pub const FURNITURE_LAYER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

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
    /// Shade where there are lines or translucent layers, group 3: both, as they are laid over the picture.
    pub lines: wgpu::BindGroupLayout,
    /// Layers, group 0: the view, lists, notes, the depth of what is opaque.
    pub layers: wgpu::BindGroupLayout,
    /// Slots, group 0: the view, lists and records, slots, the depth of what is opaque, the band at a dynamic offset.
    pub slots: wgpu::BindGroupLayout,
    /// Fragments shaded where they are drawn, group 0: the view, slots, the band and the city, both at dynamic offsets.
    pub forward: wgpu::BindGroupLayout,
    /// Link slots, group 0: lists and records, slots, the band at a dynamic offset.
    pub link_slots: wgpu::BindGroupLayout,
    /// Composite, group 3: lists, notes, the tail of slots.
    pub layer_lists: wgpu::BindGroupLayout,
    /// Count and sort layers, group 0: lists, notes.
    pub layer_order: wgpu::BindGroupLayout,
    /// Shown layers, group 0: which are, and their depth.
    pub shown_layers: wgpu::BindGroupLayout,
    /// Lines, group 3: the stage and the city, at dynamic offsets.
    pub line_stage: wgpu::BindGroupLayout,
    /// Geometry of a region, group 0: the view, and the number of the region at a dynamic offset.
    pub region: wgpu::BindGroupLayout,
    /// Regions, group 3: their numbers.
    pub regions: wgpu::BindGroupLayout,
    /// Sections, group 3: the stage at a dynamic offset, and the ends of rays.
    pub sections: wgpu::BindGroupLayout,
    /// Filter, group 0: the stage at a dynamic offset, the image, parameters.
    pub filter: wgpu::BindGroupLayout,
    /// Resolve, group 0.
    pub resolve: wgpu::BindGroupLayout,
    /// Furniture, group 0: the target, coverage of text.
    pub furniture: wgpu::BindGroupLayout,
    /// Furniture, group 1: the picture of an overlay, its mask, a sampler.
    pub furniture_picture: wgpu::BindGroupLayout,
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
        let filterable = image(T::Float { filterable: true }, D::D2);
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
            lines: layout(gpu, "lines and layers", &[(0, S::FRAGMENT, float), (1, S::FRAGMENT, float)]),
            layers: layout(
                gpu,
                "layers",
                &[(0, all, uniform()), (1, S::FRAGMENT, written), (2, S::FRAGMENT, written), (3, S::FRAGMENT, depth)],
            ),
            slots: layout(
                gpu,
                "slots of layers",
                &[
                    (0, all, uniform()),
                    (1, S::FRAGMENT, written),
                    (2, S::FRAGMENT, written),
                    (3, S::FRAGMENT, depth),
                    (4, S::FRAGMENT, dynamic),
                ],
            ),
            forward: layout(
                gpu,
                "fragments",
                &[(0, all, uniform()), (2, S::FRAGMENT, storage()), (4, S::FRAGMENT, dynamic), (5, all, dynamic)],
            ),
            link_slots: layout(
                gpu,
                "slots as lists",
                &[(0, S::COMPUTE, written), (1, S::COMPUTE, written), (2, S::COMPUTE, dynamic)],
            ),
            layer_lists: layout(
                gpu,
                "lists of layers",
                &[
                    (0, S::FRAGMENT, written),
                    (1, S::FRAGMENT, storage()),
                    (2, S::FRAGMENT, float),
                    (3, S::FRAGMENT, float),
                ],
            ),
            layer_order: layout(gpu, "order of layers", &[(0, S::COMPUTE, written), (1, S::COMPUTE, written)]),
            shown_layers: layout(
                gpu,
                "shown layers",
                &[(0, S::FRAGMENT, image(T::Uint, D::D2)), (1, S::FRAGMENT, float)],
            ),
            line_stage: layout(gpu, "line stage", &[(0, all, dynamic), (1, all, dynamic)]),
            region: layout(gpu, "region", &[(0, all, uniform()), (1, S::FRAGMENT, dynamic)]),
            sections: {
                let written = buffer(wgpu::BufferBindingType::Storage { read_only: false }, false);
                let stage = buffer(wgpu::BufferBindingType::Storage { read_only: true }, true);
                layout(gpu, "sections", &[(0, S::FRAGMENT, stage), (1, S::FRAGMENT, written)])
            },
            regions: layout(gpu, "regions", &[(0, S::FRAGMENT, surfaces)]),
            filter: layout(gpu, "filter", &[(0, all, dynamic), (1, S::FRAGMENT, packed), (2, all, uniform())]),
            resolve: layout(gpu, "resolve", &[(0, S::FRAGMENT, uniform()), (1, S::FRAGMENT, float)]),
            furniture: layout(gpu, "furniture", &[(0, all, uniform()), (1, S::FRAGMENT, storage())]),
            furniture_picture: layout(
                gpu,
                "furniture's pictures",
                &[(0, S::FRAGMENT, filterable), (1, S::FRAGMENT, filterable), (2, S::FRAGMENT, filtered)],
            ),
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
                let view = if key.is_of_region() { &self.region } else { &self.view };
                vec![Some(view), Some(city), lenses, image]
            }
            Key::Shadow(Some(_)) => vec![Some(&self.view), Some(&self.cut_city), Some(&self.shapes)],
            Key::Shadow(None) | Key::Bare => vec![Some(&self.view), Some(&self.city)],
            Key::SolidSprite(_) | Key::CombinedSprite(..) => {
                vec![Some(&self.view), Some(&self.planes), Some(&self.stage)]
            }
            Key::Shade { program, .. } => {
                let has = program.has();
                let lines = (has.lines || has.veils).then_some(&self.lines);
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), lines]
            }
            Key::Layers { section, .. } => {
                let image = matches!(section, GeometryKind::Textured(_)).then_some(&self.image);
                vec![Some(&self.layers), Some(&self.cut_city), Some(&self.lenses), image]
            }
            Key::Composite { .. } => {
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), Some(&self.layer_lists)]
            }
            Key::Translucent(own) => own.groups(self),
            Key::LinkSlots(_) => vec![Some(&self.link_slots)],
            Key::CountLayers(_) | Key::SortLayers { .. } => vec![Some(&self.layer_order)],
            Key::ShownLayers { .. } => vec![Some(&self.shown_layers)],
            Key::Lines { .. } => {
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), Some(&self.line_stage)]
            }
            Key::Regions(_) => {
                vec![Some(&self.view), Some(&self.shade), Some(&self.lenses), Some(&self.regions)]
            }
            Key::Section { .. } => {
                vec![Some(&self.view), Some(&self.cut_city), Some(&self.lenses), Some(&self.sections)]
            }
            Key::Filter(_) => vec![Some(&self.filter)],
            Key::Resolve => vec![Some(&self.resolve)],
            Key::StoredForm(_) | Key::StoredLayers(_) => vec![None, Some(&self.planes), Some(&self.stored)],
            Key::SpriteList => vec![None, None, Some(&self.stored)],
            Key::Furniture {
                part: FurniturePart::Picture | FurniturePart::OpaquePicture | FurniturePart::Board | FurniturePart::Skin,
                ..
            } => {
                vec![Some(&self.furniture), Some(&self.furniture_picture)]
            }
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

    /// All are made anew: effects have other WGSL now.
    pub fn forget(&mut self) {
        self.worker = None;
        self.modules.clear();
        self.made.clear();
        self.asked.clear();
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
