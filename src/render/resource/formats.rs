//! Texture formats of what passes draw into.

/// Depth everywhere: reversed, f32.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Surface number + 1.
pub const CODES: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// The same and a packed normal, in cities with smooth faces.
pub const SMOOTH_CODES: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// sRGB base colours, only in cities with textures.
pub const COLORS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// sRGB shares of own light, only where texels say them.
pub const EMISSIONS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Interpolated depth, only where the depth AOV is asked for.
pub const OWN_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Numbers of regions, only where a technique tells them apart by passes.
pub const REGIONS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Triangle + 1 and city that a bent ray meets.
pub const RAY_HITS: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// One bit per lens and class.
pub const MASKS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Four colours or opacities as `lib/packed.wgsl` packs them: what neighbourhood filters read and write.
pub const FILTERED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Stored depths of an entry and of an exit: the sides of solids.
pub const SPRITES: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// How much of the sky is seen, and the stored depth where that was asked.
pub const OCCLUSION: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// The picture: sRGB bytes.
pub const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Lines before they are laid over the picture: linear, premultiplied.
pub const LINES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Translucent layers before they are laid over the picture: linear, premultiplied; alpha: what is let through.
pub const TRANSPARENCY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Furniture before it is laid over a transparent picture: linear, premultiplied.
pub const FURNITURE_LAYER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// What passes are drawn on that only list what they meet: nothing is written to it.
pub const LIST_TARGET: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// The target of surface numbers: with normals where some faces of the picture have one per vertex.
pub fn codes(smooth: bool) -> wgpu::TextureFormat {
    if smooth { SMOOTH_CODES } else { CODES }
}

/// The format of what a tail of layers lets through, where sums have this one.
pub fn through(sums: wgpu::TextureFormat) -> wgpu::TextureFormat {
    match sums {
        wgpu::TextureFormat::Rgba32Float => wgpu::TextureFormat::R32Float,
        _ => wgpu::TextureFormat::R16Float,
    }
}
