//! name = "discard-color"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Turns colours like the given one to grey; or, with keep, all others. The border between them is soft, from 0.8 to 1.2 times the tolerance."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#c0775c"
//! doc = "The colour; roof tiles where none is given."
//!
//! [[parameter]]
//! name = "tolerance"
//! type = "number"
//! range = [0.01, 1]
//! default = 0.12
//! doc = "How unlike a colour may be and still count, as distance in hue and chroma (OKLab)."
//!
//! [[parameter]]
//! name = "keep"
//! type = "boolean"
//! default = false
//! doc = "Keeps the colour and turns all others to grey."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    // Lightness does not count: the same wall in sun and shade has one colour.
    let apart = length(hue_of(color) - hue_of(p.color));
    let alike = 1.0 - smoothstep(0.8 * p.tolerance, 1.2 * p.tolerance, apart);
    let stays = select(1.0 - alike, alike, p.keep);
    return mix(vec3f(luminance(color)), color, stays);
}

// Hue and chroma for a lightness of one: light changes all three coordinates by one factor.
fn hue_of(color: vec3f) -> vec2f {
    let lab = oklab_from_linear(color);
    return lab.yz / max(lab.x, 0.05);
}
