//! A bench for the tests: triangles into depth, edges over it, coverage back.

use glam::{DVec2, DVec3};

use super::{Edge, EdgeBuffers, VERTICES};
use crate::{
    city::{CityModel, edges::CreaseAngles},
    gpu::Gpu,
    render::{
        city::{CityBuffers, Shown},
        eye::{PictureTile, view_uniform},
        layout::CityVertex,
    },
    view::View,
};

/// What the tests add to `lib/view.wgsl`, `lib/surface.wgsl` and `lib/edge.wgsl`.
const ENTRIES: &str = "
override WIDTH: f32 = 1.0;

@vertex fn solid(@location(0) origin: vec3i, @location(2) position: vec3f) -> @builtin(position) vec4f {
    return clip_from_relative(relative_to_eye(origin, position));
}

struct Line {
    @builtin(position) clip: vec4f,
    @location(0) line: vec3f,
    @location(1) @interpolate(flat, either) ends: vec4f,
    @location(2) @interpolate(flat, either) face_a: vec4f,
    @location(3) @interpolate(flat, either) face_b: vec4f,
    @location(4) @interpolate(flat, either) along: vec4f,
}

@vertex fn line(edge: Edge, @builtin(vertex_index) i: u32) -> Line {
    let made = edge_vertex(edge, i, WIDTH);
    return Line(made.clip, made.line, made.ends, made.face_a, made.face_b, made.along);
}

struct Pixel {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment fn coverage(in: Line) -> Pixel {
    return Pixel(vec4f(edge_coverage(in.line, WIDTH)), edge_depth(in.line, in.ends, in.face_a, in.face_b, in.along));
}

struct Segment { p: vec3f, q: vec3f, guard: vec2f }
@group(0) @binding(1) var<storage, read> segments: array<Segment>;
@group(0) @binding(2) var<storage, read_write> parts: array<vec2f>;

@compute @workgroup_size(64) fn clip(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&parts) {
        parts[id.x] = edge_part(segments[id.x].p, segments[id.x].q, segments[id.x].guard);
    }
}
";

/// The whole module for an adapter that moves corners so far, pixels.
pub fn source(snapping: f64) -> String {
    let view = include_str!("../../../shaders/lib/view.wgsl");
    let snapping = format!("const SNAPPING: f32 = {:?};", snapping as f32);
    [
        &view.replace("//@snapping", &snapping),
        include_str!("../../../shaders/lib/view-uniform.wgsl"),
        include_str!("../../../shaders/lib/surface.wgsl"),
        include_str!("../../../shaders/lib/one-city.wgsl"),
        include_str!("../../../shaders/lib/edge.wgsl"),
        ENTRIES,
    ]
    .concat()
}

/// A city on an adapter.
pub struct Bench {
    pub gpu: Gpu,
    pub model: CityModel,
    pub city: CityBuffers,
    pub edges: EdgeBuffers,
    /// The instances again.
    pub all: Vec<Edge>,
}

/// How lines and solids meet.
#[derive(Clone, Copy, PartialEq)]
pub enum Solids {
    Hide,
    Absent,
}

impl Bench {
    pub fn new(model: CityModel) -> Self {
        let gpu = Gpu::open().expect("an adapter");
        let geometries: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let shown = Shown::of(&model, &geometries);
        let city = CityBuffers::new(&gpu, &shown, None).expect("a city");
        let edges = EdgeBuffers::new(&gpu, &shown, &city, &CreaseAngles::default()).expect("edges");
        let all = super::gather(&shown, &city, &CreaseAngles::default());
        Self { gpu, city, edges, all, model }
    }

    fn uniform(&self, view: &View) -> wgpu::Buffer {
        let uniform = view_uniform(view, PictureTile::whole(view.size), DVec2::ZERO, 0, 0.0);
        self.gpu.buffer("view", wgpu::BufferUsages::UNIFORM, &[uniform]).expect("a buffer")
    }

