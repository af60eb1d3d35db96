//! Fields of lenses that bend rays, in place of outlines, on the GPU: one below the other in one texture.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

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

/// Fields of images, kept from picture to picture.
#[derive(Debug, Default)]
pub(super) struct RayMasks(Vec<(PathBuf, Arc<ShareField>)>);

impl RayMasks {
    /// Makes that of an image known, where it is not.
    ///
    /// # Errors
    /// It cannot be read, or has no light pixels.
    pub fn load(&mut self, file: &Path) -> Result<(), String> {
        if self.get(file).is_some() {
            return Ok(());
        }
        let wrong = |message: String| format!("{}: {message}", file.display());
        let image = image::open(file).map_err(|error| wrong(error.to_string()))?.into_luma8();
        let longer = f64::from(image.width().max(image.height()));
        let texel = |i: usize| {
            // Places in pixels from the image's middle; rows go from low to high y.
            let [x, y] = [i % SIDE, SIDE - 1 - i / SIDE].map(|k| ((k as f64 + 0.5) / SIDE as f64 - 0.5) * longer);
            let [x, y] = [x + 0.5 * f64::from(image.width()), y + 0.5 * f64::from(image.height())];
            x >= 0.0 && y >= 0.0 && image.get_pixel_checked(x as u32, y as u32).is_some_and(|pixel| pixel.0[0] >= 128)
        };
        let mask: Vec<bool> = (0..SIDE * SIDE).map(texel).collect();
        if !mask.contains(&true) {
            return Err(wrong("no pixel is light; light pixels are the outline".to_owned()));
        }
        self.0.push((file.to_owned(), Arc::new(ShareField::of_mask(&mask))));
        Ok(())
    }

    /// That of an image.
    pub fn get(&self, file: &Path) -> Option<Arc<ShareField>> {
        self.0.iter().find(|(of, _)| of == file).map(|(_, field)| field.clone())
    }
}
