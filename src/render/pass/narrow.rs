//! Narrows the lists of invokers to what each tile shows, on the GPU, once its depth is known.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        layout,
        pass::context::{Board, FrameContext, Line, Pass, Preparing},
        plan::FramePlan,
        resource::{
            bindings::{group, whole},
            recording::{Counted, Recording},
            synced::Synced,
        },
    },
    shader::{Module, TILE_PX},
};

/// Of the depths that a tile shows: a `vec2f` for each two columns.
const SHOWN_BYTES: u64 = 16 * 8;
/// Tiles that a workgroup of `narrow` goes through.
const TILES_PER_GROUP: u32 = 8;

/// Made when a picture first has many lenses.
#[derive(Debug)]
struct Narrowing {
    /// The depths that tiles show, and what is left of their lists.
    pipelines: [wgpu::ComputePipeline; 2],
    layout: wgpu::BindGroupLayout,
    view: wgpu::BindGroupLayout,
    reaches: Synced,
    /// The narrowed lists.
    lists: wgpu::Buffer,
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

    /// Makes room for lists of so many bytes, and so many tiles.
    fn sync(&mut self, gpu: &Gpu, reaches: &[layout::Reach], bytes: u64, tiles: u32) -> Result<(), GpuError> {
        self.reaches.sync(gpu, reaches)?;
        let usage = wgpu::BufferUsages::STORAGE;
        let depths = u64::from(tiles) * SHOWN_BYTES;
        if self.shown.size() < depths {
            self.shown = gpu.empty_buffer("what tiles show", usage, depths.next_power_of_two())?;
        }
        if self.lists.size() < bytes {
            self.lists = gpu.empty_buffer("narrowed invokers of tiles", usage, bytes.next_power_of_two())?;
        }
        Ok(())
    }
}

/// What the pass keeps, once a picture had many lenses.
#[derive(Debug)]
pub struct Narrow(Option<Narrowing>);

/// Tiles across and down.
fn tiles(plan: &FramePlan) -> [u32; 2] {
    plan.input.tile.size.map(|side| side.div_ceil(TILE_PX))
}

impl Pass for Narrow {
    type Input<'a> = ();

    const LIST: &'static [Line] =
        &[("narrow lists", "per-tile lens culling: of many lenses, those that each tile shows something of")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        plan.narrows().then_some(())
    }

    fn prepare(&mut self, (): &(), stage: &mut Preparing) -> Result<(), GpuError> {
        let is_new = self.0.is_none();
        let own = match &mut self.0 {
            Some(own) => own,
            none => none.insert(Narrowing::new(stage.gpu)?),
        };
        stage.pipelines.narrowing = Some(is_new || stage.pipelines.narrowing == Some(true));
        let bytes = stage.shared.tile_lists.buffer().size();
        let plans = &stage.plan.plans;
        let [across, down] = tiles(stage.plan);
        own.sync(stage.gpu, &plans.invokers().reaches(&plans.rooms), bytes, across * down)?;
        stage.shared.bind_narrowed(&own.lists);
        Ok(())
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let Some(own) = &self.0 else { return Ok(()) };
        let FrameContext { gpu, shared, targets, .. } = *frame;
        let view = group(gpu, "view of tiles", &own.view, &[(0, whole(shared.view.buffer()))]);
        let lists = [
            (0, wgpu::BindingResource::TextureView(&targets.depth.view)),
            (1, whole(shared.tile_lists.buffer())),
            (2, whole(own.reaches.buffer())),
            (3, whole(&own.lists)),
            (4, whole(&own.shown)),
        ];
        let lists = group(gpu, "lists of tiles", &own.layout, &lists);
        let tiles = tiles(frame.plan);
        recording.compute("narrow lists", &[], |pass| {
            pass.set_bind_group(0, &view, &[]);
            pass.set_bind_group(1, &lists, &[]);
            let groups = [tiles, [(tiles[0] * tiles[1]).div_ceil(TILES_PER_GROUP), 1]];
            for (pipeline, [across, down]) in own.pipelines.iter().zip(groups) {
                pass.set_pipeline(pipeline);
                pass.dispatch_workgroups(across, down, 1);
            }
            Counted { draws: 2, triangles: 0 }
        });
        Ok(())
    }
}
