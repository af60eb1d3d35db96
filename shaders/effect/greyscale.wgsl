//! name = "greyscale"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Keeps lightness (Rec. 709 luminance), drops colour."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 1
//! doc = "How much of the effect: 0 = none, 1 = all of it."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return mix(color, vec3f(luminance(color)), p.amount);
}
