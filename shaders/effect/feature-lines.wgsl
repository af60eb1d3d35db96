//! name = "feature-lines"
//! kind = "post"
//! spec = "Trapp §3.3"
//! doc = "Edges as lines of even width over surfaces that stay, translucent ones too: creases and borders of faces that look at the eye, and the silhouettes of what is round. They are weaker where a line is wider than 0.9 m, a third from 2.7 m on."
//! lines = true
//!
//! [[parameter]]
//! name = "line_color"
//! type = "color"
//! default = "#27313b"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "line_width"
//! type = "number"
//! range = [0.1, 16]
//! default = 0.7
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
