//! name = "twist"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Turns about its vertical axis."
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
//! unit = "radians"
//! doc = "Angle at the lower height, and below."
//!
//! [[parameter]]
//! name = "at_high"
//! type = "number"
//! required = true
//! unit = "radians"
//! doc = "Angle at the upper height, and above."

fn effect(place: vec3f, p: Parameters) -> Jet {
    let angle = linear(place.z, vec2f(p.low, p.high), vec2f(p.at_low, p.at_high));
    let t = turn(angle.x);
    let cos = t.y + 1.0;
    let by_angle = vec2f(-(place.x * t.x) - place.y * cos, place.x * cos - place.y * t.x);
    let way = vec3f(place.x * t.y - place.y * t.x, place.x * t.x + place.y * t.y, 0.0);
    return Jet(way, mat3x3f(vec3f(t.y, t.x, 0.0), vec3f(-t.x, t.y, 0.0), vec3f(by_angle * angle.y, 0.0)));
}
