//! name = "clay"
//! kind = "scene"
//! spec = "Trapp §3.5"
//! doc = "One matt colour for everything, as if the city were an architect's model."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#ccc5b9"
//! doc = "The colour."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return p.color * point.facade * irradiance(point.normal, point.sun);
}
