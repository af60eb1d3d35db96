//! Textures on the GPU: only those that shown surfaces use, each once, with all mip levels.

use rayon::prelude::*;

use crate::{
    city::{Texture, Wrap, texture},
    gpu::{Gpu, GpuError},
    render::city::Shown,
};

/// Bytes that the textures of a city take on the GPU at most: where they would take more, the largest are halved.
const BUDGET: u64 = 2 << 30;
/// Bytes of images that are decoded at a time.
const AT_A_TIME: u64 = 512 << 20;
/// What is not halved any more, pixels.
const LEAST_SIDE: u32 = 16;

/// Textures by their number in the model.
#[derive(Debug, Default)]
pub struct Textures {
    entries: Vec<Option<SampledTexture>>,
    /// Which of them have texels that are not opaque.
    translucent: Vec<bool>,
    /// One white texel, where there is some texture, or what is drawn as if it had one.
    white: Option<SampledTexture>,
    bytes: u64,
}

impl Textures {
    /// No textures.
    pub fn none() -> Self {
        Self { entries: Vec::new(), translucent: Vec::new(), white: None, bytes: 0 }
    }

    /// Decodes and uploads what the shown surfaces use; what cannot be read stays absent.
    pub fn new(gpu: &Gpu, shown: &Shown) -> Result<Self, GpuError> {
        let model = shown.model;
        let mut used = vec![false; model.textures.len()];
        let mut has_normals = vec![false; model.textures.len()];
        for &g in shown.geometries {
            for tile in &model.tiles
                [model.geometries[g as usize].tiles.start as usize..model.geometries[g as usize].tiles.end as usize]
            {
                if tile.texcoords == crate::city::NONE {
                    continue;
                }
                for vertex in &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize] {
                    let surface = model.surfaces.get(vertex.surface as usize);
                    let Some(material) = surface.and_then(|s| model.materials.get(s.material as usize)) else {
                        continue;
                    };
                    for texture in material.textures() {
                        if let Some(flag) = used.get_mut(texture as usize) {
                            *flag = true;
                        }
                    }
                    if let Some(flag) = has_normals.get_mut(material.normal_texture as usize) {
                        *flag = true;
                    }
                }
            }
        }
        let before = gpu.allocated_bytes();
        let mut entries: Vec<Option<SampledTexture>> = Vec::new();
        entries.resize_with(used.len(), || None);
        let mut translucent = vec![false; used.len()];
        let mut wanted: Vec<(usize, [u32; 2])> = Vec::new();
        for i in (0..used.len()).filter(|&i| used[i]) {
            match texture::size(&model.textures[i].image) {
                Ok(size) => wanted.push((i, size)),
                // Whoever loaded the city has said this, for all of them at once.
                Err(_) if model.textures[i].image.is_missing() => {}
                Err(message) => log::warn!("texture {i}: {message}"),
            }
        }
        let sizes: Vec<[u32; 2]> = wanted.iter().map(|(_, size)| *size).collect();
        let side = side_within(&sizes, texture::MAX_SIDE, BUDGET);
        if side < texture::MAX_SIDE {
            let (all, most) = (bytes_of(&sizes, texture::MAX_SIDE) >> 20, BUDGET >> 20);
            log::warn!(
                "the textures of the city would take {all} MiB, more than {most}: those of more than {side} pixels a side are halved until they have no more"
            );
        }
        for group in groups(&wanted, side) {
            let decode = |i: usize| match has_normals[i] {
                true => texture::decode_normals_within(&model.textures[i], side),
                false => texture::decode_within(&model.textures[i], side),
            };
            let decoded: Vec<_> = group.par_iter().map(|&(i, _)| decode(i)).collect();
            for (&(i, _), result) in group.iter().zip(decoded) {
                match result {
                    Ok(pixels) => {
                        translucent[i] = pixels.is_translucent();
                        // Bytes of colours are of a screen, what is sampled is linear light. The geometry target holds bytes of
                        // a screen too, so no precision is lost on the way.
                        let format = match has_normals[i] {
                            true => wgpu::TextureFormat::Rgba8Unorm,
                            false => wgpu::TextureFormat::Rgba8UnormSrgb,
                        };
                        entries[i] = Some(upload(gpu, &pixels, &model.textures[i], format));
                    }
                    Err(message) => log::warn!("texture {i}: {message}"),
                }
            }
        }
        let white = (shown.facades || !wanted.is_empty()).then(|| white(gpu));
        Ok(Self { entries, translucent, white, bytes: gpu.allocated_bytes() - before })
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
    pub fn get(&self, number: u32) -> Option<&SampledTexture> {
        self.entries.get(number as usize)?.as_ref()
    }

