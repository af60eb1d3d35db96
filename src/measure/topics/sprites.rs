//! Depth sprites: formats, mappings and resolutions against the lens in f64. Ropinski and Hinrichs' Table 1, with accuracy.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::{
    geom::{Shape, combination::Operation},
    lens::{
        LensSprite, Region,
        sprite::{Format, Mapping},
    },
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Knob, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
};

/// Share of the picture that the sphere covers; the other shapes are about as large.
const SHARE: f64 = 0.2;

/// Texels along the longer side of the picture.
const RESOLUTIONS: [u32; 5] = [128, 256, 512, 1024, 2048];
/// That at which formats and mappings are compared.
const MIDDLE: u32 = 512;

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "sprites",
    title: "Formats, mappings and resolutions of depth sprites",
    about: "What format, mapping and resolution of a lens' depth sprite cost, and how many pixels they put on its wrong side.",
    sources: &["Trapp §3.1", "Ropinski & Hinrichs, table 1"],
    reference: "the lens tested from its shape; for its mask, the shape in f64 at the shown places",
    knobs: &[
        Knob { name: "shape", unit: "" },
        Knob { name: "format", unit: "" },
        Knob { name: "mapping", unit: "" },
        Knob { name: "resolution", unit: "texels" },
    ],
    x: Quantity::WrongMask,
    y: &[Quantity::Memory, Quantity::Ratio],
    front: [Quantity::WrongMask, Quantity::Memory],
    alike: &[0],
    series: &[0],
    panels: None,
    notes: None,
    slope: None,
    restarts: true,
    make,
};

/// The sprites that are compared for a shape: all formats with all mappings (`is_full`) or the default one, and all resolutions.
fn sprites(is_full: bool) -> Vec<LensSprite> {
    let at = |resolution, format, mapping| LensSprite {
        resolution: Some(resolution),
        format,
        mapping,
        ..LensSprite::default()
    };
    let mut all = Vec::new();
    for (_, format) in Format::WORDS {
        let mappings = Mapping::WORDS.into_iter().map(|(_, mapping)| mapping);
        let wanted = mappings.filter(|mapping| is_full || *mapping == Mapping::default());
        all.extend(wanted.map(|mapping| at(MIDDLE, format, mapping)));
    }
    for resolution in RESOLUTIONS.into_iter().filter(|r| *r != MIDDLE) {
        all.push(at(resolution, Format::Float32, Mapping::InverseW));
        all.extend(is_full.then(|| at(resolution, Format::Unorm16, Mapping::W)));
    }
    all
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let shapes = shapes(stage.sphere_covering(SHARE)?);
    let mut variants = Vec::new();
    for (name, focus) in &shapes {
        let mut scene = plain.clone();
        scene.lenses = vec![lens("lens", focus.clone(), &["greyscale"])];
        let analytic = stage.shot(scene.clone(), 1);
        let mask = Arc::new(stage.mask_in_f64(&plain, focus)?);
        for sprite in sprites(*name == "sphere") {
            scene.lenses[0].sprite = Some(sprite);
            let (format, mapping) = (sprite.format.word(), sprite.mapping.word());
            let resolution = sprite.resolution.unwrap_or_default();
            variants.push(Variant {
                label: format!("{name}, {format}, {mapping}, {resolution}"),
                knobs: vec![
                    Value::Text((*name).to_owned()),
                    Value::Text(format.to_owned()),
                    Value::Text(mapping.to_owned()),
                    Value::Number(f64::from(resolution)),
                ],
                shot: stage.shot(scene.clone(), 1),
                reference: Some(analytic.clone()),
                mask: Some(mask.clone()),
                exact: None,
            });
        }
    }
    let plain = stage.shot(plain, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}

/// The shapes, about a sphere.
fn shapes(sphere: Shape) -> Vec<(&'static str, Region)> {
    let Shape::Sphere { center, radius } = sphere else { return Vec::new() };
    let rotation = DQuat::from_rotation_z(0.5) * DQuat::from_rotation_x(0.3);
    let size = DVec3::new(1.9, 1.5, 1.3) * radius;
    // The sphere with a slab cut out of it: rays enter and leave it twice.
    let slab = Shape::Box { center, size: DVec3::new(3.0, 0.6, 3.0) * radius, rotation };
    let bitten = Region::Combined { how: Operation::Difference, parts: vec![sphere.clone().into(), slab.into()] };
    vec![("sphere", sphere.into()), ("box", Shape::Box { center, size, rotation }.into()), ("concave", bitten)]
}
