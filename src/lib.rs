//! **Veduta** looks at 3D city models through *information lenses*: focus + context for cities.
//!
//! A city is looked at through lenses; a lens is made of handlers; handlers become one shader;
//! passes draw the frame; a figure is a frame written down; measurement compares figures.
//!
//! The way of a picture, from the ground floor up (imports go down only, `tests/features/floors.rs`):
//!
//! 1. [`geom`]: shapes and numbers; exact predicates, triangulation, the BVH.
//! 2. [`city`]: files become one plain [`city::CityModel`] and a list of warnings.
//! 3. [`view`]: the eye. [`overlay`]: 2D places in a picture. [`shader`]: WGSL text. [`gpu`]: wgpu, and nothing that knows a city.
//! 4. [`visibility`]: who hides what.
//! 5. [`lens`]: what to show where: shapes, effects, depth sprites and their CPU twins.
//! 6. [`scene`]: plain data: city + view + lenses + POIs + styles, edited by commands.
//! 7. [`render`]: a scene becomes a frame: a readable list of passes.
//! 8. [`figure`]: scene files and back, pictures and their metadata.
//! 9. [`measure`]: what accuracy costs in time.
//! 10. [`cli`]: what people type.

pub mod app;
pub mod city;
pub mod cli;
pub mod field;
pub mod figure;
pub mod geom;
pub mod gpu;
pub mod lens;
pub mod measure;
pub mod overlay;
pub mod query;
pub mod render;
pub mod scene;
pub mod shader;
pub mod text;
pub mod time;
pub mod view;
pub mod visibility;

#[cfg(test)]
#[path = "../tests/seeds/mod.rs"]
mod seeds;
