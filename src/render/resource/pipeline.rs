//! Making a pipeline of its key.

use rustc_hash::FxHashMap;

use crate::{
    gpu::Gpu,
    render::resource::{
        key::{AnyKey, Draw, Parts, Stage},
        layouts::Layouts,
    },
    shader::{Adapter, Module},
};

/// A pipeline that draws, or computes.
#[derive(Clone, Debug)]
pub enum Pipeline {
    /// Draws.
    Render(wgpu::RenderPipeline),
    /// Computes.
    Compute(wgpu::ComputePipeline),
}

/// Shader modules by what is in them.
pub type Modules = FxHashMap<Module, wgpu::ShaderModule>;

/// What texts of shaders need to know of an adapter.
pub fn adapter(gpu: &Gpu) -> Adapter {
    Adapter {
        carried: gpu.device.limits().max_inter_stage_shader_variables,
        snapping: gpu.snapping,
        holds_depth: gpu.holds_depth(),
    }
}

/// What makes pipelines.
#[derive(Clone, Debug)]
pub struct Maker {
    device: wgpu::Device,
    adapter: Adapter,
    /// The bind group layouts.
    pub layouts: Layouts,
    /// Where samples are summed: f32 where it can be blended, else f16.
    pub sums: wgpu::TextureFormat,
}

impl Maker {
    /// One for a device.
    pub fn new(gpu: &Gpu) -> Self {
        let sums = if gpu.device.features().contains(wgpu::Features::FLOAT32_BLENDABLE) {
            wgpu::TextureFormat::Rgba32Float
        } else {
            wgpu::TextureFormat::Rgba16Float
        };
        Self { device: gpu.device.clone(), adapter: adapter(gpu), layouts: Layouts::new(gpu), sums }
    }

    fn module(&self, modules: &mut Modules, module: Module) -> wgpu::ShaderModule {
        let make = |m: &Module| {
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&m.name()),
                source: wgpu::ShaderSource::Wgsl(
                    m.source_for_people(crate::shader::handlers(), &[], &self.adapter).into(),
                ),
            })
        };
        modules.entry(module.clone()).or_insert_with(|| make(&module)).clone()
    }

    /// The pipeline of a key, of modules that are there or are added.
    pub fn make(&self, modules: &mut Modules, key: &dyn AnyKey) -> Pipeline {
        let name = key.name();
        let Parts { module, groups, constants, stage } = key.parts(self.sums);
        let module = self.module(modules, module);
        let mut groups: Vec<_> = groups.into_iter().map(|group| group.map(|group| self.layouts.of(group))).collect();
        // Some adapters have four and count those that are empty.
        groups.truncate(groups.iter().rposition(Option::is_some).map_or(0, |last| last + 1));
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&name),
            bind_group_layouts: &groups.iter().map(Option::as_ref).collect::<Vec<_>>(),
            immediate_size: 0,
        });
        let compilation_options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let Draw { vertex, fragment, buffers, topology, targets, depth } = match stage {
            Stage::Draw(draw) => draw,
            Stage::Compute(entry) => {
                return Pipeline::Compute(self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&name),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options,
                    cache: None,
                }));
            }
        };
        Pipeline::Render(self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: compilation_options.clone(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: depth,
            multisample: wgpu::MultisampleState::default(),
            fragment: fragment.map(|entry| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        }))
    }
}