    fn module(&self) -> wgpu::ShaderModule {
        let source = wgpu::ShaderSource::Wgsl(source(self.gpu.snapping).into());
        self.gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source })
    }

    fn pipeline(
        &self,
        entry: &str,
        buffer: wgpu::VertexBufferLayout<'_>,
        solids: Solids,
        width: f64,
    ) -> wgpu::RenderPipeline {
        let module = self.module();
        let is_line = entry == "line";
        let widest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let constants = [("WIDTH", width)];
        let options = wgpu::PipelineCompilationOptions {
            constants: if is_line { &constants } else { &[] },
            ..Default::default()
        };
        let test = match (is_line, solids) {
            (true, Solids::Absent) => wgpu::CompareFunction::Always,
            _ => wgpu::CompareFunction::Greater,
        };
        let topology =
            if is_line { wgpu::PrimitiveTopology::TriangleStrip } else { wgpu::PrimitiveTopology::TriangleList };
        self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: options.clone(),
                buffers: &[Some(buffer)],
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(!is_line),
                depth_compare: Some(test),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: is_line.then_some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("coverage"),
                compilation_options: options,
                targets: &[Some(wgpu::ColorTargetState {
                    format: wgpu::TextureFormat::Rgba8Unorm,
                    blend: Some(wgpu::BlendState { color: widest, alpha: widest }),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// How much of each pixel lines cover, 0..1, row by row.
    pub fn draw(&self, view: &View, width: f64, solids: Solids) -> Vec<f64> {
        use wgpu::TextureUsages as T;
        let [w, h] = view.size;
        let gpu = &self.gpu;
        let target =
            gpu.texture("lines", [w, h, 1], 1, wgpu::TextureFormat::Rgba8Unorm, T::RENDER_ATTACHMENT | T::COPY_SRC);
        let depth = gpu.texture("depth", [w, h, 1], 1, wgpu::TextureFormat::Depth32Float, T::RENDER_ATTACHMENT);
        let (target_view, depth_view) =
            (target.create_view(&Default::default()), depth.create_view(&Default::default()));
        let attributes = wgpu::vertex_attr_array![0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32];
        let vertices = wgpu::VertexBufferLayout {
            array_stride: size_of::<CityVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let solid = self.pipeline("solid", vertices, solids, width);
        let line = self.pipeline("line", Edge::LAYOUT, solids, width);
        let uniform = self.uniform(view);
        let group = |pipeline: &wgpu::RenderPipeline| {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
            })
        };
        let (solid_group, line_group) = (group(&solid), group(&line));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let attachment = |load| wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(attachment(wgpu::LoadOp::Clear(0.0))),
            ..Default::default()
        });
        if solids == Solids::Hide {
            pass.set_pipeline(&solid);
            pass.set_bind_group(0, &solid_group, &[]);
            for section in &self.city.sections {
                pass.set_vertex_buffer(0, section.vertices.slice(..));
                pass.set_index_buffer(section.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..section.chunks.last().map_or(0, |c| c.range.end), 0, 0..1);
            }
        }
        drop(pass);
        let color = wgpu::RenderPassColorAttachment {
            view: &target_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(attachment(wgpu::LoadOp::Load)),
            ..Default::default()
        });
        pass.set_pipeline(&line);
        pass.set_bind_group(0, &line_group, &[]);
        pass.set_vertex_buffer(0, self.edges.instances.slice(..));
        for draw in self.edges.visible(&view.frustum(2.0), |_| true) {
            pass.draw(0..VERTICES, draw);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        let texels = gpu.read_texture(&target, 0, wgpu::TextureAspect::All).expect("a picture");
        texels.chunks_exact(4).map(|t| f64::from(t[0]) / 255.0).collect()
    }

    /// `edge_part` of segments in view space, by the GPU.
    pub fn parts(&self, view: &View, segments: &[[DVec3; 2]], guard: DVec2) -> Vec<[f64; 2]> {
        use wgpu::BufferUsages as U;
        let gpu = &self.gpu;
        // p, pad, q, pad, guard, pad: the WGSL layout of `Segment`.
        let guard = guard.as_vec2();
        let packed: Vec<[f32; 12]> = segments
            .iter()
            .map(|s| {
                let [p, q] = s.map(|p| p.as_vec3());
                [p.x, p.y, p.z, 0.0, q.x, q.y, q.z, 0.0, guard.x, guard.y, 0.0, 0.0]
            })
            .collect();
        let input = gpu.buffer("segments", U::STORAGE, &packed).expect("a buffer");
        let output = gpu.empty_buffer("parts", U::STORAGE | U::COPY_SRC, 8 * segments.len() as u64).expect("a buffer");
        let module = self.module();
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("clip"),
            compilation_options: Default::default(),
            cache: None,
        });
        let uniform = self.uniform(view);
        let bound = [&uniform, &input, &output];
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        let layout = pipeline.get_bind_group_layout(0);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((segments.len() as u32).div_ceil(64), 1, 1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.read_buffer(&output).expect("parts");
        bytemuck::cast_slice::<u8, [f32; 2]>(&bytes)[..segments.len()].iter().map(|p| p.map(f64::from)).collect()
    }
}
