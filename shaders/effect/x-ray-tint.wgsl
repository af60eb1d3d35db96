//! name = "x-ray-tint"
//! kind = "scene"
//! spec = "Trapp §3.3"
//! doc = "Colours surfaces by a ramp, from those that look at the eye to those seen edge on; light changes nothing."
//!
//! [[parameter]]
//! name = "exponent"
//! type = "number"
//! range = [0, 8]
//! default = 0.6
//! doc = "How soon faces are taken for edge on as they turn away: the place on the ramp is 1 less the cosine to this power; 0 = its begin."
//!
//! [[parameter]]
//! name = "colors"
//! type = "colors"
//! default = ["#dcebf7", "#6aa5d8", "#1d4f91"]
//! doc = "The ramp, at equal steps; between them linear light is mixed."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let facing = min(abs(dot(point.normal, towards_eye(point))), 1.0);
    return color_on_ramp(p.colors, density(facing, p.exponent));
}

// As that of x-ray.
fn density(facing: f32, exponent: f32) -> f32 {
    let power = exp2(exponent * log2(max(facing, 8.7e-19)));
    return select(select(1.0 - power, 1.0, facing < 8.7e-19), 0.0, exponent == 0.0);
}
