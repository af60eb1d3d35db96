//! name = "screen-door"
//! kind = "hide"
//! spec = "Trapp §3.3"
//! doc = "Thins the city out by a pattern of pixels, a screen door: a share of them shows it, the others what is behind. Samples smooth it."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "opacity"
//! type = "number"
//! range = [0, 1]
//! default = 0.3
//! doc = "Share of the pixels, or of their samples, that show it. From a half on it casts its shadow."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay."

fn effect(fragment: Fragment, p: Parameters) -> bool {
    let is_kept = (fragment.part == PART_TERRAIN && p.keep_terrain) || !is_chosen(p.first, fragment.object);
    // From the other end than what comes and goes: what a fade takes in first goes first, and none of it waits for the others.
    return !is_kept && p.opacity <= 1.0 - fragment.threshold;
}
