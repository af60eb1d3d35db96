//! name = "shear"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "The higher, the further aside."
//! derivative = true
//!
//! [[parameter]]
//! name = "slope_x"
//! type = "number"
//! required = true
//! unit = "m per m of height"
//! doc = "How far along x."
//!
//! [[parameter]]
//! name = "slope_y"
//! type = "number"
//! required = true
//! unit = "m per m of height"
//! doc = "How far along y."
//!
//! [[parameter]]
//! name = "base"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "The height that stays."

fn effect(place: vec3f, p: Parameters) -> Jet {
    let slope = vec3f(p.slope_x, p.slope_y, 0.0);
    return Jet((place.z - p.base) * slope, mat3x3f(vec3f(0.0), vec3f(0.0), slope));
}
