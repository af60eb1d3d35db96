//! name = "peel"
//! kind = "opacity"
//! spec = "Trapp §3.3"
//! doc = "Layers grow denser with their number along the ray: the nearest is clear, the last one opaque."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "count"
//! type = "word"
//! words = ["pixel", "image"]
//! default = "pixel"
//! doc = "Which layer is opaque: the last of the pixel (the number jumps at silhouettes) or the last of all pixels' largest number."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay opaque."

fn effect(opacity: f32, point: Point, p: Parameters) -> f32 {
    let last = f32(select(point.last_layer, most_layers() - 1u, p.count == COUNT_IMAGE));
    let t = f32(point.layer) / max(last, 1.0);
    // One layer alone is opaque.
    return select(t * t * (3.0 - 2.0 * t), 1.0, last == 0.0);
}