    /// The same; of what is not there one white texel, where there is some other texture.
    pub fn get_or_white(&self, number: u32) -> Option<&SampledTexture> {
        self.get(number).or(self.white.as_ref())
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// A texture, and how it is sampled.
#[derive(Debug)]
pub struct SampledTexture {
    /// The texture.
    pub view: wgpu::TextureView,
    /// Where four pixels together tell how far its coordinates go.
    pub sampler: wgpu::Sampler,
    /// Where each says the level: Mesa's software driver asks all four all the same where a sampler is anisotropic.
    pub by_level: wgpu::Sampler,
}

/// Bytes of images of these sizes with their levels, where no side is longer than `side`.
fn bytes_of(sizes: &[[u32; 2]], side: u32) -> u64 {
    sizes.iter().map(|size| texture::bytes_within(*size, side)[0]).sum()
}

/// The longest side, of `most` halved again and again, with which images of these sizes take no more than `budget` bytes; at least
/// [`LEAST_SIDE`].
fn side_within(sizes: &[[u32; 2]], most: u32, budget: u64) -> u32 {
    let mut side = most;
    while side > LEAST_SIDE && bytes_of(sizes, side) > budget {
        side /= 2;
    }
    side
}

/// What is decoded at a time, so that decoded images do not pile up: as many as take [`AT_A_TIME`] together, or one.
fn groups(wanted: &[(usize, [u32; 2])], side: u32) -> impl Iterator<Item = &[(usize, [u32; 2])]> {
    let mut bytes = 0;
    wanted.chunk_by(move |before, next| {
        let of = |one: &(usize, [u32; 2])| texture::bytes_within(one.1, side).into_iter().max().unwrap_or_default();
        bytes = if bytes == 0 { of(before) } else { bytes } + of(next);
        let is_within = bytes <= AT_A_TIME;
        if !is_within {
            bytes = 0;
        }
        is_within
    })
}

fn white(gpu: &Gpu) -> SampledTexture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.texture("no texture", [1, 1, 1], 1, wgpu::TextureFormat::Rgba8Unorm, usage);
    gpu.write_texture_level(&texture, 0, &[u8::MAX; 4]);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let sampler =
        gpu.device.create_sampler(&wgpu::SamplerDescriptor { label: Some("no texture"), ..Default::default() });
    SampledTexture { view, by_level: sampler.clone(), sampler }
}

fn upload(gpu: &Gpu, pixels: &texture::Pixels, declared: &Texture, format: wgpu::TextureFormat) -> SampledTexture {
    let size = [pixels.width, pixels.height, 1];
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.texture("city texture", size, pixels.levels.len() as u32, format, usage);
    for (level, rgba) in pixels.levels.iter().enumerate() {
        gpu.write_texture_level(&texture, level as u32, rgba);
    }
    let mode = |wrap: Wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let sampler = |anisotropy_clamp: u16| {
        gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("city texture"),
            address_mode_u: mode(declared.wrap[0]),
            address_mode_v: mode(declared.wrap[1]),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp,
            ..Default::default()
        })
    };
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    SampledTexture { view, sampler: sampler(8), by_level: sampler(1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_share_the_budget() {
        let mib = |n: u64| n << 20;
        assert_eq!(side_within(&[[1024, 1024]; 4], 8192, mib(2048)), 8192);
        // A thousand of 16 MiB with their levels: 5 MiB each would be within 8 GiB, a fourth of that within 2.
        assert_eq!(side_within(&[[2048, 2048]; 1000], 8192, mib(8 << 10)), 1024);
        assert_eq!(side_within(&[[2048, 2048]; 1000], 8192, mib(2 << 10)), 512);
        // Small ones keep what they have.
        let small: u64 = [[256, 256], [256, 4]].map(|size| texture::bytes_within(size, 8192)[0]).iter().sum();
        assert_eq!(bytes_of(&[[256, 256], [4096, 64]], 256), small);
        assert_eq!(side_within(&[[8192, 8192]; 1_000_000], 8192, 1), LEAST_SIDE);
    }

    #[test]
    fn a_few_are_decoded_at_a_time() {
        let wanted: Vec<(usize, [u32; 2])> = [4096, 8192, 64, 64, 8192, 8192, 16].map(|side| (0, [side; 2])).into();
        let counts: Vec<usize> = groups(&wanted, 8192).map(<[_]>::len).collect();
        // 96, 384, 384 and 384 MiB of the large ones: two fit.
        assert_eq!(counts, [4, 1, 2]);
    }
}
