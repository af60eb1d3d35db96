//! Methods of lenses that bend rays: how near images and moved corners come to exact rays, and what each costs.

use glam::DVec2;

use crate::{
    lens::{
        Lens, LensBody, LensKind,
        kind::{FisheyeLens, Magnifier, SamplingLens},
        ray::{Bend, Fisheye, FisheyeProjection, RayLens, RayMethod},
    },
    measure::{
        quantity::Quantity,
        stage::Stage,
        topic::{Knob, Slope, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
    scene::Scene,
};

/// Share of the picture that the small magnifier covers.
const SHARE: f64 = 0.1;
/// How finely images and corners are.
const FINENESS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "ray-lenses",
    title: "How what lenses show that bend rays is found",
    about: "How near images and moved corners come to exact rays, by how fine they are, and what each method costs, in four lenses.",
    sources: &["Wang et al. §3"],
    reference: "the same lens by exact rays",
    knobs: &[Knob { name: "lens", unit: "" }, Knob { name: "method", unit: "" }, Knob { name: "fineness", unit: "" }],
    x: Quantity::WrongPixels,
    y: &[Quantity::Ratio],
    front: [Quantity::WrongPixels, Quantity::Ratio],
    alike: &[0],
    series: &[1],
    panels: Some(0),
    notes: Some(2),
    slope: Some(Slope { knob: 2, error: Quantity::WrongPixels, above: 0.0 }),
    restarts: true,
    make,
};

/// The lenses: a magnifier over a tenth of the picture and one over much of it, a sampling-rate lens, a fisheye.
fn lenses(aspect: f64) -> [(&'static str, LensKind); 4] {
    let small = (SHARE * aspect / std::f64::consts::PI).sqrt();
    let bend = Fisheye { angle: 270_f64.to_radians(), projection: FisheyeProjection::Angular };
    let around = RayLens { bend: Bend::Fisheye(bend), ..RayLens::fisheye() };
    [
        ("magnifier, a tenth", Magnifier { ray: RayLens { radius: small, ..RayLens::magnifier() } }.into()),
        ("magnifier", Magnifier { ray: RayLens { radius: 0.45, ..RayLens::magnifier() } }.into()),
        ("sampling rate", SamplingLens { ray: RayLens { radius: 0.45, ..RayLens::sampling() } }.into()),
        ("fisheye, 270°", FisheyeLens { ray: RayLens { center: DVec2::splat(0.5), ..around } }.into()),
    ]
}

/// The methods that are compared, and how finely.
fn methods() -> Vec<(RayMethod, &'static str, Option<f64>)> {
    let mut all = vec![(RayMethod::Rays, "rays", None)];
    for (method, word) in [(RayMethod::Image, "image"), (RayMethod::Vertices, "vertices")] {
        all.extend(FINENESS.map(|fineness| (method, word, Some(fineness))));
    }
    all
}

fn with_lens(scene: &Scene, mut kind: LensKind, method: RayMethod, fineness: f64) -> Scene {
    if let Some(ray) = kind.ray_mut() {
        (ray.method, ray.fineness) = (method, fineness);
    }
    let lens = Lens { body: LensBody::None, ..Lens::plain("lens", kind, [0.8, 0.2, 0.1]) };
    Scene { lenses: vec![lens], ..scene.clone() }
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let scene = stage.plain_scene();
    let [width, height] = stage.size.map(f64::from);
    let default = RayLens::magnifier();
    let mut variants = Vec::new();
    for (name, kind) in lenses(width / height) {
        let exact = with_lens(&scene, kind.clone(), RayMethod::Rays, 1.0);
        for (method, word, fineness) in methods() {
            let is_default = method == default.method && fineness.is_none_or(|own| own == default.fineness);
            let number = fineness.map_or_else(String::new, |fineness| format!(" {fineness}"));
            let mark = if is_default { " (default)" } else { "" };
            variants.push(Variant {
                label: format!("{name}, {word}{number}{mark}"),
                knobs: vec![
                    Value::Text(name.to_owned()),
                    Value::Text(format!("{word}{mark}")),
                    fineness.map_or_else(|| Value::Text("-".to_owned()), Value::Number),
                ],
                shot: stage.shot(with_lens(&scene, kind.clone(), method, fineness.unwrap_or(1.0)), 1),
                reference: Some(stage.shot(exact.clone(), 1)),
                mask: None,
                exact: None,
            });
        }
    }
    let plain = stage.shot(scene, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}
