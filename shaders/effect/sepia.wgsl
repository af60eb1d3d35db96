//! name = "sepia"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "The warm brown of an albumen print: middle tones 0.016 lighter in luminance, white an ivory 0.04 darker."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 1
//! doc = "How much of the effect: 0 = none, 1 = all of it."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let grey = luminance(color);
    let toned = grey * vec3f(1.22, 0.97, 0.68);
    return mix(color, mix(toned, vec3f(1.0), 0.06 * grey), p.amount);
}
