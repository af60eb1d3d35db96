//! Lenses that change nothing.

use glam::DVec3;

use crate::{
    geom::Shape,
    lens::{Class, EffectUse, Lens, LensBody, LensSprite},
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{cameras, ids, is_same, lens, picture_by, scene, used},
    },
    render::{frame::Backend, picture::RenderError},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "identity lens",
    case: "20",
    property: "a lens that changes nothing changes no byte of colour, distance, object or normal, by either back end",
    oracle: "the picture without it",
    unit: "pictures",
    least: 20,
    run,
};

const SIZE: [u32; 2] = [217, 131];

/// Lenses that change nothing, each in its own way.
fn identities(middle: DVec3) -> Vec<Lens> {
    let ball = Shape::Sphere { center: middle, radius: 35.0 };
    let plain = |name: &str, effects: Vec<EffectUse>| Lens { effects, ..lens(name, ball.clone(), "sepia") };
    let mut all = vec![
        plain("of no effect", Vec::new()),
        Lens { enabled: false, body: LensBody::Outline, ..plain("disabled", vec![used("eraser")]) },
        Lens { sprite: Some(LensSprite::default()), ..plain("by its sprite", Vec::new()) },
        lens("eraser beside the city", Shape::Sphere { center: middle + DVec3::Z * 900.0, radius: 90.0 }, "eraser"),
    ];
    for (i, name) in ["sepia", "gooch", "blur", "overlay", "marble", "cel"].into_iter().enumerate() {
        let class = [Class::Inside, Class::Front, Class::Behind, Class::Rest][i % 4];
        let effect = EffectUse { class, weight: Some(1e-30), ..used(name) };
        all.push(plain(&format!("{name} of hardly any weight"), vec![effect]));
    }
    all
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let middle = studio.extent().center();
    for camera in cameras(&studio).into_iter().take(2) {
        let plain = picture_by(&mut studio, &scene(camera, Vec::new()), SIZE, Backend::Specialised)?;
        let shown = ids(&plain).iter().filter(|id| **id != 0).count();
        found.ask(shown > 1_000, || format!("{shown} pixels show the city"));
        for lens in identities(middle) {
            for backend in [Backend::Specialised, Backend::Uber] {
                let drawn = picture_by(&mut studio, &scene(camera, vec![lens.clone()]), SIZE, backend)?;
                found.ask(is_same(&plain, &drawn), || {
                    let changed = (0..plain.rgba.len()).filter(|&i| plain.rgba[i] != drawn.rgba[i]).count();
                    format!("{} by {backend:?}: {changed} pixels have another colour", lens.name)
                });
            }
            if !found.goes_on() {
                return Ok(());
            }
        }
    }
    Ok(())
}
