//! name = "glow"
//! kind = "material"
//! spec = "Tiesel §3"
//! doc = "Light of its own, strongest where a surface turns away from the eye; it stays whatever another lens makes of the colour."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#ffb000"
//! doc = "Colour of the light."
//!
//! [[parameter]]
//! name = "strength"
//! type = "number"
//! range = [0, 4]
//! default = 0.55
//! doc = "How strong it is."
//!
//! [[parameter]]
//! name = "rim"
//! type = "number"
//! range = [0, 1]
//! default = 0.6
//! doc = "0: the same everywhere; 1: only where surfaces turn away."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    if point.object == NO_OBJECT {
        return material;
    }
    let facing = abs(dot(point.normal, normalize(point.relative)));
    var changed = material;
    changed.emission += p.color * (p.strength * mix(1.0, (1.0 - facing) * (1.0 - facing), p.rim));
    return changed;
}
