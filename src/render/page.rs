//! Furniture by itself: pages, on a ground of one colour, on which sheets are set; and boards, on nothing, which stand
//! in the scene.

use crate::{
    gpu::GpuError,
    lens::color::{Srgb, linear_from_srgb, srgb_from_linear},
    render::{
        diagnostics,
        eye::PictureTile,
        furniture::{Furniture, Piece},
        furniture_on_gpu::{FurnitureKey, FurnitureOnGpu, Over},
        images::Of,
        parts::put,
        renderer::Renderer,
        resource::{formats::PICTURE, key::Key, recording::cleared},
        text::TextLine,
    },
};

/// A board without its text.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardApart {
    /// The number of its image.
    pub image: u64,
    /// Width and height of that, pixels.
    pub size: [u32; 2],
    /// Its text, in pixels of the image.
    pub texts: Vec<TextLine>,
}

/// Bytes of a pixel of a page.
const PAGE_BYTES: u64 = 8;

impl Renderer {
    /// A page of `size` pixels, sRGB and opaque, row 0 at the top.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn page(&mut self, size: [u32; 2], ground: Srgb, furniture: &Furniture) -> Result<Vec<[u8; 4]>, GpuError> {
        diagnostics::boxes(&diagnostics::without_glyph(furniture))
            .iter()
            .for_each(|(_, message)| log::warn!("{message}"));
        let [r, g, b] = linear_from_srgb(ground).map(f64::from);
        self.on(size, wgpu::Color { r, g, b, a: 1.0 }, furniture)
    }

    /// Furniture on nothing, of `size` pixels: sRGB, straight alpha, row 0 at the top.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn layer(&mut self, size: [u32; 2], furniture: &Furniture) -> Result<Vec<[u8; 4]>, GpuError> {
        let mut rgba = self.on(size, wgpu::Color::TRANSPARENT, furniture)?;
        // Light is what is multiplied by alpha.
        for pixel in rgba.iter_mut().filter(|pixel| pixel[3] != 255) {
            let [r, g, b, alpha] = pixel.map(|byte| f32::from(byte) / 255.0);
            let light = linear_from_srgb([r, g, b]).map(|c| if alpha > 0.0 { (c / alpha).min(1.0) } else { 0.0 });
            let [r, g, b] = srgb_from_linear(light).map(|c| (255.0 * c).round() as u8);
            *pixel = [r, g, b, pixel[3]];
        }
        Ok(rgba)
    }

    /// Furniture on a ground: sRGB, alpha premultiplied.
    fn on(&mut self, size: [u32; 2], ground: wgpu::Color, furniture: &Furniture) -> Result<Vec<[u8; 4]>, GpuError> {
        let mut rgba = vec![[0; 4]; size[0] as usize * size[1] as usize];
        let mut on_gpu = FurnitureOnGpu::new(&self.gpu)?;
        for part in self.tiling(PAGE_BYTES, 0).rows(size).into_iter().flatten() {
            let over = Over { whole: size, tile: part.drawn, layered: false };
            let target = self.furniture_on(&mut on_gpu, furniture, over, ground)?;
            let texels = self.gpu.read_texture(&target, 0, wgpu::TextureAspect::All)?;
            put(&mut rgba, [size[0], 0], part, bytemuck::cast_slice::<u8, [u8; 4]>(&texels));
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

    /// A board without its text, as an image of its own, and the text; `None`: it has none, or is no board. [`Self::forget_image`] when it is not needed
    /// any more.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn board_apart(&mut self, number: u64) -> Result<Option<BoardApart>, GpuError> {
        let (Some(Of::Furniture(own)), Some(size)) = (self.images.of(number), self.images.size(number)) else {
            return Ok(None);
        };
        let (mut texts, mut pieces) = (Vec::new(), Vec::new());
        for piece in &own.pieces {
            match piece {
                Piece::Text(line) => texts.push(line.clone()),
                other => pieces.push(other.clone()),
            }
        }
        if texts.is_empty() {
            return Ok(None);
        }
        // Numbers of boards count from below.
        let image = !number;
        self.board(image, size, &Furniture { pieces }, true)?;
        Ok(Some(BoardApart { image, size, texts }))
    }

    /// Forgets an image.
    pub fn forget_image(&mut self, number: u64) {
        self.images.keep(|own| own != number);
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
