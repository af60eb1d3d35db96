//! name = "cel"
//! kind = "scene"
//! spec = "Trapp §3.5"
//! doc = "Light in few steps with hard borders, like a drawn film."
//!
//! [[parameter]]
//! name = "steps"
//! type = "number"
//! range = [2, 6]
//! default = 3
//! unit = "steps"
//! doc = "How many steps of light."
//!
//! [[parameter]]
//! name = "shadow"
//! type = "number"
//! range = [0, 1]
//! default = 0.42
//! doc = "Light in the darkest step; the brightest has 1."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let arriving = point.sun * max(dot(point.normal, light.to_sun), 0.0);
    // Grazing light is light: the first border lies near the terminator, not in the middle of it.
    let step = min(floor(sqrt(arriving) * p.steps), p.steps - 1.0) / (p.steps - 1.0);
    return point.base * mix(p.shadow, 1.0, step);
}
