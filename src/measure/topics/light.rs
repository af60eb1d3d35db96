//! Samples of sun and sky: how near soft shadows and ambient occlusion come to those of exact rays.

use std::sync::Arc;

use crate::{
    measure::{
        light_by_rays::LightByRays,
        quantity::Quantity,
        stage::Stage,
        topic::{Exact, Knob, Slope, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
    scene::{Scene, Sun},
};

/// Samples that are compared.
const SAMPLES: [u32; 7] = [1, 4, 8, 16, 32, 64, 128];
/// From how near the second view looks, of the first one's distance.
const NEARER: f64 = 0.3;

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "light",
    title: "Samples of sun and sky",
    about: "How near soft shadows and ambient occlusion come to those of exact rays, with more samples, from far and from near.",
    sources: &[],
    reference: "the same picture with 128 samples; errors are those against rays in f64, 233 to the sun and 987 to the sky from each place",
    knobs: &[Knob { name: "view", unit: "" }, Knob { name: "samples", unit: "" }],
    x: Quantity::RmsError,
    y: &[Quantity::Ratio],
    front: [Quantity::RmsError, Quantity::Ratio],
    alike: &[0],
    series: &[0],
    panels: None,
    notes: Some(1),
    slope: Some(Slope { knob: 1, error: Quantity::RmsError, above: 1.0 }),
    restarts: false,
    make,
};

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let far = Scene { sun: Sun::default(), ..plain.clone() };
    let mut near = far.clone();
    if let Some(camera) = &mut near.camera {
        camera.eye = camera.target + NEARER * (camera.eye - camera.target);
    }
    let mut variants = Vec::new();
    for (name, scene) in [("far", far), ("near", near)] {
        let exact = Arc::new(LightByRays::new(stage.studio, &scene, stage.size)?);
        let most = SAMPLES[SAMPLES.len() - 1];
        variants.extend(SAMPLES.map(|samples| Variant {
            label: format!("{name}, {samples}"),
            knobs: vec![Value::Text(name.to_owned()), Value::Number(f64::from(samples))],
            shot: stage.shot(scene.clone(), samples),
            reference: Some(stage.shot(scene.clone(), most)),
            mask: None,
            exact: Some(Exact::Light(Arc::clone(&exact))),
        }));
    }
    let plain = stage.shot(plain, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}
