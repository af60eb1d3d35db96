//! name = "gooch"
//! kind = "scene"
//! spec = "Trapp §3.5"
//! doc = "From cool to warm as surfaces turn to the sun: form without black or white (Gooch et al. 1998)."
//!
//! [[parameter]]
//! name = "cool"
//! type = "color"
//! default = "#2b4a7d"
//! doc = "Colour of what faces away from the sun."
//!
//! [[parameter]]
//! name = "warm"
//! type = "color"
//! default = "#f0d7a0"
//! doc = "Colour of what faces it."
//!
//! [[parameter]]
//! name = "own"
//! type = "number"
//! range = [0, 1]
//! default = 0.5
//! doc = "How much of its own colour a surface keeps."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let turn = 0.5 + 0.5 * dot(point.normal, light.to_sun);
    // A cast shadow is a third of the way to the dark side.
    let warmth = turn * mix(0.67, 1.0, point.sun);
    let cool = mix(p.cool, point.base * 0.55, p.own);
    let warm = mix(p.warm, point.base, p.own);
    return mix(cool, warm, warmth);
}
