//! What a view draws into: allocated once per size, and only what the scene needs.

use crate::{
    gpu::Gpu,
    render::resource::formats::{
        COLORS, DEPTH, EMISSIONS, FILTERED, LINES, MASKS, OCCLUSION, OWN_DEPTH, PICTURE, RAY_HITS, SMOOTH_CODES,
        SPRITES, TRANSPARENCY, codes, through,
    },
};

/// What a frame needs beside codes, depth and the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Width, height, pixels.
    pub size: [u32; 2],
    /// Base colours, in cities with textures.
    pub colors: bool,
    /// Shares of own light, where texels say them.
    pub emissions: bool,
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
    /// Whether sprites are made with a depth test.
    pub sprite_depth: bool,
    /// How many neighbourhood filters there are, 0 for none.
    pub filters: u32,
    /// How many images each of them makes ([`crate::render::frame::Behind::images`]), 0 for none.
    pub filter_images: u32,
    /// A layer of lines.
    pub lines: bool,
    /// Translucent layers.
    pub transparency: bool,
    /// One layer of many of them.
    pub tails: bool,
    /// Which of them is the shown surface.
    pub shown_layers: bool,
    /// Side of the map of what the sun sees, 0 for none.
    pub shadow: u32,
    /// Side of that of what a point of the sky sees, 0 for none.
    pub sky: u32,
    /// How much of the sky is seen.
    pub occlusion: bool,
    /// Which triangles bent rays meet.
    pub ray_hits: bool,
}

impl Needs {
    /// What serves this and `before` alike: a target once made for pictures of a size is kept while they have that size, so
    /// that a lens that comes and goes, or is switched on and off, allocates nothing.
    fn with(self, before: &Self) -> Self {
        if self.size != before.size || self.smooth != before.smooth {
            return self;
        }
        Self {
            size: self.size,
            smooth: self.smooth,
            colors: self.colors || before.colors,
            emissions: self.emissions || before.emissions,
            own_depth: self.own_depth || before.own_depth,
            sums: self.sums || before.sums,
            mask_layers: self.mask_layers.max(before.mask_layers),
            sprites: std::array::from_fn(|i| self.sprites[i].max(before.sprites[i])),
            sprite_depth: self.sprite_depth || before.sprite_depth,
            filters: self.filters.max(before.filters),
            filter_images: self.filter_images.max(before.filter_images),
            lines: self.lines || before.lines,
            transparency: self.transparency || before.transparency,
            tails: self.tails || before.tails,
            shown_layers: self.shown_layers || before.shown_layers,
            // Of one size at a time: its whole texture is the map.
            shadow: if self.shadow == 0 { before.shadow } else { self.shadow },
            sky: if self.sky == 0 { before.sky } else { self.sky },
            occlusion: self.occlusion || before.occlusion,
            ray_hits: self.ray_hits || before.ray_hits,
        }
    }
}

/// A texture and the view of all of it.
#[derive(Debug)]
pub struct Target {
    /// What it is called.
    label: &'static str,
    /// The texture.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
    /// Its layers one by one, where there are several.
    pub layers: Vec<wgpu::TextureView>,
}

impl Target {
    fn is(&self, label: &str, [width, height, depth_or_array_layers]: [u32; 3], format: wgpu::TextureFormat) -> bool {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers };
        self.label == label && self.texture.size() == size && self.texture.format() == format
    }
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
    /// sRGB shares of own light (1×1 where not needed).
    pub emissions: Target,
    /// Interpolated depth of the seen face (1×1 where not needed).
    pub own_depth: Target,
    /// The picture, sRGB, straight alpha.
    pub picture: Target,
    /// Sums of samples, linear (1×1 where not needed).
    pub sums: Target,
    /// One bit per lens; layers 3w inside, 3w+1 in front, 3w+2 behind (1×1 where not needed).
    pub masks: Target,
    /// Pages of the sides of solids: stored depths of entries and exits.
    pub sprites: Target,
    /// Depth of a page of sprites while one is made (1×1 where not needed).
    pub sprite_depth: Target,
    /// What a filter starts from, four pixels to a texel, a layer for each of its images (1×1 where not needed).
    pub unfiltered: Target,
    /// What it has done in one direction, as `pass/filter.wgsl` explains, in four layers (1×1 where not needed).
    pub half_filtered: Target,
    /// What filters made: four layers for each image (1×1 where not needed).
    pub filtered: Target,
    /// Lines over what is shaded, linear colours times opacity (1×1 where not needed).
    pub lines: Target,
    /// Translucent layers over what is shaded, linear colours times opacity; alpha: what is let through (1×1 where not needed).
    pub transparency: Target,
    /// Translucent layers whose order is not known: sums of colours and opacities, weighted (1×1 where not needed).
    pub tail_sums: Target,
    /// What they let through (1×1 where not needed).
    pub tail_through: Target,
    /// The layer that is the shown surface, as `codes`, always with its normal (1×1 where not needed).
    pub shown_code: Target,
    /// Its depth (1×1 where not needed).
    pub shown_depth: Target,
    /// Depth from the sun (1×1 where not needed).
    pub shadow: Target,
    /// Depth from a point of the sky (1×1 where not needed).
    pub sky: Target,
    /// How much of the sky is seen, at half the resolution (1×1 where not needed).
    pub occlusion: Target,
    /// Which triangles bent rays meet, and of which city (1×1 where not needed).
    pub ray_hits: Target,
}

