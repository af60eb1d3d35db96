//! City models: files become one plain [`CityModel`] and a list of warnings; nothing of the GPU in it.

pub mod build;
pub mod builtin;
pub mod change;
pub mod cityjson;
pub mod closed;
pub mod compare;
pub mod coplanar;
pub mod crs;
pub mod derived;
pub mod edges;
pub mod facts;
pub mod gltf;
pub mod ground;
pub mod history;
pub mod join;
pub mod json;
pub mod kept_measures;
pub mod label;
pub mod lifetime;
pub mod load;
pub mod measured;
mod memory;
pub mod model;
pub mod obj;
pub mod place;
pub mod shown;
pub mod side_table;
pub mod spatial;
mod strings;
pub mod sun;
pub mod synth;
#[cfg(test)]
pub(crate) mod test_city;
pub mod texture;
pub mod timetable;
pub mod validate;
pub mod warning;
pub mod way;

pub use model::*;
pub use strings::Strings;
pub use warning::{WarningCode, Warnings};
