//! name = "coming-lines"
//! kind = "post"
//! spec = "Tiesel §4.2.2"
//! doc = "The edges of what is not there yet, where a time operator `ghost` says how long before. A lens with such an operator has it by itself; to draw them in other ways, give it."
//! lines = true
//!
//! [[parameter]]
//! name = "line_color"
//! type = "color"
//! default = "#1f6fb2"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "line_width"
//! type = "number"
//! range = [0.1, 16]
//! default = 0.6
//! unit = "points"
//! doc = "Width of the lines."
//!
//! [[parameter]]
//! name = "faces_front"
//! type = "boolean"
//! default = true
//! doc = "Edges whose faces all look away from the eye have none; silhouettes between faces that go on flat have one."
//!
//! [[parameter]]
//! name = "fades"
//! type = "boolean"
//! default = true
//! doc = "Lines of far things are weaker."
//!
//! [[parameter]]
//! name = "keep_terrain"
//! type = "boolean"
//! default = true
//! doc = "Terrain, roads, water, land use and the plain ground have none."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return color;
}
