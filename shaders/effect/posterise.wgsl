//! name = "posterise"
//! kind = "post"
//! spec = "K3"
//! doc = "Few steps of lightness instead of many, like a print of few inks."
//!
//! [[parameter]]
//! name = "steps"
//! type = "number"
//! range = [2, 12]
//! default = 4
//! unit = "steps"
//! doc = "How many steps."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let lab = oklab_from_linear(color);
    let lightness = min(lab.x, 0.9999);
    let step = (floor(lightness * p.steps) + 0.5) / p.steps;
    return max(linear_from_oklab(vec3f(step, lab.yz * (step / max(lab.x, 0.01)))), vec3f(0.0));
}
