//! name = "scale"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Stretches or presses."
//! derivative = true
//!
//! [[parameter]]
//! name = "more"
//! type = "vector"
//! required = true
//! doc = "How many times as large along its axes, less one."
//!
//! [[parameter]]
//! name = "about"
//! type = "vector"
//! required = true
//! unit = "m"
//! doc = "What stays."

fn effect(place: vec3f, p: Parameters) -> Jet {
    let more = p.more;
    let slope = mat3x3f(vec3f(more.x, 0.0, 0.0), vec3f(0.0, more.y, 0.0), vec3f(0.0, 0.0, more.z));
    return Jet(more * (place - p.about), slope);
}
