//! Samples per pixel: smoother edges for whole frames more.

use crate::{
    measure::{
        quantity::Quantity,
        stage::Stage,
        topic::{Knob, Shot, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
};

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "samples",
    title: "Samples per pixel",
    about: "How many samples per pixel smooth edges need, and what they cost.",
    sources: &[],
    reference: "the same picture with 64 samples per pixel",
    knobs: &[Knob { name: "samples", unit: "" }],
    x: Quantity::Flip,
    y: &[Quantity::Ratio],
    front: [Quantity::Flip, Quantity::Ratio],
    alike: &[],
    series: &[],
    panels: None,
    notes: None,
    slope: None,
    restarts: true,
    make,
};

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let scene = stage.plain_scene();
    let shot = |samples| -> Shot { stage.shot(scene.clone(), samples) };
    let variant = |samples: u32| Variant {
        label: if samples == 1 { "1 sample".to_owned() } else { samples.to_string() },
        knobs: vec![Value::Number(f64::from(samples))],
        shot: shot(samples),
        reference: None,
        mask: None,
        exact: None,
    };
    Ok(Trial { plain: shot(1), reference: shot(64), variants: [1, 2, 4, 8, 16, 32].map(variant).into() })
}
