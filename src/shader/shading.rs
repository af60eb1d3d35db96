//! Differences between the passes that shade.

/// How a pass shades.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    /// How many vectors are carried from vertices to fragments; `None`: uniforms are read where they stand.
    pub(super) room: Option<u32>,
    /// Whether all stands in one target, of which a shader sees the surface and another the background.
    pub(super) is_of_surfaces: bool,
    /// How many `vec4f` of the parameters other parts of the module read; 0: there are none.
    pub(super) slots: u32,
}

impl Shading {
    /// Shading of the shown surfaces, and of the sky behind the city.
    pub(super) fn of_surfaces(room: u32) -> Self {
        Self { room: Some(room), is_of_surfaces: true, slots: 0 }
    }

    /// Shading of translucent layers. No other shader writes their pixels, whatever is opaque behind them.
    pub(super) fn of_layers(room: u32) -> Self {
        Self { room: Some(room), is_of_surfaces: false, slots: 0 }
    }

    /// Shading of fragments where they are drawn, by a module that reads so many `vec4f` of the parameters elsewhere.
    pub(super) fn of_fragments(slots: u32) -> Self {
        Self { room: None, is_of_surfaces: false, slots }
    }
}
