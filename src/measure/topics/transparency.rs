//! Methods of laying translucent layers one over the other: what each costs and leaves out.

use std::sync::Arc;

use glam::DVec2;

use crate::{
    lens::{Class, EffectUse, Lens, Parameter},
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Exact, Knob, Topic, Trial, Value, Variant},
    },
    render::picture::{RenderError, Studio},
    scene::{Scene, Transparency, transparency::SLOTS},
    view::Camera,
};

/// Share of the picture that the lens covers.
const SHARE: f64 = 0.1;
/// Samples per pixel at which layers by chance are compared.
const SAMPLES: [u32; 3] = [1, 4, 16];

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "transparency",
    title: "How translucent layers are laid one over the other",
    about: "What the methods for translucent layers cost and leave out, by how many layers or samples they take, in five views.",
    sources: &["Trapp §3.3"],
    reference: "all layers in their order (`exact`), with as many samples",
    knobs: &[
        Knob { name: "scene", unit: "" },
        Knob { name: "method", unit: "" },
        Knob { name: "layers or samples", unit: "" },
    ],
    x: Quantity::MeanError,
    y: &[Quantity::Ratio],
    front: [Quantity::MeanError, Quantity::Ratio],
    alike: &[0],
    series: &[1],
    panels: Some(0),
    notes: Some(2),
    slope: None,
    restarts: false,
    make,
};

/// Of x-ray: layers that lie behind others are as dense as they, or methods that leave deep ones out would lose nothing.
const EVERY_LAYER: Option<(&str, f64)> = Some(("behind", 1.0));

/// A rule with a number.
fn rule(effect: &str, number: Option<(&str, f64)>) -> EffectUse {
    EffectUse {
        effect: effect.to_owned(),
        class: Class::Inside,
        blend: None,
        weight: None,
        parameters: number.into_iter().map(|(name, value)| (name.to_owned(), Parameter::Number(value))).collect(),
    }
}

/// The scenes that are drawn: the whole city from above, translucent and nearly opaque, from a street, along the ground through all of it, and a
/// lens.
fn scenes(stage: &mut Stage<'_>) -> Result<Vec<(&'static str, Scene)>, RenderError> {
    let plain = stage.plain_scene();
    let of_context = |camera: Option<Camera>, used: EffectUse| -> Scene {
        let mut scene = plain.clone();
        scene.camera = camera.or(scene.camera);
        scene.style.effects = vec![used];
        scene
    };
    let mut of_lens = plain.clone();
    let sphere = stage.sphere_covering(SHARE)?;
    of_lens.lenses = vec![Lens { effects: vec![rule("x-ray", EVERY_LAYER)], ..lens("lens", sphere, &[]) }];
    Ok(vec![
        ("whole city", of_context(None, rule("transparent", Some(("opacity", 0.25))))),
        ("dense", of_context(None, rule("transparent", Some(("opacity", 0.7))))),
        ("street", of_context(Some(low(stage.studio, 0.25, 1.7)), rule("x-ray", EVERY_LAYER))),
        ("many layers", of_context(Some(low(stage.studio, 0.75, 4.0)), rule("transparent", Some(("opacity", 0.05))))),
        ("lens", of_lens),
    ])
}

/// From so far from the middle, in diagonals of the plan, and so high above the ground, towards the middle.
fn low(studio: &Studio, away: f64, height_m: f64) -> Camera {
    let extent = studio.extent();
    let above = |at: DVec2| at.extend(studio.places().ground(at).unwrap_or(extent.min.z) + height_m);
    let middle = extent.center().truncate();
    let eye = middle + away * extent.size().truncate().length() * DVec2::new(-0.6, -0.8);
    Camera::looking(above(eye), above(middle), 45_f64.to_radians())
}

/// The methods that are compared, how many layers or samples stand in the table, and samples.
fn methods() -> Vec<(Transparency, Option<u32>, u32)> {
    let peel = |layers: u32| (Transparency::Peel { layers }, Some(layers).filter(|layers| *layers > 0), 1);
    let slots = |layers| (Transparency::KBuffer { layers }, Some(layers), 1);
    let mut all = vec![(Transparency::Exact, None, 1), peel(0), peel(4), peel(16)];
    all.extend(SLOTS.map(slots));
    all.push((Transparency::Weighted, None, 1));
    all.extend(SAMPLES.map(|samples| (Transparency::Stochastic, Some(samples), samples)));
    all
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let mut variants = Vec::new();
    for (name, scene) in scenes(stage)? {
        let composited = Arc::new(stage.studio.composited_in_f64(&scene, stage.size)?);
        for (method, number, samples) in methods() {
            let mut own = scene.clone();
            own.style.transparency = method;
            let said = number.map_or_else(String::new, |number| format!(" {number}"));
            variants.push(Variant {
                label: format!("{name}, {}{said}", method.word()),
                knobs: vec![
                    Value::Text(name.to_owned()),
                    Value::Text(method.word().to_owned()),
                    number.map_or_else(|| Value::Text("all".to_owned()), |number| Value::Number(f64::from(number))),
                ],
                shot: stage.shot(own, samples),
                reference: Some(stage.shot(scene.clone(), samples)),
                mask: None,
                exact: Some(Exact::Layers(Arc::clone(&composited))),
            });
        }
    }
    let plain = stage.shot(stage.plain_scene(), 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}
