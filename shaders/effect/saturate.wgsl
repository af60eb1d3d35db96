//! name = "saturate"
//! kind = "post"
//! spec = "K3"
//! doc = "Makes colours stronger or weaker; lightness and hue stay."
//!
//! [[parameter]]
//! name = "factor"
//! type = "number"
//! range = [0, 3]
//! default = 1.6
//! doc = "Chroma times this: 0 = grey, 1 = as it is."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let lab = oklab_from_linear(color);
    return max(linear_from_oklab(vec3f(lab.x, p.factor * lab.yz)), vec3f(0.0));
}
