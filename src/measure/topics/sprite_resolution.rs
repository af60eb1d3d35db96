//! Resolution of a lens' depth sprite (S4): a coarser one is drawn faster and puts the lens' border in the wrong place.

use crate::{
    lens::LensSprite,
    measure::{
        Knob, Quantity, Topic, Trial, Value, Variant,
        stage::{Stage, lens},
    },
    render::picture::RenderError,
};

/// Share of the picture that the lens covers.
const SHARE: f64 = 0.2;

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "sprite-resolution",
    title: "Resolution of depth sprites",
    about: "How coarse the depth sprite of a lens may be before its border is in the wrong place.",
    specs: &["U1", "S4"],
    reference: "the same lens, tested from its shape",
    knobs: &[Knob { name: "texels per pixel", unit: "" }, Knob { name: "sprite_resolution", unit: "px" }],
    x: Quantity::WrongMask,
    y: &[Quantity::Ratio],
    front: [Quantity::WrongMask, Quantity::Ratio],
    alike: &[],
    series: &[],
    make,
};

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let sphere = stage.sphere_covering(SHARE)?;
    let longer = stage.size[0].max(stage.size[1]);
    let shot = |sprite: Option<LensSprite>| {
        let mut scene = plain.clone();
        scene.lenses = vec![lens("lens", sphere.clone(), &["greyscale"])];
        scene.lenses[0].sprite = sprite;
        stage.shot(scene, 1)
    };
    let variant = |divisor: u32| {
        let resolution = (longer / divisor).max(1);
        Variant {
            label: if divisor == 1 { "1 texel per pixel".to_owned() } else { format!("1/{divisor}") },
            knobs: vec![Value::Number(1.0 / f64::from(divisor)), Value::Number(f64::from(resolution))],
            shot: shot(Some(LensSprite { resolution: Some(resolution) })),
            reference: None,
        }
    };
    let variants = [1, 2, 4, 8, 16, 32].map(variant).into();
    Ok(Trial { plain: stage.shot(plain.clone(), 1), reference: shot(None), variants })
}
