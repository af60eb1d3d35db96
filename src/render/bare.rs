//! One lit pass over the city without anything else: what benchmarks compare frames with.

use crate::{
    gpu::Gpu,
    render::{
        cells::Details,
        city::{CityBuffers, draws_of},
        city_on_gpu::CityOnGpu,
        resource::{
            formats::PICTURE,
            key::{Draw, Key, Parts, PipelineKey, Stage, depth_test, target},
            layouts::{CITY, VIEW},
            pipelines::Pipelines,
            recording::{cleared, cleared_depth},
            targets::Targets,
            vertices,
        },
    },
    shader::Module,
    view::View,
};

/// The only one.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct BareKey;

impl PipelineKey for BareKey {
    fn name(&self) -> String {
        "bare lit draw".to_owned()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Bare,
            groups: vec![Some(&VIEW), Some(&CITY)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                buffers: vec![vertices::city()],
                targets: vec![target(PICTURE, None)],
                depth: Some(depth_test(wgpu::CompareFunction::Greater, true)),
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// Draws the city's visible chunks into the picture; `group` binds the view.
pub(super) fn draw(
    gpu: &Gpu,
    pipelines: &mut Pipelines,
    city: &CityOnGpu,
    targets: &Targets,
    group: &wgpu::BindGroup,
    view: &View,
) {
    pipelines.prepare(&Key::from(BareKey));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("bare") });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("bare"),
        color_attachments: &[Some(cleared(&targets.picture.view, wgpu::Color::WHITE))],
        depth_stencil_attachment: Some(cleared_depth(&targets.depth.view, 0.0)),
        ..Default::default()
    });
    pass.set_pipeline(pipelines.get(&BareKey));
    pass.set_bind_group(0, group, &[]);
    pass.set_bind_group(1, &city.group, &[]);
    let (frustum, whole) = (view.frustum(1.0), Details::default());
    for section in &city.buffers.sections {
        let seen = CityBuffers::visible(section.chunks.iter().filter(|c| whole.show(c)), &frustum, view.camera.eye);
        let (runs, _) = draws_of(seen.iter().map(|s| s.chunk.range.clone()));
        pass.set_vertex_buffer(0, section.vertices.slice(..));
        pass.set_index_buffer(section.indices.slice(..), wgpu::IndexFormat::Uint32);
        runs.into_iter().for_each(|run| pass.draw_indexed(run, 0, 0..1));
    }
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}
