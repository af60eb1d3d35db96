//! name = "posterise"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Few steps of lightness instead of many, like a print of few inks: in OKLab each step is shown as its middle, and chroma follows lightness."
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
    let step = (floor(min(lightness, 0.9999) * p.steps) + 0.5) * (1.0 / p.steps);
    // Chroma follows lightness.
    let chroma = (1.0 / max(lightness, 0.01)) * (roots - lightness);
    return max(linear_from_roots(step + step * chroma), vec3f(0.0));
}
