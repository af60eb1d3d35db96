//! name = "flat"
//! kind = "scene"
//! spec = "Trapp §3.5"
//! doc = "Surfaces in their own colours, without light: a map seen in perspective."
//!
//! [[parameter]]
//! name = "relief"
//! type = "number"
//! range = [0, 1]
//! default = 0.18
//! doc = "How much darker walls are than roofs and ground, so that buildings keep their form."
//!
//! [[parameter]]
//! name = "shadows"
//! type = "number"
//! range = [0, 1]
//! default = 0
//! doc = "How dark shadows are that the sun casts on what faces it; the scene says whether it casts some."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let upright = 1.0 - abs(point.normal.z);
    // Walls that face east or west are a little darker than those that face north or south.
    let turned = 0.75 + 0.25 * abs(point.normal.x);
    let dark = select(0.0, 1.0 - point.sun, dot(point.normal, light.to_sun) > 0.0);
    return point.base * ((1.0 - p.relief * upright * turned) * (1.0 - p.shadows * dark));
}
