//! Refinement of what deformations bend: how far edges are off, against triangles and time.

use crate::{
    geom::Shape,
    lens::{
        Lens,
        deform::{Deform, Step},
        kind::Deformation,
    },
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Knob, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
    scene::Scene,
};

/// Share of the city's plan that the lens is over.
const SHARE: f64 = 0.1;

/// The distances by which edges may be off, pixels; the last one is what all others are compared with.
const CHORDS_PX: [f64; 8] = [16.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625];

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "refinement",
    title: "How fine what is deformed is split",
    about: "How many triangles and how much time it takes that edges are as near to where they should be as is asked for, in a view that is drawn for the first time.",
    sources: &["Trapp §3.6"],
    reference: "the same deformation with edges that are at most 1/32 pixel off",
    knobs: &[Knob { name: "deformation", unit: "" }, Knob { name: "asked for", unit: "px" }],
    x: Quantity::Chord,
    y: &[Quantity::Ratio, Quantity::Triangles],
    front: [Quantity::Chord, Quantity::Ratio],
    alike: &[0],
    series: &[0],
    panels: None,
    notes: Some(1),
    slope: None,
    restarts: false,
    make,
};

/// The deformations of the middle of the city.
fn kinds() -> Vec<(&'static str, Vec<Step>)> {
    let taper = Step::Taper { factor: 0.8 };
    let twist = |degrees: f64| Step::Twist { angle: degrees.to_radians() };
    let bend = Step::Bend { angle: 30_f64.to_radians() };
    vec![("twist", vec![twist(25.0)]), ("bend", vec![bend.clone()]), ("chain", vec![taper, twist(12.0), bend])]
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let extent = stage.studio.extent();
    let side = SHARE.sqrt() * extent.size();
    let shape = Shape::Box {
        center: extent.center(),
        size: side.with_z(extent.size().z.max(1.0)),
        rotation: glam::DQuat::IDENTITY,
    };
    let of = |steps: &[Step], chord_px: f64| -> Scene {
        let deform = Deform { steps: steps.to_vec(), control: None, strength: 1.0 };
        let moved = Lens { kind: Deformation::from(deform).into(), ..lens("moved", shape.clone(), &[]) };
        let mut scene = Scene { lenses: vec![moved], ..plain.clone() };
        scene.style.chord_px = chord_px;
        scene
    };
    let mut variants = Vec::new();
    for (name, steps) in kinds() {
        for chord_px in CHORDS_PX {
            let mut shot = stage.shot(of(&steps, chord_px), 1);
            // The frame before is the plain one: all is refined anew.
            shot.before = Some(plain.clone());
            variants.push(Variant {
                label: format!("{name}, {chord_px} px"),
                knobs: vec![Value::Text(name.to_owned()), Value::Number(chord_px)],
                shot,
                reference: Some(stage.shot(of(&steps, 0.03125), 1)),
                mask: None,
                exact: None,
            });
        }
    }
    let plain = stage.shot(plain, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}
