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
    let roots = cone_roots(color);
    let lightness = lightness_of_roots(roots);
    let step = (floor(min(lightness, 0.9999) * p.steps) + 0.5) / p.steps;
    // Chroma follows lightness.
    return max(linear_from_roots(step + (step / max(lightness, 0.01)) * (roots - lightness)), vec3f(0.0));
}
