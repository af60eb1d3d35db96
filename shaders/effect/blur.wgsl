//! name = "blur"
//! kind = "filter"
//! spec = "Trapp §3.5"
//! doc = "Out of focus, by a Gaussian: with class = \"rest\" and \"behind\" the eye goes to what stays sharp (semantic depth of field)."
//!
//! [[parameter]]
//! name = "radius"
//! type = "number"
//! range = [0, 32]
//! default = 6
//! unit = "pixels"
//! doc = "How far a point is spread: two and a half standard deviations."

fn effect(offset: f32, p: Parameters) -> f32 {
    let deviations = offset * (2.5 / max(p.radius, 1e-3));
    return exp(-0.5 * deviations * deviations);
}
