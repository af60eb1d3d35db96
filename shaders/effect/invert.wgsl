//! name = "invert"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Turns light into dark and every hue into its opposite, like a photographic negative: sRGB values from the other end."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 1
//! doc = "How much of the effect: 0 = none, 1 = all of it."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    // On encoded values: a negative keeps the middle grey that people see, not half of the light.
    let negative = 1.0 - srgb_from_linear(clamp(color, vec3f(0.0), vec3f(1.0)));
    return mix(color, linear_from_srgb(negative), p.amount);
}
