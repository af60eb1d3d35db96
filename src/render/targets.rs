//! What a view draws into: allocated once per size, and only what the scene needs.

use crate::{
    gpu::{Gpu, GpuError},
    render::pipelines::{
        CODES, COLORS, DEPTH, FILTERED, LINES, MASKS, OWN_DEPTH, PICTURE, SMOOTH_CODES, SPRITES, UNFILTERED,
    },
};

/// What a frame needs beside codes, depth and the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Width, height, pixels.
    pub size: [u32; 2],
    /// Base colours, in cities with textures.
    pub colors: bool,
    /// Normals beside the surface numbers, in cities with smooth faces.
    pub smooth: bool,
    /// Interpolated depth, for the AOV.
    pub own_depth: bool,
    /// Sums of samples.
    pub sums: bool,
    /// Layers of the lens masks, 0 for none.
    pub mask_layers: u32,
    /// Width and height of the pages of depth sprites and how many there are, 0 for none.
    pub sprites: [u32; 3],
    /// How many neighbourhood filters there are, 0 for none.
    pub filters: u32,
    /// How many images each of them makes ([`crate::render::pipelines::Behind::images`]), 0 for none.
    pub filter_images: u32,
    /// A layer of lines.
    pub lines: bool,
    /// Side of the shadow map, 0 for none.
    pub shadow: u32,
}

/// A texture and the view of all of it.
#[derive(Debug)]
pub struct Target {
    /// The texture.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
    /// Its layers one by one, where there are several.
    pub layers: Vec<wgpu::TextureView>,
}

/// All targets of a view.
#[derive(Debug)]
pub struct Targets {
    /// What they were made for.
    pub needs: Needs,
    /// Surface number + 1, packed normal.
    pub codes: Target,
    /// Reversed depth.
    pub depth: Target,
    /// sRGB base colours (1×1 where not needed).
    pub colors: Target,
    /// Interpolated depth of the seen face (1×1 where not needed).
    pub own_depth: Target,
    /// The picture, sRGB, straight alpha.
    pub picture: Target,
    /// Sums of samples, linear (1×1 where not needed).
    pub sums: Target,
    /// One bit per lens; layers 3w inside, 3w+1 in front, 3w+2 behind (1×1 where not needed).
    pub masks: Target,
    /// Pages of volumetric depth sprites: stored depths of entries and exits.
    pub sprites: Target,
    /// What a filter starts from, a layer for each of its images (1×1 where not needed).
    pub unfiltered: Target,
    /// The bytes of these, on their way to where four pixels are one texel; rows of [`row_bytes`].
    pub unfiltered_bytes: wgpu::Buffer,
    /// What a filter reads: the same, and what is half done (1×1 where not needed).
    pub fours: [Target; 2],
    /// What filters made, as `pass/filter.wgsl` explains: four layers for each image (1×1 where not needed).
    pub filtered: Target,
    /// Lines over what is shaded, linear colours times opacity (1×1 where not needed).
    pub lines: Target,
    /// Depth from the sun (1×1 where not needed).
    pub shadow: Target,
}

impl Targets {
    /// Allocates what is needed.
    pub fn new(gpu: &Gpu, needs: Needs, sums: wgpu::TextureFormat) -> Result<Self, GpuError> {
        use wgpu::TextureUsages as U;
        let drawn = U::RENDER_ATTACHMENT | U::TEXTURE_BINDING | U::COPY_SRC;
        let make_any = |label: &str, size: [u32; 3], format, usage, layered: bool| {
            let size = size.map(|side| side.max(1));
            let texture = gpu.texture(label, size, 1, format, usage);
            let array = layered.then_some(wgpu::TextureViewDimension::D2Array);
            let view = texture.create_view(&wgpu::TextureViewDescriptor { dimension: array, ..Default::default() });
            let layer = |i| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: i,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            };
            let layers = if layered { (0..size[2]).map(layer).collect() } else { Vec::new() };
            Target { view, layers, texture }
        };
        let make = |label: &str, size, format, usage| make_any(label, size, format, usage, false);
        let [w, h] = needs.size;
        let full = |on: bool| if on { [w, h, 1] } else { [1, 1, 1] };
        let images = needs.filter_images;
        let filtering = |label: &str, size, format, usage| {
            make_any(label, if needs.filters > 0 { size } else { [1; 3] }, format, usage, true)
        };
        let [fours_wide, fours_high] = needs.size.map(|side| side.div_ceil(4));
        let mask_size = if needs.mask_layers > 0 { [w, h, needs.mask_layers] } else { [1, 1, 1] };
        Ok(Self {
            needs,
            codes: make("codes", [w, h, 1], if needs.smooth { SMOOTH_CODES } else { CODES }, drawn),
            depth: make("depth", [w, h, 1], DEPTH, drawn),
            colors: make("colors", full(needs.colors), COLORS, drawn),
            own_depth: make("own depth", full(needs.own_depth), OWN_DEPTH, drawn),
            picture: make("picture", [w, h, 1], PICTURE, drawn),
            sums: make("sums", full(needs.sums), sums, drawn),
            masks: make_any("lens masks", mask_size, MASKS, drawn | U::STORAGE_BINDING, true),
            sprites: make_any("depth sprites", needs.sprites, SPRITES, drawn, true),
            unfiltered: filtering("unfiltered", [w, h, images], UNFILTERED, U::RENDER_ATTACHMENT | U::COPY_SRC),
            unfiltered_bytes: gpu.empty_buffer(
                "unfiltered",
                wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                u64::from(row_bytes(needs.size)) * u64::from(h * images),
            )?,
            fours: [
                filtering("four by four", [fours_wide, h, images], FILTERED, U::TEXTURE_BINDING | U::COPY_DST),
                filtering("half filtered", [fours_wide, fours_high, 4], FILTERED, drawn),
            ],
            filtered: filtering("filtered", [fours_wide, fours_high, 4 * images * needs.filters], FILTERED, drawn),
            lines: make("lines", full(needs.lines), LINES, drawn),
            shadow: make("shadow map", [needs.shadow, needs.shadow, 1], DEPTH, drawn),
        })
    }
}

/// Bytes of a row in [`Targets::unfiltered_bytes`].
pub fn row_bytes(size: [u32; 2]) -> u32 {
    (16 * size[0].div_ceil(4)).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
