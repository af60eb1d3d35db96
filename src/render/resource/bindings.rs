//! Bind groups, and their layouts as plain data: a pass states the layouts that are its own beside its code.

use wgpu::{BindingType as B, ShaderStages as S};

use crate::{
    gpu::Gpu,
    render::resource::{formats::MASKS, synced::Synced, targets::Target},
};

/// Bytes between two dynamic offsets: what every adapter accepts.
pub const STAGE_STRIDE: u64 = 256;

/// What a bind group holds: its label, and each binding with the stages that see it and its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroupLayout {
    /// For messages of the driver.
    pub label: &'static str,
    /// Number, stages, type.
    pub entries: &'static [(u32, S, B)],
}

/// Seen by vertex and fragment shaders.
pub const DRAWN: S = S::VERTEX.union(S::FRAGMENT);
/// Seen by fragment and compute shaders.
pub const COMPUTED: S = S::FRAGMENT.union(S::COMPUTE);

const fn buffer(ty: wgpu::BufferBindingType, has_dynamic_offset: bool) -> B {
    B::Buffer { ty, has_dynamic_offset, min_binding_size: None }
}

const fn image(sample_type: wgpu::TextureSampleType, view_dimension: wgpu::TextureViewDimension) -> B {
    B::Texture { sample_type, view_dimension, multisampled: false }
}

/// A uniform.
pub const UNIFORM: B = buffer(wgpu::BufferBindingType::Uniform, false);
/// One of several uniforms, at a dynamic offset.
pub const STAGE: B = buffer(wgpu::BufferBindingType::Uniform, true);
/// A storage buffer that is read.
pub const STORAGE: B = buffer(wgpu::BufferBindingType::Storage { read_only: true }, false);
/// A part of one, at a dynamic offset.
pub const STORED_STAGE: B = buffer(wgpu::BufferBindingType::Storage { read_only: true }, true);
/// A storage buffer that is written.
pub const WRITTEN: B = buffer(wgpu::BufferBindingType::Storage { read_only: false }, false);
/// Texels of floats, read one by one.
pub const FLOATS: B = image(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2);
/// The same in layers.
pub const LAYERED_FLOATS: B =
    image(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2Array);
/// A picture that is sampled.
pub const SAMPLED: B = image(wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D2);
/// Texels of floats in three dimensions.
pub const VOXELS: B = image(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D3);
/// The same of whole numbers.
pub const VOXEL_NUMBERS: B = image(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D3);
/// Depth.
pub const DEPTHS: B = image(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2);
/// The same in layers.
pub const LAYERED_DEPTHS: B = image(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array);
/// Whole numbers.
pub const NUMBERS: B = image(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
/// The same in layers.
pub const LAYERED_NUMBERS: B = image(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2Array);
/// The lens masks, as shaders write them.
pub const WRITTEN_MASKS: B = B::StorageTexture {
    access: wgpu::StorageTextureAccess::WriteOnly,
    format: MASKS,
    view_dimension: wgpu::TextureViewDimension::D2Array,
};
/// A sampler that interpolates.
pub const SAMPLER: B = B::Sampler(wgpu::SamplerBindingType::Filtering);
/// A sampler that compares depths.
pub const COMPARING: B = B::Sampler(wgpu::SamplerBindingType::Comparison);

/// A bind group of these resources.
pub fn group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    entries: &[(u32, wgpu::BindingResource)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = entries
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A buffer as a whole.
pub fn whole(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    buffer.as_entire_binding()
}

/// All of a target.
pub fn all_of(target: &Target) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&target.view)
}

/// One of several `T` in a buffer, at a dynamic offset.
pub fn one_of<T>(buffer: &Synced) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: buffer.buffer(), offset: 0, size })
}

/// A value in its place among others that are bound at dynamic offsets.
pub fn strided<T: bytemuck::Pod>(value: &T) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(value).to_vec();
    bytes.resize(STAGE_STRIDE as usize, 0);
    bytes
}

/// A bind group that is made anew when something that it binds was replaced.
#[derive(Debug, Default)]
pub struct KeptGroup {
    of: u64,
    group: Option<wgpu::BindGroup>,
}

impl KeptGroup {
    /// Makes it anew the next time.
    pub fn forget(&mut self) {
        self.group = None;
    }

    /// The group, made by `make` unless there is one of the same `stamp`, which counts how often what it binds was replaced.
    pub fn fit(&mut self, stamp: u64, make: impl FnOnce() -> wgpu::BindGroup) {
        if self.of != stamp {
            self.group = None;
        }
        self.of = stamp;
        self.group.get_or_insert_with(make);
    }

    /// The group; `None` before [`Self::fit`].
    pub fn get(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref()
    }
}
