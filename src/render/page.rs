//! A page: furniture on a ground of one colour, without a city. Sheets are set on one.

use crate::{
    gpu::GpuError,
    lens::color::{Srgb, linear_from_srgb},
    render::{
        frame::color_attachment,
        furniture::{Furniture, FurnitureOnGpu, Over},
        key::Key,
        parts::{parts, put},
        pipelines::PICTURE,
        renderer::Renderer,
        told,
    },
};

impl Renderer {
    /// A page of `size` pixels, sRGB and opaque, row 0 at the top.
    ///
    /// # Errors
    /// Those of the graphics card.
    pub fn page(&mut self, size: [u32; 2], ground: Srgb, furniture: &Furniture) -> Result<Vec<[u8; 4]>, GpuError> {
        told::boxes(&told::without_glyph(furniture)).iter().for_each(|(_, message)| log::warn!("{message}"));
        for part in furniture.parts() {
            self.pipelines.prepare(&Key::Furniture { layered: false, part });
        }
        let mut rgba = vec![[0; 4]; size[0] as usize * size[1] as usize];
        let mut on_gpu = FurnitureOnGpu::new(&self.gpu)?;
        let [r, g, b] = linear_from_srgb(ground).map(f64::from);
        for part in parts(size) {
            let [width, height] = part.drawn.size;
            let over = Over { whole: size, tile: part.drawn, layered: false };
            on_gpu.fit(&self.gpu, &self.pipelines, &self.images, furniture, over)?;
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
            let target = self.gpu.texture("page", [width, height, 1], 1, PICTURE, usage);
            let view = target.create_view(&wgpu::TextureViewDescriptor::default());
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("page"),
                color_attachments: &[Some(color_attachment(&view, wgpu::Color { r, g, b, a: 1.0 }))],
                ..Default::default()
            });
            on_gpu.draw(&mut pass, &self.gpu, &self.pipelines, &self.images, false);
            drop(pass);
            self.gpu.queue.submit([encoder.finish()]);
            let texels = self.gpu.read_texture(&target, 0, wgpu::TextureAspect::All)?;
            put(&mut rgba, size, part, bytemuck::cast_slice::<u8, [u8; 4]>(&texels));
        }
        Ok(rgba)
    }
}
