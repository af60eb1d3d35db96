//! name = "translate"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Moves."
//! derivative = true
//!
//! [[parameter]]
//! name = "by"
//! type = "vector"
//! required = true
//! unit = "m"
//! doc = "How far along its axes."

fn effect(place: vec3f, p: Parameters) -> Jet {
    return Jet(p.by, NO_SLOPE);
}
