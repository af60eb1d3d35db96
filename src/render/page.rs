//! Furniture by itself: pages, on a ground of one colour, on which sheets are set; and boards, on nothing, which stand
//! in the scene.

use crate::{
    gpu::GpuError,
    lens::color::{Srgb, linear_from_srgb},
    render::{
        diagnostics,
        eye::PictureTile,
        furniture::Furniture,
        furniture_on_gpu::{FurnitureKey, FurnitureOnGpu, Over},
        images::Of,
        parts::{parts, put},
        renderer::Renderer,
        resource::{formats::PICTURE, key::Key, recording::cleared},
    },
};

impl Renderer {
    /// A page of `size` pixels, sRGB and opaque, row 0 at the top.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn page(&mut self, size: [u32; 2], ground: Srgb, furniture: &Furniture) -> Result<Vec<[u8; 4]>, GpuError> {
        diagnostics::boxes(&diagnostics::without_glyph(furniture))
            .iter()
            .for_each(|(_, message)| log::warn!("{message}"));
        let mut rgba = vec![[0; 4]; size[0] as usize * size[1] as usize];
        let mut on_gpu = FurnitureOnGpu::new(&self.gpu)?;
        let [r, g, b] = linear_from_srgb(ground).map(f64::from);
        for part in parts(size) {
            let over = Over { whole: size, tile: part.drawn, layered: false };
            let target = self.furniture_on(&mut on_gpu, furniture, over, wgpu::Color { r, g, b, a: 1.0 })?;
            let texels = self.gpu.read_texture(&target, 0, wgpu::TextureAspect::All)?;
            put(&mut rgba, size, part, bytemuck::cast_slice::<u8, [u8; 4]>(&texels));
        }
        Ok(rgba)
    }

    /// Keeps furniture on nothing as the image `number` of `size` pixels, at most those of a texture; alpha is
    /// premultiplied. Whether it was drawn: not if the image shows it already. `is_stale`: images of the furniture show
    /// something else than before.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn board(
        &mut self,
        number: u64,
        size: [u32; 2],
        furniture: &Furniture,
        is_stale: bool,
    ) -> Result<bool, GpuError> {
        let is_of = matches!(self.images.of(number), Some(Of::Furniture(own)) if own == furniture);
        if is_of && !is_stale && self.images.size(number) == Some(size) {
            return Ok(false);
        }
        let over = Over { whole: size, tile: PictureTile::whole(size), layered: false };
        let mut on_gpu = FurnitureOnGpu::new(&self.gpu)?;
        let target = self.furniture_on(&mut on_gpu, furniture, over, wgpu::Color::TRANSPARENT)?;
        self.images.copy(&self.gpu, number, &target, false);
        self.images.note(number, Of::Furniture(furniture.clone()));
        Ok(true)
    }

    /// A part of a page or a board.
    fn furniture_on(
        &mut self,
        on_gpu: &mut FurnitureOnGpu,
        furniture: &Furniture,
        over: Over,
        ground: wgpu::Color,
    ) -> Result<wgpu::Texture, GpuError> {
        for part in furniture.parts() {
            self.pipelines.prepare(&Key::from(FurnitureKey { layered: false, part }));
        }
        let [width, height] = over.tile.size;
        on_gpu.fit(&self.gpu, &self.pipelines, &self.images, furniture, over)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let target = self.gpu.texture("page", [width, height, 1], 1, PICTURE, usage);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("page"),
            color_attachments: &[Some(cleared(&view, ground))],
            ..Default::default()
        });
        on_gpu.draw(&mut pass, &self.gpu, &self.pipelines, &self.images, false);
        drop(pass);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(target)
    }
}
