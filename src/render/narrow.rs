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

/// Of the depths that a tile shows: a `vec2f` for each two columns.
const SHOWN_BYTES: u64 = 16 * 8;
/// Tiles that a workgroup of `narrow` goes through.
const TILES_PER_GROUP: u32 = 8;

/// Made when a picture first has many lenses.
#[derive(Debug)]
pub(super) struct Narrowing {
    /// The depths that tiles show, and what is left of their lists.
    pipelines: [wgpu::ComputePipeline; 2],
    layout: wgpu::BindGroupLayout,
    view: wgpu::BindGroupLayout,
    reaches: Synced,
    /// The narrowed lists.
    pub lists: wgpu::Buffer,
    /// The depths.
    shown: wgpu::Buffer,
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
        let written = || buffer(T::Storage { read_only: false });
        let own = [entry(0, depth), entry(1, read()), entry(2, read()), entry(3, written()), entry(4, written())];
        let own = layout("lists of tiles", &own);
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("narrow"),
            source: wgpu::ShaderSource::Wgsl(Module::Narrow.source().into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("narrow"),
            bind_group_layouts: &[Some(&view), Some(&own)],
            immediate_size: 0,
        });
        let pipelines = ["measure", "narrow"].map(|entry_point| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                cache: None,
            })
        });
        let usage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            pipelines,
            layout: own,
            view,
            reaches: Synced::new(gpu, "reaches of invokers", usage)?,
            lists: gpu.empty_buffer("narrowed invokers of tiles", usage, 256)?,
            shown: gpu.empty_buffer("what tiles show", usage, 256)?,
        })
    }

    /// Makes room for lists of so many bytes, and so many tiles; `true` if the lists were replaced by larger ones.
    fn sync(&mut self, gpu: &Gpu, reaches: &[layout::Reach], bytes: u64, tiles: u32) -> Result<bool, GpuError> {
        self.reaches.sync(gpu, reaches)?;
        let usage = wgpu::BufferUsages::STORAGE;
        let depths = u64::from(tiles) * SHOWN_BYTES;
        if self.shown.size() < depths {
            self.shown = gpu.empty_buffer("what tiles show", usage, depths.next_power_of_two())?;
        }
        let is_small = self.lists.size() < bytes;
        if is_small {
            self.lists = gpu.empty_buffer("narrowed invokers of tiles", usage, bytes.next_power_of_two())?;
        }
        Ok(is_small)
    }
}

impl Renderer {
    /// Makes what narrows lists ready for these, each invoker with where it may act.
    pub(super) fn prepare_narrowing(&mut self, reaches: &[layout::Reach], tiles: u32) -> Result<(), GpuError> {
        let is_new = self.narrowing.is_none();
        if is_new {
            self.narrowing = Some(Narrowing::new(&self.gpu)?);
            self.groups = None;
        }
        self.pipelines.narrowing = Some(is_new || self.pipelines.narrowing == Some(true));
        let bytes = self.buffers.tile_lists.buffer().size();
        if let Some(narrowing) = &mut self.narrowing
            && narrowing.sync(&self.gpu, reaches, bytes, tiles)?
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
            (4, whole(&narrowing.shown)),
        ];
        let lists = group(&self.gpu, "lists of tiles", &narrowing.layout, &lists);
        let slot = recorder.begin("narrow lists", "main", &[], false);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("narrow lists"),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.compute_writes(slot)),
        });
        pass.set_bind_group(0, &view, &[]);
        pass.set_bind_group(1, &lists, &[]);
        let groups = [tiles, [(tiles[0] * tiles[1]).div_ceil(TILES_PER_GROUP), 1]];
        for (pipeline, [across, down]) in narrowing.pipelines.iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(across, down, 1);
        }
        drop(pass);
        recorder.count(2, 0);
    }
}
