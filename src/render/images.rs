//! Images that stand over pictures: those of overlays, their masks, the skins of context lines.

use std::path::{Path, PathBuf};

use image::{RgbaImage, imageops};
use rustc_hash::FxHashMap;

use crate::{
    city::{
        Texture, TextureImage, TextureOpacity, Wrap,
        texture::{Pixels, decode},
    },
    gpu::Gpu,
    render::{
        furniture::Furniture,
        parts::Part,
        resource::{
            bindings::{GroupLayout, SAMPLED, SAMPLER, group},
            formats::PICTURE,
            pipelines::Pipelines,
        },
    },
};

/// Group 1 of furniture with an image: the picture of an overlay, its mask, a sampler.
pub(super) static FURNITURE_PICTURE: GroupLayout = GroupLayout {
    label: "furniture's pictures",
    entries: &[
        (0, wgpu::ShaderStages::FRAGMENT, SAMPLED),
        (1, wgpu::ShaderStages::FRAGMENT, SAMPLED),
        (2, wgpu::ShaderStages::FRAGMENT, SAMPLER),
    ],
};

/// Images by number; straight alpha, but for those of boards.
#[derive(Debug)]
pub struct Images {
    kept: FxHashMap<u64, Image>,
    /// One opaque white texel: the mask of what has none.
    white: Option<wgpu::TextureView>,
    sampler: wgpu::Sampler,
}

/// What an image shows, where that says all of it.
#[derive(Debug, PartialEq)]
pub(super) enum Of {
    /// A file, and the size that it was asked for in.
    File(PathBuf, Option<[u32; 2]>),
    /// Furniture on nothing.
    Furniture(Furniture),
}

#[derive(Debug)]
struct Image {
    of: Option<Of>,
    size: [u32; 2],
    is_opaque: bool,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

/// An image that is drawn part by part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Whole {
    /// Its number.
    pub number: u64,
    /// Its width and height, pixels.
    pub size: [u32; 2],
    /// Whether it has no transparent pixels.
    pub is_opaque: bool,
}

