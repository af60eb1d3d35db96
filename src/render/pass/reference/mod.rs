//! The passes of techniques that draw the city once for each region, kept for comparison with accumulation. What they leave in the
//! targets is what accumulation's one pass leaves.

pub mod region_geometry;
pub mod region_shade;
