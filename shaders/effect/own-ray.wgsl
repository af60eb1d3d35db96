//! name = "own-ray"
//! kind = "ray"
//! spec = "Wang et al. §3"
//! doc = "The pixel's own ray, straight from the eye."

fn effect(pixel: vec2f) -> Ray {
    let across = pixel * view.across_from_pixel.xy + view.across_from_pixel.zw;
    if view.orthographic == 1u {
        return Ray(vec3f(across, 0.0), vec3f(0.0, 0.0, -1.0));
    }
    return Ray(vec3f(0.0), vec3f(across, -1.0));
}
