//! What texts depend on of the graphics adapter that they are for.

use crate::shader::carried::LEAST_CARRIED;

/// What an adapter is like, as far as texts depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adapter {
    /// How many vectors it carries from vertices to fragments, at least [`LEAST_CARRIED`].
    pub carried: u32,
    /// How far from their places it draws corners of triangles at most, pixels.
    pub snapping: f64,
    /// Whether triangles hold their depth where they are seen edge on.
    pub holds_depth: bool,
}

impl Adapter {
    /// One that carries as few vectors as there may be, and draws corners where they are.
    pub const LEAST: Self = Self { carried: LEAST_CARRIED, snapping: 0.0, holds_depth: false };

    /// The filling of the hook `snapping` (`lib/view.wgsl`).
    pub(super) fn snapping(&self) -> String {
        format!("const SNAPPING: f32 = {:?};\n", self.snapping as f32)
    }
}
