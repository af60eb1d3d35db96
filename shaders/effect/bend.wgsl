//! name = "bend"
//! kind = "deform"
//! spec = "Trapp §3.6"
//! doc = "Bends along y, from one end to the other."
//! derivative = true
//!
//! [[parameter]]
//! name = "curvature"
//! type = "number"
//! required = true
//! unit = "1/m"
//! doc = "Radians for each metre along y."
//!
//! [[parameter]]
//! name = "low"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "The y at which it begins."
//!
//! [[parameter]]
//! name = "high"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "The y at which it ends."
//!
//! [[parameter]]
//! name = "about"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "The y that stays as it is."
//!
//! [[parameter]]
//! name = "base"
//! type = "number"
//! required = true
//! unit = "m"
//! doc = "Height at which lengths stay."

fn effect(place: vec3f, p: Parameters) -> Jet {
    let k = p.curvature;
    let z = place.z - p.base;
    let y = clamp(place.y, p.low, p.high);
    let u = y - p.about;
    let beyond = place.y - y;
    let angle = u * k;
    let t = turn(angle);
    let cos = t.y + 1.0;
    let half = sinc(0.5 * angle);
    let rise = u * (0.5 * angle) * half * half;
    let dy = u * (sinc(angle) - 1.0) - z * t.x + beyond * t.y;
    let dz = z * t.y + rise + beyond * t.x;
    let along = 1.0 - z * k * clamp_slope(place.y, p.low, p.high);
    let slope = mat3x3f(vec3f(0.0), vec3f(0.0, cos * along - 1.0, t.x * along), vec3f(0.0, -t.x, t.y));
    return Jet(vec3f(0.0, dy, dz), slope);
}
