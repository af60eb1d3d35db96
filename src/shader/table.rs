//! The invoker table of the uber back end, and how large it may be.

use crate::shader::library::INVOKERS;

/// Side of the tiles that have lists of invokers, pixels.
pub const TILE_PX: u32 = 32;
/// Volumes of a picture: a uniform of 64 KiB holds more than so many.
pub const MOST_VOLUMES: u32 = 1024;
/// `vec4f` of parameters of a picture: such a uniform full.
pub const MOST_SLOTS: u32 = 4096;

/// The table, declared, as `render::layout` lays it out.
pub(super) fn declared() -> String {
    format!("{}const TILE_PX: u32 = {TILE_PX}u;\n\n", INVOKERS.paragraph())
}
