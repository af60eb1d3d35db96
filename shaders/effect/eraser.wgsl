//! name = "eraser"
//! kind = "hide"
//! spec = "O3, C8"
//! doc = "Takes parts of the city away: all of it, walls or roofs alone, or the objects that an attribute chooses."
//! objects = "chosen"
//!
//! [[parameter]]
//! name = "part"
//! type = "word"
//! words = ["whole", "walls", "roofs"]
//! default = "whole"
//! doc = "What goes. Walls have their windows and doors with them; without semantics the slope decides."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay."
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
//! doc = "The objects that the attribute chooses stay, and the others go."

fn effect(fragment: Fragment, p: Parameters) -> bool {
    let is_terrain = fragment.part == PART_TERRAIN;
    let is_wanted = (p.part == PART_WHOLE && !(is_terrain && p.keep_terrain))
        || (p.part == PART_WALLS && fragment.part == PART_WALL)
        || (p.part == PART_ROOFS && fragment.part == PART_ROOF);
    return is_wanted && is_chosen(p.first, fragment.object);
}
