//! name = "saturate"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Makes colours stronger or weaker; lightness and hue stay."
//!
//! [[parameter]]
//! name = "factor"
//! type = "number"
//! range = [0, 3]
//! default = 1.6
//! doc = "Chroma times this: 0 = grey, 1 = as it is."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    // In OKLab away from the grey of the same lightness, or towards it.
    let roots = cone_roots(color);
    let grey = lightness_of_roots(roots);
    return max(linear_from_roots(grey + p.factor * (roots - grey)), vec3f(0.0));
}
