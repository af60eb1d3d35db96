//! name = "gloss"
//! kind = "material"
//! spec = "Trapp §3.5, Tiesel §3"
//! doc = "Polished surfaces: highlights of the sun (Phong, with Blinn's halfway vector)."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#ffffff"
//! doc = "Colour of the highlights."
//!
//! [[parameter]]
//! name = "shininess"
//! type = "number"
//! range = [1, 512]
//! default = 24
//! doc = "Exponent: the larger, the smaller and sharper the highlights."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    var changed = material;
    changed.specular = p.color;
    changed.shininess = p.shininess;
    return changed;
}
