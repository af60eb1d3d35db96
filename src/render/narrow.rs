//! Narrows the lists of invokers to what each tile shows, on the card, once its depth is known (L8).

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        frame::Recorder,
        layout,
        renderer::{Renderer, group, whole},
        synced::Synced,
        targets::Target,
    },
    shader::Module,
};

/// Made when a picture first has many lenses.
#[derive(Debug)]
pub(super) struct Narrowing {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    view: wgpu::BindGroupLayout,
    reaches: Synced,
    /// The narrowed lists.
    pub lists: wgpu::Buffer,
}

impl Narrowing {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::{BindingType as B, BufferBindingType as T};
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let buffer = |ty| B::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let depth = B::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let view = layout("view of tiles", &[entry(0, buffer(T::Uniform))]);
        let read = || buffer(T::Storage { read_only: true });
        let own =
            [entry(0, depth), entry(1, read()), entry(2, read()), entry(3, buffer(T::Storage { read_only: false }))];
        let own = layout("lists of tiles", &own);
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("narrow"),
            source: wgpu::ShaderSource::Wgsl(Module::Narrow.source().into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("narrow"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("narrow"),
                bind_group_layouts: &[Some(&view), Some(&own)],
                immediate_size: 0,
            })),
            module: &module,
            entry_point: Some("narrow"),
            compilation_options: Default::default(),
            cache: None,
        });
        let usage = wgpu::BufferUsages::STORAGE;
        let lists = gpu.empty_buffer("narrowed invokers of tiles", usage, 256)?;
        Ok(Self { pipeline, layout: own, view, reaches: Synced::new(gpu, "reaches of invokers", usage)?, lists })
    }

    /// Makes room; `true` if the lists were replaced by larger ones.
    fn sync(&mut self, gpu: &Gpu, reaches: &[layout::Reach], bytes: u64) -> Result<bool, GpuError> {
        self.reaches.sync(gpu, reaches)?;
        let is_small = self.lists.size() < bytes;
        if is_small {
            let usage = wgpu::BufferUsages::STORAGE;
            self.lists = gpu.empty_buffer("narrowed invokers of tiles", usage, bytes.next_power_of_two())?;
        }
        Ok(is_small)
    }
}

impl Renderer {
    /// Makes what narrows lists ready for these, each invoker with where it may act.
    pub(super) fn prepare_narrowing(&mut self, reaches: &[layout::Reach]) -> Result<(), GpuError> {
        let is_new = self.narrowing.is_none();
        if is_new {
            self.narrowing = Some(Narrowing::new(&self.gpu)?);
            self.groups = None;
        }
        self.pipelines.narrowing = Some(is_new || self.pipelines.narrowing == Some(true));
        let bytes = self.buffers.tile_lists.buffer().size();
        if let Some(narrowing) = &mut self.narrowing
            && narrowing.sync(&self.gpu, reaches, bytes)?
        {
            self.groups = None;
        }
        Ok(())
    }

    /// Narrows the lists of all tiles of the picture.
    pub(super) fn narrow_pass(&self, encoder: &mut wgpu::CommandEncoder, recorder: &mut Recorder, tiles: [u32; 2]) {
        let (Some(targets), Some(narrowing)) = (&self.targets, &self.narrowing) else { return };
        let depth: &Target = &targets.depth;
        let view = group(&self.gpu, "view of tiles", &narrowing.view, &[(0, whole(self.buffers.view.buffer()))]);
        let lists = [
            (0, wgpu::BindingResource::TextureView(&depth.view)),
            (1, whole(self.buffers.tile_lists.buffer())),
            (2, whole(narrowing.reaches.buffer())),
            (3, whole(&narrowing.lists)),
        ];
        let lists = group(&self.gpu, "lists of tiles", &narrowing.layout, &lists);
        let slot = recorder.begin("narrow lists", "main", &[], false);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("narrow lists"),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.compute_writes(slot)),
        });
        pass.set_pipeline(&narrowing.pipeline);
        pass.set_bind_group(0, &view, &[]);
        pass.set_bind_group(1, &lists, &[]);
        pass.dispatch_workgroups(tiles[0], tiles[1], 1);
        drop(pass);
        recorder.count(1, 0);
    }
}
