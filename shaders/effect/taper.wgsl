//! name = "taper"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Gets narrower, or wider, upwards."
//! derivative = true
//!
//! [[parameter]]
//! name = "low"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "Height at which it begins."
//!
//! [[parameter]]
//! name = "high"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "Height at which it ends."
//!
//! [[parameter]]
//! name = "at_low"
//! type = "number"
//! required = true
//! unit = ""
//! doc = "How many times as wide at the lower height, and below."
//!
//! [[parameter]]
//! name = "at_high"
//! type = "number"
//! required = true
//! unit = ""
//! doc = "How many times as wide at the upper height, and above."

fn effect(place: vec3f, p: Parameters) -> Jet {
    let r = linear(place.z, vec2f(p.low, p.high), vec2f(p.at_low, p.at_high));
    let more = r.x - 1.0;
    let by_height = vec3f(place.xy * r.y, 0.0);
    return Jet(vec3f(place.xy * more, 0.0), mat3x3f(vec3f(more, 0.0, 0.0), vec3f(0.0, more, 0.0), by_height));
}
