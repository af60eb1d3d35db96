//! name = "hidden-line"
//! kind = "scene"
//! spec = "Trapp §3.5, Tiesel §3"
//! doc = "A line drawing: edges of polygons and creases that are seen, on paper."
//! lines = true
//!
//! [[parameter]]
//! name = "paper"
//! type = "color"
//! default = "#f7f4ec"
//! doc = "Colour of the paper."
//!
//! [[parameter]]
//! name = "shading"
//! type = "number"
//! range = [0, 1]
//! default = 0.15
//! doc = "How much light and shade the paper shows."
//!
//! [[parameter]]
//! name = "line_color"
//! type = "color"
//! default = "#26221d"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "line_width"
//! type = "number"
//! range = [0.1, 16]
//! default = 0.9
//! unit = "points"
//! doc = "Width of the lines."
//!
//! [[parameter]]
//! name = "flat_edges"
//! type = "boolean"
//! default = false
//! doc = "Also edges between faces that go on flat."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return p.paper * (mix(1.0, point.shade, p.shading) * mix(1.0, point.facade, 0.5));
}
