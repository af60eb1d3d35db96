//! Lens tests: from the shape or by a depth sprite, for every kind of shape, and for lenses that are many, overlap or move.
//!
//! A technique is one row of [`TECHNIQUES`]; those that are kept for reference have theirs.

use glam::{DQuat, DVec2, DVec3};

use crate::{
    geom::{Shape, combination::Operation},
    lens::{Lens, LensSprite, Region},
    measure::{
        quantity::Quantity,
        stage::{Stage, lens},
        topic::{Knob, Topic, Trial, Value, Variant},
    },
    render::picture::RenderError,
    scene::{Scene, Technique as Evaluation},
};

/// Share of the picture that a lens alone covers, and one of several.
const SHARES: [f64; 2] = [0.2, 0.1];

/// The numbers of lenses; `branches` ends at 6.
const COUNTS: [usize; 5] = [1, 2, 4, 6, 10];
/// The effects of lenses, in turn.
const EFFECTS: [&str; 6] = ["posterise", "sepia", "engraving", "saturate", "invert", "overlay"];
/// With how many of them still and moving ones are compared.
const MOVING: [usize; 2] = [1, 10];
/// The way of a lens from one frame to the next, as part of its radius.
const STEP: f64 = 0.1;

/// See the module.
pub const TOPIC: Topic = Topic {
    name: "lens-tests",
    title: "How lenses are tested",
    about: "What a lens test from the shape and one by a depth sprite cost, and what the techniques of the literature do, for each kind of shape, and for 1 to 10 lenses.",
    sources: &["Trapp §3.2", "Tiesel §3.4.5"],
    reference: "the same lenses, standing still, tested from their shapes",
    knobs: &[
        Knob { name: "shape", unit: "" },
        Knob { name: "test", unit: "" },
        Knob { name: "lenses", unit: "" },
        Knob { name: "arrangement", unit: "" },
        Knob { name: "motion", unit: "" },
    ],
    x: Quantity::Knob(2),
    y: &[Quantity::Ratio, Quantity::WrongMask, Quantity::Memory],
    front: [Quantity::WrongMask, Quantity::Ratio],
    alike: &[0, 2, 3, 4],
    series: &[1, 3, 4],
    panels: None,
    notes: None,
    slope: None,
    restarts: true,
    make,
};

/// A way to test lenses.
struct Technique {
    name: &'static str,
    /// Has a scene's lenses tested so.
    set: fn(&mut Scene),
    /// For which lenses it can be done.
    fits: fn(&Case) -> bool,
}

const TECHNIQUES: &[Technique] = &[
    Technique { name: "shape", set: |_| {}, fits: |_| true },
    Technique {
        name: "sprite",
        set: |scene| scene.lenses.iter_mut().for_each(|lens| lens.sprite = Some(LensSprite::default())),
        fits: |_| true,
    },
    Technique {
        name: "branches",
        set: |scene| scene.style.technique = Evaluation::Branches,
        fits: |case| is_comparable(case) && case.lenses.len() <= 6,
    },
    Technique { name: "regions", set: |scene| scene.style.technique = Evaluation::Regions, fits: is_comparable },
    Technique {
        name: "three-pass",
        set: |scene| scene.style.technique = Evaluation::ThreePass,
        fits: |case| is_comparable(case) && (case.arrangement == "apart" || case.lenses.len() == 1),
    },
];

/// Whether the techniques of the literature are compared there: what they cost grows with the lenses, and their start-up takes seconds.
fn is_comparable(case: &Case) -> bool {
    case.arrangement != "alone" && case.moved.is_none()
}

/// Where several lenses stand: how far one is from the next, as part of the radius.
const ARRANGEMENTS: [(&str, f64); 2] = [("apart", 2.2), ("overlapping", 0.25)];

/// A case that is measured: lenses, and what stands in the table beside the technique.
struct Case {
    shape: &'static str,
    lenses: Vec<Region>,
    arrangement: &'static str,
    /// The way of all of it from where it stood a frame ago, metres.
    moved: Option<DVec3>,
}

