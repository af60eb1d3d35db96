//! name = "wireframe"
//! kind = "hide"
//! spec = "Trapp §3.5, Tiesel §3"
//! doc = "Edges of polygons and creases as lines, in front and behind, without the surfaces between them."
//! lines = true
//!
//! [[parameter]]
//! name = "line_color"
//! type = "color"
//! default = "#1f3247"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "line_width"
//! type = "number"
//! range = [0.1, 16]
//! default = 0.825
//! unit = "points"
//! doc = "Width of the lines."
//!
//! [[parameter]]
//! name = "flat_edges"
//! type = "boolean"
//! default = false
//! doc = "Also edges between faces that go on flat."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground stay, without lines."

fn effect(fragment: Fragment, p: Parameters) -> bool {
    return !(p.keep_terrain && fragment.part == PART_TERRAIN);
}