impl Images {
    /// None.
    pub fn new(gpu: &Gpu) -> Self {
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("images"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { kept: FxHashMap::default(), white: None, sampler }
    }

    /// The size of an image; `None`: there is none with this number.
    pub fn size(&self, number: u64) -> Option<[u32; 2]> {
        self.kept.get(&number).map(|image| image.size)
    }

    /// Whether there is such an image, and all of it has an alpha of one.
    pub(super) fn is_opaque(&self, number: u64) -> bool {
        self.kept.get(&number).is_some_and(|image| image.is_opaque)
    }

    /// Forgets images.
    pub fn keep(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.kept.retain(|number, _| is_kept(*number));
    }

    /// Keeps sRGB texels, row 0 at the top.
    pub fn set(&mut self, gpu: &Gpu, number: u64, size: [u32; 2], rgba: &[[u8; 4]]) {
        let texture = self.fitted(gpu, number, size, rgba.iter().all(|texel| texel[3] == 255));
        gpu.write_texture_level(&texture, 0, bytemuck::cast_slice(rgba));
        self.white(gpu);
    }

    /// Keeps what a target shows, which has transparent pixels or none.
    pub fn copy(&mut self, gpu: &Gpu, number: u64, picture: &wgpu::Texture, is_opaque: bool) {
        let size = [picture.width(), picture.height()];
        let texture = self.fitted(gpu, number, size, is_opaque);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_texture(picture.as_image_copy(), texture.as_image_copy(), picture.size());
        gpu.queue.submit([encoder.finish()]);
        self.white(gpu);
    }

    /// Keeps what a target shows of a part of an image.
    pub(super) fn copy_part(&mut self, gpu: &Gpu, image: Whole, picture: &wgpu::Texture, part: Part) {
        let texture = self.fitted(gpu, image.number, image.size, image.is_opaque);
        let from: [u32; 2] = std::array::from_fn(|i| part.kept.origin[i] - part.drawn.origin[i]);
        let [width, height] = part.kept.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_texture(place_in(picture, from), place_in(&texture, part.kept.origin), size);
        gpu.queue.submit([encoder.finish()]);
        self.white(gpu);
    }

    /// Keeps the image of a file: as large as it is, or filling `size`, cut where its shape is another. Whether it was read.
    ///
    /// # Errors
    /// Why the file cannot be read.
    pub fn of_file(&mut self, gpu: &Gpu, number: u64, file: &Path, size: Option<[u32; 2]>) -> Result<bool, String> {
        let of = Of::File(file.to_owned(), size);
        if self.of(number) == Some(&of) {
            return Ok(false);
        }
        let pixels = decode(&Texture {
            image: TextureImage::File(file.to_owned()),
            wrap: [Wrap::Repeat; 2],
            opacity: TextureOpacity::Own,
        })?;
        let (size_made, texels) = match size {
            None => ([pixels.width, pixels.height], pixels.levels.into_iter().next().unwrap_or_default()),
            Some(size) => (size, filling(&pixels, size)),
        };
        self.set(gpu, number, size_made, texels.as_chunks().0);
        self.note(number, of);
        Ok(true)
    }

    /// What an image shows, where that was noted.
    pub(super) fn of(&self, number: u64) -> Option<&Of> {
        self.kept.get(&number)?.of.as_ref()
    }

    /// Notes what an image shows from now on, until it is another.
    pub(super) fn note(&mut self, number: u64, of: Of) {
        if let Some(image) = self.kept.get_mut(&number) {
            image.of = Some(of);
        }
    }

    fn fitted(&mut self, gpu: &Gpu, number: u64, size: [u32; 2], is_opaque: bool) -> wgpu::Texture {
        use wgpu::TextureUsages as U;
        if let Some(image) = self.kept.get_mut(&number).filter(|image| image.size == size) {
            (image.of, image.is_opaque) = (None, is_opaque);
            return image.texture.clone();
        }
        let texture = gpu.texture("image", [size[0], size[1], 1], 1, PICTURE, U::TEXTURE_BINDING | U::COPY_DST);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.kept.insert(number, Image { of: None, size, is_opaque, texture: texture.clone(), view });
        texture
    }

    fn white(&mut self, gpu: &Gpu) {
        self.white.get_or_insert_with(|| {
            use wgpu::TextureUsages as U;
            let texture = gpu.texture("white", [1, 1, 1], 1, PICTURE, U::TEXTURE_BINDING | U::COPY_DST);
            gpu.write_texture_level(&texture, 0, &[255; 4]);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        });
    }

    /// What binds an image and its mask; `None`: one of them is missing.
    pub(super) fn group(
        &self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        image: u64,
        mask: Option<u64>,
    ) -> Option<wgpu::BindGroup> {
        use wgpu::BindingResource as R;
        let image = &self.kept.get(&image)?.view;
        let mask = match mask {
            None => self.white.as_ref()?,
            Some(mask) => &self.kept.get(&mask)?.view,
        };
        let entries = [(0, R::TextureView(image)), (1, R::TextureView(mask)), (2, R::Sampler(&self.sampler))];
        Some(group(gpu, "image over the picture", &pipelines.layout(&FURNITURE_PICTURE), &entries))
    }
}

/// A place in a texture, pixels from its top left.
fn place_in(texture: &wgpu::Texture, [x, y]: [u32; 2]) -> wgpu::TexelCopyTextureInfo<'_> {
    wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x, y, z: 0 }, ..texture.as_image_copy() }
}

/// An image that fills `size`, its middle where its shape is another; from the level that is just finer.
fn filling(pixels: &Pixels, size: [u32; 2]) -> Vec<u8> {
    let scale = |level: usize| {
        let own = pixels.size(level);
        (f64::from(own[0]) / f64::from(size[0])).min(f64::from(own[1]) / f64::from(size[1]))
    };
    let level = (0..pixels.levels.len()).rev().find(|&level| scale(level) >= 1.0).unwrap_or(0);
    let [width, height] = pixels.size(level);
    let Some(image) = RgbaImage::from_raw(width, height, pixels.levels[level].clone()) else { return Vec::new() };
    let scale = scale(level);
    let wanted: [u32; 2] =
        std::array::from_fn(|i| ((f64::from(size[i]) * scale).round() as u32).clamp(1, [width, height][i]));
    let cut = imageops::crop_imm(&image, (width - wanted[0]) / 2, (height - wanted[1]) / 2, wanted[0], wanted[1]);
    imageops::resize(&cut.to_image(), size[0], size[1], imageops::FilterType::CatmullRom).into_raw()
}
