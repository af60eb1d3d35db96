//! name = "x-ray"
//! kind = "opacity"
//! spec = "Trapp §3.3"
//! doc = "Faces that look at the eye are clear, those seen edge on are denser, and what lies behind a layer is fainter than it: what stands in front is known by its form."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "exponent"
//! type = "number"
//! range = [0, 8]
//! default = 0.6
//! doc = "How soon faces grow dense as they turn away: the opacity is 1 less the cosine to this power; 0 = clear throughout."
//!
//! [[parameter]]
//! name = "least"
//! type = "number"
//! range = [0, 1]
//! default = 0.13
//! doc = "Opacity of a face that looks at the eye."
//!
//! [[parameter]]
//! name = "most"
//! type = "number"
//! range = [0, 1]
//! default = 0.5
//! doc = "Opacity of a face seen edge on."
//!
//! [[parameter]]
//! name = "curve"
//! type = "shares"
//! default = [0, 1]
//! doc = "Ramp of the opacity: how much of the way from `least` to `most`, at equal steps from faces that look at the eye to those seen edge on."
//!
//! [[parameter]]
//! name = "behind"
//! type = "number"
//! range = [0, 1]
//! default = 0.45
//! doc = "How dense a layer is beside the next nearer one of its pixel: the far sides of a house, and rows of houses, do not pile up; 1 = as dense. Where layers have no order (`weighted`, `stochastic`), all are as the nearest."
//!
//! [[parameter]]
//! name = "floors"
//! type = "number"
//! range = [0, 1]
//! default = 0.25
//! doc = "How dense floors are beside other faces (horizontal ones that are neither roof nor terrain): seen edge on from a street, they lie like water at the foot of a house and tell nothing of its form."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay opaque."

// Cosine of how far a floor slopes at most: 8 degrees.
const LEAST_FLOOR: f32 = 0.99;

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    let facing = min(abs(dot(point.normal, towards_eye(point))), 1.0);
    let opacity_of_face = mix(p.least, p.most, share_on_ramp(p.curve, density(facing, p.exponent)));
    let is_floor = point.part == PART_OTHER && abs(point.normal.z) > LEAST_FLOOR;
    return select(1.0, p.floors, is_floor) * opacity_of_face * pow(max(p.behind, 1e-9), f32(point.layer));
}

// 0 where the exponent is, 1 where the face is edge on (below 2^-60), else 1 - facing^exponent.
fn density(facing: f32, exponent: f32) -> f32 {
    let power = exp2(exponent * log2(max(facing, 8.7e-19)));
    return select(select(1.0 - power, 1.0, facing < 8.7e-19), 0.0, exponent == 0.0);
}
