//! Where overlays stand in a picture, and the context lines that tie them to their places (Trapp §3.4).
//!
//! Plain data in, plain data out: pixels of one picture, x right, y down, (0, 0) its upper left corner. Nothing here knows lenses, scenes or the GPU.
//! [`place()`] does it all in one call, because the order of the overlays decides which lines cross:
//!
//! 1. [`size`]: each overlay gets a size; all shrink together until there is room.
//! 2. [`lane`]: a side of the picture is a lane, along which overlays stand in a row, past the points that they must not cover.
//! 3. [`fill`]: which overlay stands on which lane, by priority; one that finds no room there stands further inward, or is folded to a marker.
//! 4. [`order`]: the order on the lanes that makes least lines cross, told by exact predicates ([`crossings`], [`grid`]).
//! 5. [`coherence`]: with the frame before, overlays keep still, or glide.
//!
//! Beside it the geometry of drawing: [`mod@line`] (the ways of lines), [`ribbon`] (their skins), [`arrow`] (for points outside of the picture).

pub mod arrow;
pub mod coherence;
pub mod crossings;
pub mod fill;
pub mod grid;
pub mod inward;
pub mod lane;
pub mod line;
pub mod order;
pub mod place;
pub mod placed;
pub mod problem;
pub mod rect;
pub mod request;
pub mod ribbon;
pub mod size;

pub use place::place;
pub use placed::{Fact, Marker, Placed, Placement};
pub use rect::Rect;
pub use request::{Align, Along, Arrangement, Focus, Layout, LineKind, Order, Overlay, Request, SizeRule};

#[cfg(test)]
mod tests;
