//! name = "haze"
//! kind = "air"
//! spec = "Trapp §3.5"
//! doc = "What is beyond the scene fades into the horizon."

fn effect(color: vec3f, point: Point) -> vec3f {
    let air = 1.0 - exp(-max(point.distance - light.scene_radius, 0.0) * view.haze);
    return mix(color, light.horizon, air);
}
