//! The two back ends of handlers: one module for all that a scene may ask for, or one for just what it does.

use crate::{
    geom::Shape,
    lens::Lens,
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Knob, Shot, Topic, Trial, Value, Variant},
    },
    render::{frame::Backend, picture::RenderError},
};

/// Share of the picture that the lens covers.
const SHARE: f64 = 0.1;

/// The numbers of effects.
const COUNTS: [usize; 6] = [0, 1, 2, 4, 8, 16];

/// The effects, over and over.
const EFFECTS: [&str; 8] = ["sepia", "saturate", "darken", "posterise", "brighten", "invert", "greyscale", "overlay"];

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "handlers",
    title: "Uber shader or specialised shaders",
    about: "What effects and overlapping lenses cost in the uber and in the specialised back end, drawn and compiled.",
    sources: &["Trapp §3.7"],
    reference: "the same scene in the specialised back end",
    knobs: &[
        Knob { name: "effects", unit: "" },
        Knob { name: "arrangement", unit: "" },
        Knob { name: "back end", unit: "" },
    ],
    x: Quantity::Knob(0),
    y: &[Quantity::Ratio, Quantity::StartMs, Quantity::Memory],
    front: [Quantity::StartMs, Quantity::Ratio],
    alike: &[0, 1],
    series: &[1, 2],
    panels: None,
    notes: None,
    slope: None,
    restarts: true,
    make,
};

/// The way in which effects come together.
#[derive(Clone, Copy)]
enum Arrangement {
    /// One lens with all of them.
    OneLens,
    /// As many lenses of one place, each with one.
    ManyLenses,
}

impl Arrangement {
    fn name(self) -> &'static str {
        match self {
            Self::OneLens => "one lens",
            Self::ManyLenses => "a lens each",
        }
    }

    fn lenses(self, count: usize, shape: &Shape) -> Vec<Lens> {
        let effects: Vec<&str> = EFFECTS.into_iter().cycle().take(count).collect();
        match self {
            Self::OneLens if count == 0 => Vec::new(),
            Self::OneLens => vec![lens("lens", shape.clone(), &effects)],
            Self::ManyLenses => {
                let one = |(i, effect): (usize, &&str)| lens(&format!("lens {i}"), shape.clone(), &[*effect]);
                effects.iter().enumerate().map(one).collect()
            }
        }
    }
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let sphere = stage.sphere_covering(SHARE)?;
    let mut variants = Vec::new();
    for arrangement in [Arrangement::OneLens, Arrangement::ManyLenses] {
        for count in COUNTS {
            let mut scene = plain.clone();
            scene.lenses = arrangement.lenses(count, &sphere);
            let specialised = stage.shot(scene, 1);
            for (name, backend) in [("specialised", Backend::Specialised), ("uber", Backend::Uber)] {
                let mut shot: Shot = specialised.clone();
                shot.request.backend = backend;
                variants.push(Variant {
                    label: format!("{count}, {}, {name}", arrangement.name()),
                    knobs: vec![
                        Value::Number(count as f64),
                        Value::Text(arrangement.name().to_owned()),
                        Value::Text(name.to_owned()),
                    ],
                    shot,
                    reference: Some(specialised.clone()),
                    mask: None,
                    exact: None,
                });
            }
        }
    }
    let plain = stage.shot(plain, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}