impl Targets {
    /// Whether a frame with these needs can be drawn into them.
    pub fn serve(&self, needs: &Needs) -> bool {
        needs.with(&self.needs) == self.needs
    }

    fn taken_apart(self) -> Vec<Target> {
        let Self { codes, depth, colors, own_depth, picture, sums, masks, sprites, unfiltered, half_filtered, .. } =
            self;
        vec![
            codes,
            depth,
            colors,
            own_depth,
            picture,
            sums,
            masks,
            sprites,
            unfiltered,
            half_filtered,
            self.emissions,
            self.filtered,
            self.lines,
            self.transparency,
            self.tail_sums,
            self.tail_through,
            self.shown_code,
            self.shown_depth,
            self.shadow,
            self.sky,
            self.occlusion,
            self.sprite_depth,
            self.ray_hits,
        ]
    }

    /// Makes them, of `before` as many as are the same.
    pub fn new(gpu: &Gpu, needs: Needs, sums: wgpu::TextureFormat, before: Option<Self>) -> Self {
        use wgpu::TextureUsages as U;
        let needs = before.as_ref().map_or(needs, |before| needs.with(&before.needs));
        // Room for another size is only there when this is gone.
        let before = before.filter(|before| before.needs.size == needs.size);
        let mut kept = before.map(Self::taken_apart).unwrap_or_default();
        let drawn = U::RENDER_ATTACHMENT | U::TEXTURE_BINDING | U::COPY_SRC;
        let mut make_any = |label: &'static str, size: [u32; 3], format, usage, layered: bool| {
            let size = size.map(|side| side.max(1));
            if let Some(same) = kept.iter().position(|t| t.is(label, size, format)) {
                return kept.swap_remove(same);
            }
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
            Target { label, view, layers, texture }
        };
        let [w, h] = needs.size;
        let full = |on: bool| if on { [w, h, 1] } else { [1, 1, 1] };
        let images = needs.filter_images;
        let filtering = |size: [u32; 3]| if needs.filters > 0 { size } else { [1; 3] };
        let [fours_wide, fours_high] = needs.size.map(|side| side.div_ceil(4));
        let halves = if needs.occlusion { [w.div_ceil(2), h.div_ceil(2), 1] } else { [1; 3] };
        let mask_size = if needs.mask_layers > 0 { [w, h, needs.mask_layers] } else { [1, 1, 1] };
        Self {
            needs,
            codes: make_any("codes", [w, h, 1], codes(needs.smooth), drawn, false),
            depth: make_any("depth", [w, h, 1], DEPTH, drawn, false),
            colors: make_any("colors", full(needs.colors), COLORS, drawn, false),
            emissions: make_any("shares of own light", full(needs.emissions), EMISSIONS, drawn, false),
            own_depth: make_any("own depth", full(needs.own_depth), OWN_DEPTH, drawn, false),
            picture: make_any("picture", [w, h, 1], PICTURE, drawn, false),
            sums: make_any("sums", full(needs.sums), sums, drawn, false),
            masks: make_any("lens masks", mask_size, MASKS, drawn | U::STORAGE_BINDING, true),
            sprites: make_any("sides of solids", needs.sprites, SPRITES, drawn, true),
            sprite_depth: make_any(
                "depth of sprites",
                if needs.sprite_depth { [needs.sprites[0], needs.sprites[1], 1] } else { [1; 3] },
                DEPTH,
                U::RENDER_ATTACHMENT,
                false,
            ),
            unfiltered: make_any("unfiltered", filtering([fours_wide, h, images]), FILTERED, drawn, true),
            half_filtered: make_any("half filtered", filtering([fours_wide, fours_high, 4]), FILTERED, drawn, true),
            filtered: make_any(
                "filtered",
                filtering([fours_wide, fours_high, 4 * images * needs.filters]),
                FILTERED,
                drawn,
                true,
            ),
            lines: make_any("lines", full(needs.lines), LINES, drawn, false),
            transparency: make_any("translucent layers", full(needs.transparency), TRANSPARENCY, drawn, false),
            tail_sums: make_any("sums of layers", full(needs.tails), sums, drawn, false),
            tail_through: make_any("through layers", full(needs.tails), through(sums), drawn, false),
            shown_code: make_any("shown layer", full(needs.shown_layers), SMOOTH_CODES, drawn, false),
            shown_depth: make_any("depth of the shown layer", full(needs.shown_layers), OWN_DEPTH, drawn, false),
            shadow: make_any("shadow map", [needs.shadow, needs.shadow, 1], DEPTH, drawn, false),
            sky: make_any("sky map", [needs.sky, needs.sky, 1], DEPTH, drawn, false),
            occlusion: make_any("ambient occlusion", halves, OCCLUSION, drawn, false),
            ray_hits: make_any("triangles of rays", full(needs.ray_hits), RAY_HITS, drawn, false),
        }
    }
}
