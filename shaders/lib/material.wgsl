// Materials of surfaces, as far as handlers may change them.

struct Material {
    base: vec3f,                // diffuse colour, linear
    emission: vec3f,            // light of its own, linear
    specular: vec3f,            // colour of its highlights, linear
    shininess: f32,             // exponent of Blinn and Phong, at least 1
}

// Light that does not come out of the diffuse colour: it stays when another lens changes that.
fn highlights(material: Material, point: Point) -> vec3f {
    let halfway = normalize(light.to_sun - normalize(point.relative));
    let gloss = pow(max(dot(point.normal, halfway), 0.0), material.shininess);
    return material.emission + material.specular * (gloss * point.sun) * light.sun;
}

fn blended_material(mode: u32, below: Material, above: Material, weight: f32) -> Material {
    return Material(
        weighed(below.base, blend(mode, below.base, above.base), weight),
        weighed(below.emission, blend(mode, below.emission, above.emission), weight),
        weighed(below.specular, blend(mode, below.specular, above.specular), weight),
        mix(below.shininess, above.shininess, weight),
    );
}

fn contained_material(material: Material) -> Material {
    return Material(contained(material.base), contained(material.emission), contained(material.specular),
                    clamp(material.shininess, 1.0, 1024.0));
}

fn material_as_is(material: Material) -> Material {
    return Material(as_is(material.base), as_is(material.emission), as_is(material.specular), number_as_is(material.shininess));
}
