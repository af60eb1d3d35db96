//! name = "own-ray"
//! kind = "ray"
//! mode = "optional"
//! spec = "Wang et al. §3"
//! doc = "The pixel's own ray, straight from the eye."

fn effect(place: vec2f, size: vec3f) -> vec3f {
    return vec3f(place, 1.0);
}
