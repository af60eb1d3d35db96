//! The passes that draw titles, captions and legends over the finished picture.

use crate::{
    gpu::GpuError,
    render::{
        frame::{FrameInput, Recorder, color_attachment},
        furniture::{FurnitureOnGpu, Over},
        key::Key,
        renderer::Renderer,
    },
};

impl Renderer {
    /// Title, caption and legends over the finished picture. Straight alpha cannot be blended by fixed function: over a
    /// transparent picture they are drawn into a layer first.
    pub(super) fn furniture_passes(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        recorder: &mut Recorder,
        input: &FrameInput,
    ) -> Result<(), GpuError> {
        let Some(targets) = &self.targets else { return Ok(()) };
        let furniture = match &mut self.furniture {
            Some(furniture) => furniture,
            none => none.insert(FurnitureOnGpu::new(&self.gpu)?),
        };
        let over = Over { whole: input.view.size, tile: input.tile, layered: input.transparent };
        let (gpu, pipelines, images) = (&self.gpu, &self.pipelines, &self.images);
        furniture.fit(gpu, pipelines, images, input.furniture, over)?;
        if furniture.counts().0 == 0 {
            return Ok(());
        }
        let slot = recorder.begin("furniture", "main", &[], true);
        let mut attachment = color_attachment(&targets.picture.view, wgpu::Color::TRANSPARENT);
        match furniture.layer() {
            Some(layer) => attachment.view = layer,
            None => attachment.ops.load = wgpu::LoadOp::Load,
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("furniture"),
            color_attachments: &[Some(attachment)],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        if let Some(timer) = &recorder.timer {
            timer.begin_count(&mut pass, slot);
        }
        furniture.draw(&mut pass, &self.gpu, &self.pipelines, &self.images, input.transparent);
        if let Some(timer) = &recorder.timer {
            timer.end_count(&mut pass, slot);
        }
        drop(pass);
        let (draws, triangles) = furniture.counts();
        recorder.count(draws, triangles);
        let Some(over) = furniture.copied(encoder, &targets.picture.texture) else { return Ok(()) };
        let slot = recorder.begin("furniture over", "main", &[], false);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("furniture over"),
            color_attachments: &[Some(color_attachment(&targets.picture.view, wgpu::Color::TRANSPARENT))],
            timestamp_writes: recorder.timer.as_ref().and_then(|t| t.render_writes(slot)),
            ..Default::default()
        });
        pass.set_pipeline(self.pipelines.get(&Key::FurnitureOver));
        pass.set_bind_group(0, over, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        recorder.count(1, 1);
        Ok(())
    }
}
