//! name = "lambert"
//! kind = "scene"
//! mode = "optional"
//! spec = "Trapp §3.5"
//! doc = "Matt surfaces in their own colours."

fn effect(color: vec3f, point: Point) -> vec3f {
    return select(point.base, point.base * point.arriving, point.lit) + point.emission;
}
