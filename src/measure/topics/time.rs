//! Time lenses: one pass in which every place asks which moment shows there, against a pass for each instant.

use glam::DVec3;

use crate::{
    geom::Shape,
    lens::{Lens, epoch::set_to},
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Knob, Shot, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
    scene::Scene,
    time::{Moment, Span},
};

/// The numbers of lenses.
const COUNTS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
/// Share of the picture that one of them covers.
const SHARE: f64 = 0.04;
/// How far one is from the next on their spiral, in radii: they overlap.
const APART: f64 = 0.8;

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "time",
    title: "Time lenses",
    about: "What 1 to 64 time lenses that overlap cost in one pass over the city, which asks at each place when it is, against a frame for each instant without putting them together.",
    sources: &["Tiesel §4.2"],
    reference: "the variant itself: both show what is there at each place's moment, to the byte",
    knobs: &[Knob { name: "technique", unit: "" }, Knob { name: "lenses", unit: "" }],
    x: Quantity::Knob(1),
    y: &[Quantity::Ratio],
    front: [Quantity::WrongPixels, Quantity::Ratio],
    alike: &[1],
    series: &[0],
    panels: None,
    notes: None,
    slope: None,
    restarts: false,
    make,
};

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let mut now = stage.plain_scene();
    let [first, last] = stage.studio.lifetimes(&now)?.span.ok_or_else(|| {
        let message = "no object of the city comes or goes; one with dates, as builtin:town, would be right";
        RenderError::Scene(message.to_owned())
    })?;
    now.moment = Some(last);
    let sphere = stage.sphere_covering(SHARE)?;
    let basis = stage.studio.camera(&now, stage.size).basis()?;
    let at = |i: usize, count: usize| {
        let share = (i + 1) as f64 / (count + 1) as f64;
        first.shifted(Span::of_micros(((last - first) as f64 * share) as i64))
    };
    let mut variants = Vec::new();
    for count in COUNTS {
        let moments: Vec<Moment> = (0..count).map(|i| at(i, count)).collect();
        let mut one_pass = now.clone();
        one_pass.lenses = moments.iter().enumerate().map(|(i, at)| time_lens(i, &sphere, &basis.right, *at)).collect();
        let shown_at = |moment: &Moment| Scene { moment: Some(*moment), ..now.clone() };
        let passes = Shot { also: moments.iter().map(shown_at).collect(), ..stage.shot(now.clone(), 1) };
        for (technique, shot) in [("one pass", stage.shot(one_pass, 1)), ("a pass an instant", passes)] {
            variants.push(Variant {
                label: format!("{count}, {technique}"),
                knobs: vec![Value::Text(technique.to_owned()), Value::Number(count as f64)],
                reference: Some(shot.clone()),
                shot,
                mask: None,
                exact: None,
            });
        }
    }
    let plain = stage.shot(now, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}

/// The lens of a number on a spiral over the ground around the first.
fn time_lens(number: usize, first: &Shape, right: &DVec3, at: Moment) -> Lens {
    let Shape::Sphere { center, radius } = *first else { return lens("time", first.clone(), &[]) };
    let (turn, out) = (2.4 * number as f64, APART * (number as f64).sqrt());
    let away = glam::DQuat::from_rotation_z(turn) * *right * (out * radius);
    let mut own = lens(&format!("time {number}"), Shape::Sphere { center: center + away, radius }, &[]);
    own.time = vec![set_to(at)];
    own
}