fn make(stage: &mut Stage<'_>) -> Result<Trial, RenderError> {
    let plain = stage.plain_scene();
    let mut cases: Vec<Case> = shapes(stage.sphere_covering(SHARES[0])?)
        .into_iter()
        .map(|(shape, focus)| Case { shape, lenses: vec![focus], arrangement: "alone", moved: None })
        .collect();
    let sphere = stage.sphere_covering(SHARES[1])?;
    let right = stage.studio.camera(&plain, stage.size).basis()?.right;
    for (arrangement, apart) in ARRANGEMENTS {
        for count in COUNTS {
            let spheres = || row(&sphere, count, apart * right);
            cases.push(Case { shape: "spheres", lenses: spheres(), arrangement, moved: None });
            if MOVING.contains(&count) {
                let step = STEP * radius(&sphere) * right;
                cases.push(Case { shape: "spheres", lenses: spheres(), arrangement, moved: Some(step) });
            }
        }
    }
    let mut variants = Vec::new();
    for case in cases {
        let count = case.lenses.len();
        let techniques: Vec<&Technique> = TECHNIQUES.iter().filter(|technique| (technique.fits)(&case)).collect();
        let motion = if case.moved.is_some() { "moving" } else { "still" };
        let mut scene = plain.clone();
        let one =
            |(i, focus): (usize, Region)| -> Lens { lens(&format!("lens {i}"), focus, &[EFFECTS[i % EFFECTS.len()]]) };
        scene.lenses = case.lenses.into_iter().enumerate().map(one).collect();
        let reference = stage.shot(scene.clone(), 1);
        for technique in techniques {
            let mut scene = scene.clone();
            (technique.set)(&mut scene);
            let mut shot = stage.shot(scene.clone(), 1);
            shot.before = case.moved.map(|by| {
                scene.lenses.iter_mut().flat_map(|lens| &mut lens.shapes).for_each(|focus| move_by(focus, by));
                scene
            });
            variants.push(Variant {
                label: format!("{count}, {}, {}, {}, {motion}", case.shape, case.arrangement, technique.name),
                knobs: vec![
                    Value::Text(case.shape.to_owned()),
                    Value::Text(technique.name.to_owned()),
                    Value::Number(count as f64),
                    Value::Text(case.arrangement.to_owned()),
                    Value::Text(motion.to_owned()),
                ],
                shot,
                reference: Some(reference.clone()),
                mask: None,
                exact: None,
            });
        }
    }
    let plain = stage.shot(plain, 1);
    Ok(Trial { reference: plain.clone(), plain, variants })
}

fn radius(sphere: &Shape) -> f64 {
    if let Shape::Sphere { radius, .. } = sphere { *radius } else { 0.0 }
}

/// Spheres in a row about one, so many of its radii apart.
fn row(sphere: &Shape, count: usize, apart: DVec3) -> Vec<Region> {
    let Shape::Sphere { center, radius } = *sphere else { return Vec::new() };
    let at = |i: usize| center + (i as f64 - 0.5 * (count as f64 - 1.0)) * radius * apart;
    (0..count).map(|i| Shape::Sphere { center: at(i), radius }.into()).collect()
}

fn move_by(focus: &mut Region, by: DVec3) {
    if let Region::Shape(Shape::Sphere { center, .. }) = focus {
        *center += by;
    }
}

/// One of each kind of shape, about a sphere.
fn shapes(sphere: Shape) -> Vec<(&'static str, Region)> {
    let Shape::Sphere { center, radius } = sphere else { return Vec::new() };
    let rotation = DQuat::from_rotation_z(0.5) * DQuat::from_rotation_x(0.3);
    let axis = rotation * DVec3::Z;
    let corner = |i: u32, bit: u32| if i >> bit & 1 == 0 { -0.8 } else { 0.8 };
    let points = (0..8).map(|i| center + radius * (rotation * DVec3::new(corner(i, 0), corner(i, 1), corner(i, 2))));
    let star = (0..10).map(|i| {
        let out = if i % 2 == 0 { 1.2 } else { 0.6 };
        center.truncate() + out * radius * DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / 10.0)
    });
    let slab = Shape::Box { center, size: DVec3::new(3.0, 0.6, 3.0) * radius, rotation };
    vec![
        ("sphere", sphere.clone().into()),
        ("ellipsoid", Shape::Ellipsoid { center, radii: DVec3::new(1.2, 0.9, 0.8) * radius, rotation }.into()),
        ("box", Shape::Box { center, size: DVec3::new(1.9, 1.5, 1.3) * radius, rotation }.into()),
        ("cylinder", Shape::Cylinder { center, radius: 0.9 * radius, height: 1.6 * radius, axis }.into()),
        ("cone", Shape::Frustum { center, radius: 1.2 * radius, top_radius: 0.0, height: 2.0 * radius, axis }.into()),
        ("convex", Shape::Convex { points: points.collect() }.into()),
        (
            "solid",
            Region::Prism { points: star.collect(), holes: Vec::new(), base: center.z - radius, height: 2.0 * radius },
        ),
        ("combination", Region::Combined { how: Operation::Difference, parts: vec![sphere.into(), slab.into()] }),
    ]
}
