//! name = "own-ray"
//! kind = "ray"
//! spec = "Wang et al. §3"
//! doc = "The pixel's own ray, straight from the eye."

fn effect(pixel: vec2f) -> Ray {
    let across = pixel * view.across_from_pixel.xy + view.across_from_pixel.zw;
    let is_flat = view.orthographic == 1u;
    return Ray(vec3f(select(vec2f(0.0), across, is_flat), 0.0), vec3f(select(across, vec2f(0.0), is_flat), -1.0));
}
