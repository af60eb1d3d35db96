//! name = "velvet"
//! kind = "material"
//! spec = "Tiesel §3"
//! doc = "Cloth with a pile: deep where one looks onto it, and a sheen where one looks along it."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#9c1024"
//! doc = "Colour of the cloth."
//!
//! [[parameter]]
//! name = "own"
//! type = "number"
//! range = [0, 1]
//! default = 0.15
//! doc = "How much of what is below shows through the dye."
//!
//! [[parameter]]
//! name = "sheen"
//! type = "color"
//! default = "#ff8f8a"
//! doc = "Colour of the sheen."
//!
//! [[parameter]]
//! name = "strength"
//! type = "number"
//! range = [0, 4]
//! default = 1
//! doc = "How strong the sheen is."
//!
//! [[parameter]]
//! name = "glance"
//! type = "number"
//! range = [1, 16]
//! default = 3
//! doc = "Exponent: the larger, the nearer to grazing the sheen begins."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    let facing = abs(dot(point.normal, normalize(point.relative)));
    var changed = material;
    // Between the fibres it is dark.
    let depth = mix(1.0, 0.7, facing);
    changed.base = depth * mix(p.color, p.color * material.base, p.own);
    // Fibres that stand up scatter what light there is towards an eye that looks across their tips.
    let grazing = pow(1.0 - facing, p.glance);
    changed.emission += p.sheen * (p.strength * grazing) * irradiance(point.normal, point.sun);
    return changed;
}
