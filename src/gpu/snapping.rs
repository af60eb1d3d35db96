//! How far a rasteriser moves the corners of triangles, measured: GPUs put them on a grid of 1/256 pixel, some software adapters on
//! one of 1/16, and make coverage and depth of what stands there.
//!
//! An adapter may also cover pixels by corners on a grid and make depth of corners in their places. Then thin triangles have depths that none
//! of their places has.
//!
//! What is moved within the picture by δ pixels is off along the normal of its face by no more than δ times the width of a pixel at its
//! distance, however steep the face is.

use super::{Gpu, GpuError};

/// Cells in a row of the picture that is drawn, and rows.
const CELLS: u32 = 64;
/// Pixels along the side of each.
const CELL: u32 = 4;
/// The depth in the middle of pixel (1, 1) of every cell, where corners stay in their places.
const DEPTH: f64 = 0.125 + 1.5 / 16.0;
/// How much depth grows from pixel to pixel.
const SLOPE: f64 = 1.0 / 16.0;
/// What f32 rounds while depth is interpolated, pixels; grids that are as fine do not matter.
const EXACT: f64 = 1.0 / 8192.0;

/// The depths of a sliver, and what f32 may round them by.
const SLIVER: std::ops::RangeInclusive<f32> = 0.249..=0.501;

/// How far from its place a corner may be drawn at most, pixels; 0 where depth is made of corners that have not been moved. And whether depths
/// of thin triangles leave those of their corners.
pub(super) fn measured(gpu: &Gpu) -> Result<(f64, bool), GpuError> {
    let moved = of_depths(&drawn(gpu, "vertex")?);
    let strays = drawn(gpu, "sliver")?.iter().any(|depth| *depth != 0.0 && !SLIVER.contains(depth));
    Ok((moved, strays))
}

/// The depths of the cells, each with what an entry point of the vertex shader makes.
fn drawn(gpu: &Gpu, entry: &str) -> Result<Vec<f32>, GpuError> {
    let target = gpu.texture(
        "snapping",
        [CELLS * CELL, CELLS * CELL, 1],
        1,
        wgpu::TextureFormat::Depth32Float,
        wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
    );
    gpu.guarded(|| {
        draw(gpu, &target.create_view(&wgpu::TextureViewDescriptor::default()), entry);
        Ok(())
    })?;
    let bytes = gpu.read_texture(&target, 0, wgpu::TextureAspect::DepthOnly)?;
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

fn draw(gpu: &Gpu, target: &wgpu::TextureView, entry: &str) {
    let module = gpu.device.create_shader_module(wgpu::include_wgsl!("../../shaders/pass/snapping.wgsl"));
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("snapping"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("snapping"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: target,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.draw(0..3, 0..CELLS * CELLS);
    }
    gpu.queue.submit([encoder.finish()]);
}

/// The same from the depths of the picture. Corners are moved along both axes.
fn of_depths(depths: &[f32]) -> f64 {
    let row = (CELLS * CELL) as usize;
    let middles =
        depths.chunks(row).skip(1).step_by(CELL as usize).flat_map(|r| r.iter().skip(1).step_by(CELL as usize));
    let most = middles.map(|depth| (f64::from(*depth) - DEPTH).abs() / SLOPE).fold(0.0, f64::max);
    if most <= EXACT {
        return 0.0;
    }
    // Grids are powers of two; what was seen is a little less than half of one, or a whole one.
    std::f64::consts::SQRT_2 * (most.log2() - 0.02).ceil().exp2().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The picture of a rasteriser that moves corners with `moved`, pixels.
    fn picture(moved: impl Fn(f64) -> f64) -> Vec<f32> {
        let row = CELLS * CELL;
        let mut depths = vec![0.0; (row * row) as usize];
        for cell in 0..CELLS * CELLS {
            let shift = f64::from(cell) / 16384.0;
            // All three by as much: their places without the shift are on every grid.
            let depth = DEPTH - SLOPE * (moved(0.25 + shift) - (0.25 + shift));
            depths[(row * (CELL * (cell / CELLS) + 1) + CELL * (cell % CELLS) + 1) as usize] = depth as f32;
        }
        depths
    }

    #[test]
    fn grids_are_found_whatever_way_corners_are_moved_to_them() {
        let root = std::f64::consts::SQRT_2;
        assert_eq!(of_depths(&picture(|x| x)), 0.0);
        for bits in [4, 6, 8, 10] {
            let steps = f64::from(1 << bits);
            let [near, below] = [
                of_depths(&picture(|x| (x * steps).round() / steps)),
                of_depths(&picture(|x| (x * steps).floor() / steps)),
            ];
            assert_eq!(near, 0.5 * root / steps, "{bits} bits");
            assert_eq!(below, root / steps, "{bits} bits, cut off");
        }
    }

    #[test]
    fn an_adapter_says_where_it_draws_corners() {
        let gpu = Gpu::open().expect("an adapter");
        let (snapping, strays) = measured(&gpu).expect("a picture");
        assert_eq!((snapping, strays), (gpu.snapping, gpu.strays));
        // Four bits are the least that Vulkan, Metal and Direct3D allow.
        assert!((0.0..=root_of_a_half() / 8.0).contains(&snapping), "{snapping}");
        if gpu.name().contains("llvmpipe") {
            assert_eq!((snapping, strays), (0.0, true));
        }
    }

    fn root_of_a_half() -> f64 {
        std::f64::consts::FRAC_1_SQRT_2
    }
}
