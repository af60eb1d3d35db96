//! name = "eraser"
//! kind = "hide"
//! spec = "Trapp §3.3, Tiesel §3"
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

fn effect(fragment: Fragment, p: Parameters) -> bool {
    let is_terrain = fragment.part == PART_TERRAIN;
    let is_wanted = (p.part == PART_WHOLE && !(is_terrain && p.keep_terrain))
        || (p.part == PART_WALLS && fragment.part == PART_WALL)
        || (p.part == PART_ROOFS && fragment.part == PART_ROOF);
    return is_wanted && is_chosen(p.first, fragment.object);
}
