//! The city drawn: what `pass/geometry.wgsl` leaves open, for the passes that are made with it.

use crate::shader::template::Template;

/// Outputs of the geometry pass, and the view that its vertices get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawn {
    /// Surfaces, and nothing else.
    Surfaces,
    /// The number of their region with them: one output more.
    Regions,
    /// Whatever shades them, with a view of its own that vertices get from the uniform.
    Shaded,
}

/// Where nothing is hidden.
pub(super) const NOTHING_CUT: &str = "fn cut(at: vec2f, depth: f32, code: u32) {}\n";

/// Fills the hooks; `handlers` say what is hidden.
pub(super) fn filled<'a>(text: Template<'a>, drawn: Drawn, handlers: &str) -> Template<'a> {
    let (member, value) = match drawn {
        Drawn::Regions => ("    @location(3) region: u32,\n", ", drawn.x"),
        Drawn::Surfaces | Drawn::Shaded => ("", ""),
    };
    let placed = if drawn == Drawn::Shaded { "    view = view_uniform;\n" } else { "" };
    text.fill("handlers", handlers).fill("placed", placed).fill("region-member", member).fill("region", value)
}
