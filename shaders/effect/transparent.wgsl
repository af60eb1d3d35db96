//! name = "transparent"
//! kind = "opacity"
//! spec = "Trapp §3.3"
//! doc = "Makes the city translucent, the same everywhere; order does not matter, every layer counts."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "opacity"
//! type = "number"
//! range = [0, 1]
//! default = 0.25
//! doc = "Of one layer: 0 = nothing of it is seen, 1 = nothing behind it."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay opaque."

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    return p.opacity;
}
