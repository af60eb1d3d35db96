//! A scene becomes a frame.
//!
//! [`picture::Studio::render`] makes a picture, its AOVs and its statistics of a scene and a city;
//! [`frame`] lists the passes of one sample; [`renderer`] holds what stays on the graphics card.
//! This room knows no files and no commands.

pub mod body;
pub mod city;
mod city_passes;
pub mod content_cities;
pub mod contents;
mod curtain;
mod cut;
pub mod edges;
mod enclosed;
pub mod eye;
mod filters;
mod flat;
pub mod frame;
mod frame_keys;
pub mod furniture;
mod furniture_passes;
pub mod hiding;
pub mod invokers;
pub mod key;
pub mod layers;
pub mod layout;
mod lens_figures;
mod lens_volumes;
pub mod light;
mod lines;
mod module_text;
mod narrow;
mod occlusion;
mod occurring;
pub mod octagon;
pub mod operations;
mod own_sprites;
mod page;
pub mod palette;
pub mod parts;
pub mod picture;
pub mod pipelines;
mod placement;
mod plans;
mod regions;
pub mod renderer;
mod saved_sprites;
mod sections;
mod seen;
mod shells;
mod sights;
pub mod solids;
pub mod sprite_passes;
mod sprites;
pub mod stats;
pub mod stored;
mod surfaces;
mod synced;
pub mod targets;
pub mod text;
mod textures;
pub mod told;
pub mod transmittance;
pub mod volume;
mod weld;
mod worker;

pub use renderer::Renderer;
