//! Passes that shade translucent fragments where they are drawn: all that found no slot as one layer (`lib/tail.wgsl`), and layers
//! that are there by chance (`lib/chance.wgsl`).

use crate::render::{
    eye::PictureTile,
    frame::{FrameInput, Recorder, color_attachment, read_depth, scissor},
    layers::LayerDraw,
    layout,
    renderer::{Renderer, STAGE_STRIDE, all_of, group, one_of, whole},
    transparency::{FragmentPass, SlotKeys},
};

impl Renderer {
    /// What found no slot in a band, `at` its place among the bands, as one layer.
    pub(super) fn tail_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        (draw, keys, [slots, bands]): (&LayerDraw, SlotKeys, [wgpu::BindingResource; 2]),
        (at, band): (usize, PictureTile),
    ) {
        let (Some(targets), Some(groups)) = (&self.targets, &self.groups) else { return };
        let entries = [
            (0, whole(self.buffers.view.buffer())),
            (2, slots),
            (4, bands),
            (5, one_of::<layout::City>(&self.buffers.cities)),
        ];
        let layouts = &self.pipelines.layouts;
        let view = group(&self.gpu, "fragments", &layouts.forward, &entries);
        let early = self.gpu.tests_depth_early();
        let slot = recorder.begin(FragmentPass::Tail.name(), "main", &draw.cut.hiding.lenses, true);
        let mut sums = color_attachment(&targets.tail_sums.view, wgpu::Color::TRANSPARENT);
        let mut through = color_attachment(&targets.tail_through.view, wgpu::Color::WHITE);
        if at > 0 {
            (sums.ops.load, through.ops.load) = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(FragmentPass::Tail.name()),
            color_attachments: &[Some(sums), Some(through)],
            depth_stencil_attachment: Some(read_depth(&targets.depth.view)),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        scissor(&mut pass, band);
        pass.set_bind_group(1, &groups.shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        let (draws, triangles) = self.draw_reached(
            &mut pass,
            input,
            draw.cut,
            |kind, [is_smooth, _]| draw.keys.translucent_key(keys, (kind.into(), is_smooth), FragmentPass::Tail, early),
            |pass, offset| pass.set_bind_group(0, &view, &[(at as u64 * STAGE_STRIDE) as u32, offset]),
        );
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(draws, triangles);
    }

    /// Layers that are there by chance, into the targets of what is opaque.
    pub(in crate::render) fn chance_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
        draw: &LayerDraw,
    ) {
        let (Some(targets), Some(groups), Some(forward)) = (&self.targets, &self.groups, &draw.keys.forward) else {
            return;
        };
        let layouts = &self.pipelines.layouts;
        let no_band = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffers.view.buffer(),
            offset: 0,
            size: wgpu::BufferSize::new(16),
        });
        // What is drawn into cannot be read.
        let entries = [
            (0, whole(self.buffers.view.buffer())),
            (2, whole(self.buffers.object_values.buffer())),
            (4, no_band),
            (5, one_of::<layout::City>(&self.buffers.cities)),
        ];
        let view = group(&self.gpu, "fragments", &layouts.forward, &entries);
        let Some(shade) = self.shade_without_targets() else { return };
        let slot = recorder.begin(FragmentPass::Chance.name(), "main", &draw.cut.hiding.lenses, true);
        let of_targets = [
            Some(&targets.codes),
            forward.colored.then_some(&targets.colors),
            forward.measured.then_some(&targets.own_depth),
        ];
        let colors = of_targets.map(|target| {
            let mut attachment = color_attachment(&target?.view, wgpu::Color::TRANSPARENT);
            attachment.ops.load = wgpu::LoadOp::Load;
            Some(attachment)
        });
        let count = if forward.measured { 3 } else { 1 + usize::from(forward.colored) };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(FragmentPass::Chance.name()),
            color_attachments: &colors[..count],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        pass.set_bind_group(1, &shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        let keys = SlotKeys::NONE;
        let (draws, triangles) = self.draw_reached(
            &mut pass,
            input,
            draw.cut,
            |kind, [is_smooth, _]| {
                draw.keys.translucent_key(keys, (kind.into(), is_smooth), FragmentPass::Chance, false)
            },
            |pass, offset| pass.set_bind_group(0, &view, &[0, offset]),
        );
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        recorder.count(draws, triangles);
    }

    /// What shading binds, but for the targets that are drawn into.
    fn shade_without_targets(&self) -> Option<wgpu::BindGroup> {
        let (targets, city, b) = (self.targets.as_ref()?, self.city.as_ref()?, &self.buffers);
        let surfaces = || {
            let all = self.contents.surfaces.as_ref().unwrap_or(&city.buffers.surfaces);
            wgpu::BindingResource::TextureView(all)
        };
        let entries = [
            (0, surfaces()),
            (1, whole(b.planes.buffer())),
            (2, whole(b.solids.buffer())),
            (3, whole(b.light.buffer())),
            (4, all_of(&targets.shadow)),
            (5, wgpu::BindingResource::Sampler(&self.shadow_sampler)),
            (6, surfaces()),
            (7, all_of(&targets.shadow)),
            (8, all_of(&targets.veil)),
        ];
        Some(group(&self.gpu, "shade without targets", &self.pipelines.layouts.shade, &entries))
    }
}
