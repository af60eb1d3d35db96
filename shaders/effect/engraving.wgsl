//! name = "engraving"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Lines as wide as the picture is dark, as on a banknote: ink and paper give back its luminance; 4 to 96 % of a line's spacing are ink."
//!
//! [[parameter]]
//! name = "spacing"
//! type = "number"
//! range = [2, 64]
//! default = 4
//! unit = "pixels"
//! doc = "From line to line."
//!
//! [[parameter]]
//! name = "angle_deg"
//! type = "number"
//! range = [-180, 180]
//! default = 30
//! unit = "degrees"
//! doc = "How the lines are turned, counterclockwise from level."
//!
//! [[parameter]]
//! name = "ink"
//! type = "color"
//! default = "#16202c"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "paper"
//! type = "color"
//! default = "#fbf8f0"
//! doc = "Colour between them."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let bright = luminance(p.paper);
    let dark = luminance(p.ink);
    // The share of ink that gives the picture's luminance back; a little of either stays, for the lines to go on.
    let share = clamp((bright - luminance(color)) / max(bright - dark, 1e-3), 0.04, 0.96);
    let angle = radians(p.angle_deg);
    let across = dot(vec2f(pixel_in_picture(point)) + 0.5, vec2f(sin(angle), cos(angle))) / p.spacing;
    let half = 0.5 / p.spacing;
    let inked = ink_until(across + half, share) - ink_until(across - half, share);
    return mix(p.paper, p.ink, clamp(inked * p.spacing, 0.0, 1.0));
}

// How much ink there is across the lines from 0 to x, in spacings: so a pixel has exactly its part of a line.
fn ink_until(x: f32, share: f32) -> f32 {
    return floor(x) * share + min(fract(x), share);
}
