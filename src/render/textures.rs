//! Textures on the GPU: only those that shown surfaces use, each once, with all mip levels.

use rayon::prelude::*;

use crate::{
    city::{Texture, Wrap, texture},
    gpu::{Gpu, GpuError},
    render::city::Shown,
};

/// Bytes of textures a city may put on the GPU before the rest is drawn in plain colours.
const BUDGET: u64 = 2 << 30;

/// Textures by their number in the model.
#[derive(Debug, Default)]
pub struct Textures {
    entries: Vec<Option<(wgpu::TextureView, wgpu::Sampler)>>,
    /// Which of them have texels that are not opaque.
    translucent: Vec<bool>,
    bytes: u64,
}

impl Textures {
    /// No textures.
    pub fn none() -> Self {
        Self { entries: Vec::new(), translucent: Vec::new(), bytes: 0 }
    }

    /// Decodes and uploads what the shown surfaces use; what cannot be read stays absent.
    pub fn new(gpu: &Gpu, shown: &Shown) -> Result<Self, GpuError> {
        let model = shown.model;
        let mut used = vec![false; model.textures.len()];
        for &g in shown.geometries {
            for tile in &model.tiles
                [model.geometries[g as usize].tiles.start as usize..model.geometries[g as usize].tiles.end as usize]
            {
                if tile.texcoords == crate::city::NONE {
                    continue;
                }
                for vertex in &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize] {
                    let surface = model.surfaces.get(vertex.surface as usize);
                    let material = surface.and_then(|s| model.materials.get(s.material as usize));
                    if let Some(flag) = material.and_then(|m| used.get_mut(m.texture as usize)) {
                        *flag = true;
                    }
                }
            }
        }
        let before = gpu.allocated_bytes();
        let mut entries: Vec<Option<(wgpu::TextureView, wgpu::Sampler)>> = Vec::new();
        entries.resize_with(used.len(), || None);
        let mut translucent = vec![false; used.len()];
        let wanted: Vec<usize> = (0..used.len()).filter(|&i| used[i]).collect();
        // A few at a time, so that decoded images do not pile up.
        for group in wanted.chunks(16) {
            let decoded: Vec<_> = group.par_iter().map(|&i| texture::decode(&model.textures[i])).collect();
            for (&i, result) in group.iter().zip(decoded) {
                match result {
                    Ok(_) if gpu.allocated_bytes() - before > BUDGET => {
                        log::warn!("textures beyond {} MiB are drawn in plain colours", BUDGET >> 20);
                    }
                    Ok(pixels) => {
                        translucent[i] = pixels.is_translucent();
                        entries[i] = Some(upload(gpu, &pixels, &model.textures[i]));
                    }
                    // Whoever loaded the city has said this, for all of them at once.
                    Err(_) if model.textures[i].image.is_missing() => {}
                    Err(message) => log::warn!("texture {i}: {message}"),
                }
            }
        }
        Ok(Self { entries, translucent, bytes: gpu.allocated_bytes() - before })
    }

    /// Whether a texture is there.
    pub fn has(&self, number: u32) -> bool {
        self.get(number).is_some()
    }

    /// Whether a texture has texels that are not opaque.
    pub fn is_translucent(&self, number: u32) -> bool {
        self.translucent.get(number as usize) == Some(&true)
    }

    /// A texture and how it is sampled.
    pub fn get(&self, number: u32) -> Option<&(wgpu::TextureView, wgpu::Sampler)> {
        self.entries.get(number as usize)?.as_ref()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn upload(gpu: &Gpu, pixels: &texture::Pixels, declared: &Texture) -> (wgpu::TextureView, wgpu::Sampler) {
    let size = [pixels.width, pixels.height, 1];
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    // Kept as sRGB bytes: the geometry target holds sRGB too, so no precision is lost on the way.
    let texture = gpu.texture("city texture", size, pixels.levels.len() as u32, wgpu::TextureFormat::Rgba8Unorm, usage);
    for (level, rgba) in pixels.levels.iter().enumerate() {
        gpu.write_texture_level(&texture, level as u32, rgba);
    }
    let mode = |wrap: Wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("city texture"),
        address_mode_u: mode(declared.wrap[0]),
        address_mode_v: mode(declared.wrap[1]),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: 8,
        ..Default::default()
    });
    (texture.create_view(&wgpu::TextureViewDescriptor::default()), sampler)
}
