//! Fields of lenses that bend rays, in place of outlines, on the GPU: one below the other in one texture.

use crate::{
    gpu::Gpu,
    lens::share_field::{SIDE, ShareField},
};

/// The texture, and what it holds.
#[derive(Debug)]
pub(super) struct RayFields {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    held: Vec<f32>,
}

impl RayFields {
    /// One texel.
    pub fn new(gpu: &Gpu) -> Self {
        Self::of_size(gpu, [1, 1])
    }

    fn of_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let texture = gpu.texture("fields of rays", [width, height, 1], 1, wgpu::TextureFormat::R32Float, usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view, held: Vec::new() }
    }

    /// Makes it hold these; `true`: it is another texture now.
    pub fn fit(&mut self, gpu: &Gpu, fields: &[&ShareField]) -> bool {
        if fields.is_empty() {
            return false;
        }
        let all = || fields.iter().flat_map(|field| &field.texels);
        if self.held.len() == fields.len() * SIDE * SIDE && self.held.iter().zip(all()).all(|(a, b)| a == b) {
            return false;
        }
        let size = [SIDE as u32, (fields.len() * SIDE) as u32];
        let is_other = [self.texture.width(), self.texture.height()] != size;
        if is_other {
            *self = Self::of_size(gpu, size);
        }
        self.held = all().copied().collect();
        gpu.write_texture_level(&self.texture, 0, bytemuck::cast_slice(&self.held));
        is_other
    }
}
