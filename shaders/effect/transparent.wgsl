//! name = "transparent"
//! kind = "opacity"
//! spec = "O1, O3"
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
//!
//! [[parameter]]
//! name = "attribute"
//! type = "text"
//! without = "all objects"
//! doc = "Only objects that have this attribute; an object without it takes its parent's."
//!
//! [[parameter]]
//! name = "values"
//! type = "texts"
//! without = "any"
//! doc = "Only where the attribute is one of these."
//!
//! [[parameter]]
//! name = "min"
//! type = "number"
//! without = "none"
//! unit = "the attribute's"
//! doc = "Only where the attribute is at least this."
//!
//! [[parameter]]
//! name = "max"
//! type = "number"
//! without = "none"
//! unit = "the attribute's"
//! doc = "Only where the attribute is at most this."
//!
//! [[parameter]]
//! name = "except"
//! type = "boolean"
//! default = false
//! doc = "The objects that the attribute chooses stay opaque, and the others do not."

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    return p.opacity;
}
