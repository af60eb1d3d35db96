//! Ordered dithering on the GPU against its twin on the CPU, to the bit.

use veduta::{gpu::Gpu, lens::dither::dither};

/// Pixels of a side, and samples, of the kernel below.
const SIDE: u32 = 64;
const SAMPLES: u32 = 8;

const KERNEL: &str = "
struct View { first_pixel: u32 }
var<private> view: View;
@group(0) @binding(0) var<storage, read_write> out: array<f32>;

@compute @workgroup_size(8, 8, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    view.first_pixel = FIRST;
    out[(id.z * 64u + id.y) * 64u + id.x] = dither(vec2i(id.xy), id.z);
}
";

/// The thresholds of the pixels of a target whose first pixel is this one of the picture.
fn on_the_gpu(gpu: &Gpu, first: [u32; 2]) -> Vec<f32> {
    let source = include_str!("../../shaders/lib/dither.wgsl").to_owned()
        + &KERNEL.replace("FIRST", &format!("{}u", first[0] | first[1] << 16));
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let out = gpu.empty_buffer("thresholds", usage, u64::from(SIDE * SIDE * SAMPLES) * 4).expect("room");
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: out.as_entire_binding() }],
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(SIDE / 8, SIDE / 8, SAMPLES);
    }
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(&out).expect("the thresholds"))
}

#[test]
fn the_gpu_has_the_thresholds_of_the_twin_whatever_part_of_a_picture_is_drawn() {
    let gpu = Gpu::open().expect("an adapter");
    for first in [[0, 0], [3976, 0], [12_000, 65_535 - SIDE]] {
        let found = on_the_gpu(&gpu, first);
        let pixels = (0..SAMPLES).flat_map(|s| (0..SIDE).flat_map(move |y| (0..SIDE).map(move |x| ([x, y], s))));
        for (([x, y], sample), found) in pixels.zip(found) {
            let wanted = dither([first[0] + x, first[1] + y], sample);
            assert!(found.to_bits() == wanted.to_bits(), "{x} {y} of {first:?}, sample {sample}: {found}, {wanted}");
            assert!(0.0 < found && found < 1.0);
        }
    }
}
