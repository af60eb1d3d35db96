//! name = "film"
//! kind = "opacity"
//! spec = "Trapp §3.3"
//! doc = "Makes what lies on the ground a translucent film on it: of faces in one plane the uppermost alone is seen, not all of them one through the other."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "opacity"
//! type = "number"
//! range = [0, 1]
//! default = 0.7
//! doc = "Of the film: 0 = nothing of it is seen, 1 = nothing of the ground."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay opaque."

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    return select(p.opacity, 0.0, point.is_covered);
}
