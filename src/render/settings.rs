//! Settings of a renderer: room, and ways of drawing that leave the picture as it is.

use crate::render::light::SHADOW_SIZE;

/// Settings of a renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Whether chunks that nearer ones hide are left out where that pays: on software adapters.
    pub culls_hidden: bool,
    /// Whether the processor follows rays that lenses bend to what is opaque, where all lenses bend all rays in known ways and nothing is seen through: on
    /// software adapters, which follow them more slowly.
    pub traces_rays: bool,
    /// Whether the city is not drawn again where only lenses move that hide nothing of it. Where frames are measured it is drawn in each.
    pub holds_geometry: bool,
    /// Whether lists of many lenses are narrowed to what each tile shows.
    pub narrows_lists: bool,
    /// The number of fragment nodes of translucent layers that have room at a time; `None`: as many as [`crate::render::layers::LAYER_BYTES`]
    /// hold. What does not fit is drawn in bands.
    pub most_layers: Option<u64>,
    /// The number of the only layer that the exact method tells ([`crate::render::composited`]), nearest first; `None`: all are laid.
    pub(super) picked_layer: Option<u32>,
    /// Triangles of translucent layers are drawn one by one, in an order shuffled by this number; `None`: as they lie in the city.
    /// The picture is the same.
    pub shuffled: Option<u32>,
    /// Texels along a side of the shadow map, at least [`crate::render::light::LEAST_SHADOW_SIZE`]; what drawing it costs grows with its square.
    pub shadow_size: u32,
    /// Longest side of what is kept of a tile, at least [`crate::render::parts::LEAST_TILE`], pixels; `None`: as large as targets may be. Larger pictures are
    /// drawn in tiles.
    pub tile: Option<u32>,
    /// Pipelines that may be kept when a frame starts; where there are more, those go that were used longest ago.
    pub most_pipelines: usize,
}

/// Far more than one scene with its lenses asks for.
const MOST_PIPELINES: usize = 2000;

impl Settings {
    /// Those that suit an adapter.
    pub fn new(is_software: bool) -> Self {
        Self {
            culls_hidden: is_software,
            traces_rays: is_software,
            holds_geometry: true,
            narrows_lists: true,
            most_layers: None,
            picked_layer: None,
            shuffled: None,
            shadow_size: SHADOW_SIZE,
            tile: None,
            most_pipelines: MOST_PIPELINES,
        }
    }
}
