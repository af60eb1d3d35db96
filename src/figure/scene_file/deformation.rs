//! What deformation lenses do in scene files: steps and control, read and written.

use glam::{DVec2, DVec3};

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        choice::CHOICE,
        forms::{Degrees, Same},
        handled,
        keys::{FAR_M, Kind, Table, key},
        node::{Data, Node},
        occlusion,
        paths::Options,
        reader::Reader,
        row::{Row, Variant, kind, part, tables, variant},
        text,
    },
    lens::{
        LensKind, Occluders,
        deform::{BORDER, ControlProfile, Deform, OBJECTS_ALONE, Step},
        nearest::did_you_mean,
    },
    shader::effect::{AskedBy, asked_for},
};

/// Most that something is stretched to or pressed from.
const MOST_STRETCHED: f64 = 100.0;
const FACTOR: Kind = Kind::Number { min: 1.0 / MOST_STRETCHED, max: MOST_STRETCHED };
const ANGLE: Kind = Kind::Number { min: -36_000.0, max: 36_000.0 };

/// Steps of deformations.
pub const STEPS: &[Table] = &tables::<_, { STEP_KINDS.len() }>(STEP_KINDS);

const STEP_KINDS: &[Variant<Step>] = &[
    variant!(
        Step,
        "translate",
        "Moves.",
        Step::Translate { by: DVec3::ZERO },
        Step::Translate { .. },
        &[
            kind!("translate", "What it does."),
            part!(Step, key("by", Kind::Point, "", "m", "How far along its axes.", "[0.0, 0.0, 40.0]"), Same, Step::Translate { by, .. } => by),
        ]
    ),
    variant!(
        Step,
        "scale",
        "Stretches or presses, from the middle of the base.",
        Step::Scale { factors: DVec3::ONE },
        Step::Scale { .. },
        &[
            kind!("scale", "What it does."),
            part!(Step, key(
                "factors",
                Kind::Point,
                "",
                "",
                "How many times as large along its axes, 0.01 to 100.",
                "[1.0, 1.0, 2.5]",
            ), Same, Step::Scale { factors, .. } => factors),
        ]
    ),
    variant!(
        Step,
        "shear",
        "The higher, the further aside.",
        Step::Shear { slope: DVec2::ZERO },
        Step::Shear { .. },
        &[
            kind!("shear", "What it does."),
            part!(Step, key("by", Kind::PlanPoint, "", "m per m of height", "How far aside.", "[0.4, 0.0]"), Same, Step::Shear { slope, .. } => slope),
        ]
    ),
    variant!(
        Step,
        "taper",
        "Gets narrower, or wider, from the base to the top.",
        Step::Taper { factor: 1.0 },
        Step::Taper { .. },
        &[
            kind!("taper", "What it does."),
            part!(Step, key("factor", FACTOR, "", "", "How many times as wide at the top.", "0.5"), Same, Step::Taper { factor, .. } => factor),
        ]
    ),
    variant!(
        Step,
        "twist",
        "Turns about its vertical axis: not at all at the base, most at the top.",
        Step::Twist { angle: 0.0 },
        Step::Twist { .. },
        &[
            kind!("twist", "What it does."),
            part!(Step, key("angle_deg", ANGLE, "", "degrees", "How far at the top, counter-clockwise from above.", "90.0"), Degrees, Step::Twist { angle, .. } => angle),
        ]
    ),
    variant!(
        Step,
        "bend",
        "Bends along y, from one end to the other; lengths on the base stay.",
        Step::Bend { angle: 0.0 },
        Step::Bend { .. },
        &[
            kind!("bend", "What it does."),
            part!(Step, key("angle_deg", ANGLE, "", "degrees", "Between both ends; they rise where it is above 0.", "60.0"), Degrees, Step::Bend { angle, .. } => angle),
        ]
    ),
    variant!(
        Step,
        "open-street",
        "Along a corridor: what stands beside the way is moved away from it, and lowered.",
        Step::OpenStreet { width: 0.0, aside: 0.0, height: 1.0 },
        Step::OpenStreet { .. },
        &[
            kind!("open-street", "What it does."),
            part!(Step, key("width", Kind::Number { min: 0.1, max: 1e4 }, "", "m", "How wide the street is.", "12.0"), Same, Step::OpenStreet { width, .. } => width),
            part!(Step, key("aside", Kind::Number { min: 0.0, max: 1e4 }, "0.0", "m", "How far each side is moved away.", "8.0"), Same, Step::OpenStreet { aside, .. } => aside).always(),
            part!(Step, key("height", FACTOR, "1.0", "", "How many times as high what stands beside it is.", "0.3"), Same, Step::OpenStreet { height, .. } => height).always(),
        ]
    ),
    variant!(
        Step,
        "heights",
        "Of city objects, without a shape: each is as many times as high as a number of its says; those without it stay.",
        Step::Heights { attribute: String::new(), from: [0.0; 2], to: [0.0; 2] },
        Step::Heights { .. },
        &[
            kind!("heights", "What it does."),
            part!(Step, key(
                "attribute",
                Kind::Text,
                "",
                "",
                "The attribute that has the number; an object without it takes its parent's.",
                "\"yearOfConstruction\"",
            ), Same, Step::Heights { attribute, .. } => attribute),
            part!(Step, key(
                "from",
                Kind::PlanPoint,
                "",
                "",
                "Two numbers, ascending; what is beyond them counts as they do.",
                "[1900.0, 2020.0]",
            ), Same, Step::Heights { from, .. } => from),
            part!(Step, key(
                "to",
                Kind::PlanPoint,
                "",
                "",
                "How many times as high objects with these numbers are, 0.01 to 100; between them as much in between.",
                "[1.0, 4.0]",
            ), Same, Step::Heights { to, .. } => to),
        ]
    ),
    variant!(
        Step,
        "lower",
        "Of city objects, without a shape: those that hide a point of interest are made lower. Who hides it is asked of the city as it is.",
        Step::Lower { of: Box::new(Occluders::default()), factor: LOWERED },
        Step::Lower { .. },
        &[
            kind!("lower", "What it does."),
            part!(Step, key("factor", FACTOR, "0.15", "", "How many times as high they are.", "0.1"), Same, Step::Lower { factor, .. } => factor).always(),
            Row::<Step>::joint(key("poi", Kind::Names, "none", "", "As of an occlusion lens: what shall be seen.", "\"hall\""), |step, options| occluders(step, "poi", options)),
            Row::<Step>::joint(key(
                "test",
                Kind::Test,
                "{ kind = \"exact\" }",
                "",
                "Who hides something; see Detection tests.",
                "{ kind = \"exact\", coverage = 0.05 }",
            ), |step, options| occluders(step, "test", options)).always(),
            Row::<Step>::joint(key(
                "force",
                Kind::Table(&CHOICE),
                "none",
                "",
                "City objects that are lowered whatever the test says.",
                "{ ids = [\"shed\"] }",
            ), |step, options| occluders(step, "force", options)),
            Row::<Step>::joint(key(
                "forbid",
                Kind::Table(&CHOICE),
                "none",
                "",
                "City objects that stay as they are.",
                "{ ids = [\"town-hall\"] }",
            ), |step, options| occluders(step, "forbid", options)),
            Row::<Step>::joint(key(
                "margin",
                Kind::Number { min: 0.0, max: 1000.0 },
                "1.0",
                "metres",
                "In animations, as of an occlusion lens.",
                "5.0",
            ), |step, options| occluders(step, "margin", options)),
            Row::<Step>::joint(key(
                "fade",
                Kind::Number { min: 0.0, max: 60.0 },
                "0.3",
                "seconds",
                "In animations: how long it takes to sink or to rise.",
                "1.0",
            ), |step, options| occluders(step, "fade", options)),
        ]
    ),
    variant!(
        Step,
        "panorama",
        "Of the eye, without a shape: raises what is far, so that it is seen as on a map.",
        Step::Panorama { near: 0.0, far: 0.0, angle: 0.0 },
        Step::Panorama { .. },
        &[
            kind!("panorama", "What it does."),
            part!(Step, key("near", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "What is nearer stays.", "150.0"), Same, Step::Panorama { near, .. } => near),
            part!(Step, key("far", Kind::Number { min: 0.001, max: FAR_M }, "", "m", "From here on it goes on straight.", "600.0"), Same, Step::Panorama { far, .. } => far),
            part!(Step, key(
                "angle_deg",
                Kind::Number { min: -180.0, max: 180.0 },
                "",
                "degrees",
                "By how much what is far is raised.",
                "50.0",
            ), Degrees, Step::Panorama { angle, .. } => angle),
        ]
    ),
];

/// The radii of a ring, where nobody gives them.
const RING: [f64; 2] = [0.3, 1.0];

/// Words of controls.
pub const CONTROL_WORDS: &[&str] = &["linear", "smooth", "bump", "ring", "everywhere"];

/// `control` of a lens.
pub const CONTROL: Table = Table {
    name: "control",
    doc: "How strong a deformation is over the base of its focus area; along the border it is 0, but for `everywhere`.",
    keys: &[
        key(
            "profile",
            Kind::Word { now: CONTROL_WORDS, later: &[] },
            "by the other keys",
            "",
            "Rises from the border `linear` or `smooth`, is a round `bump`, or a round wall, a `ring`; `everywhere` it is all there, beyond the shape, too.",
            "\"smooth\"",
        ),
        key(
            "border",
            Kind::Number { min: 0.01, max: 0.5 },
            "0.25",
            "",
            "For `linear` and `smooth`: over which part of the sides it rises.",
            "0.1",
        ),
        key(
            "inner",
            Kind::Number { min: 0.0, max: 0.99 },
            "0.3",
            "",
            "For `ring`: where it begins, in halves of a side.",
            "0.4",
        ),
        key("outer", Kind::Number { min: 0.01, max: 1.0 }, "1.0", "", "For `ring`: where it ends.", "0.9"),
        key(
            "image",
            Kind::Text,
            "none",
            "",
            "An image, stretched over the base: white is all, black nothing. Its lower edge is where y begins.",
            "\"strength.png\"",
        ),
    ],
};

/// The keys that only deformation lenses have.
pub const OWN: [&str; 3] = ["deform", "control", "strength"];

/// What a deformation lens does, if it is one.
pub fn read(reader: &mut Reader, fields: &Fields, kind: &LensKind) -> Option<Deform> {
    if kind.deform().is_none() {
        for key in OWN.into_iter().filter(|key| fields.given(key)) {
            let message = "has a meaning only for a lens of kind = \"deformation\"";
            reader.checker.note(&fields.place, key, fields.line(key), message);
        }
        return None;
    }
    let steps = steps(reader, fields);
    let control = fields.node("control").and_then(|node| {
        let empty = Node::empty_table(node.line);
        let table = if node.text().is_some() { &empty } else { node };
        let place = fields.place.within("control", node.line);
        let own = reader.checker.fields(table, &CONTROL, &[], place);
        if !own.given("image") {
            return profile(&mut reader.checker, &own, node.text());
        }
        if own.given("profile") {
            let message = "is given together with profile: a control is one of them";
            reader.checker.note(&own.place, "image", own.line("image"), message);
        }
        reader.file(&own, "image").map(ControlProfile::Image)
    });
    Some(Deform { steps, control, strength: fields.number("strength").unwrap_or(1.0) })
}

/// The steps of a deformation; what is wrong is noted.
fn steps(reader: &mut Reader, fields: &Fields) -> Vec<Step> {
    let Some(nodes) = fields.node("deform").and_then(Node::list) else {
        if !fields.given("deform") {
            let message = "is missing: what the lens does with space; for example deform = [{ kind = \"twist\", angle_deg = 90.0 }]";
            reader.checker.note(&fields.place, "deform", fields.place.line, message);
        }
        return Vec::new();
    };
    let mut steps = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        let place = fields.place.within(&format!("deform.{i}"), node.line);
        let word = node.entry("kind").and_then(Node::text);
        let Some(kind) = STEP_KINDS.iter().find(|kind| word == Some(kind.table.name)) else {
            if let Some(used) = handled::read(reader, node, &place, AskedBy::Steps) {
                steps.push(Step::Map(used));
                continue;
            }
            let own = asked_for(AskedBy::Steps).map(|handler| handler.name.as_str());
            let all: Vec<&str> = STEPS.iter().map(|table| table.name).chain(own).collect();
            let what = node.entry("kind").map_or_else(|| "missing".to_owned(), Node::quoted);
            let hint = did_you_mean(word.unwrap_or_default(), all.iter().copied());
            let line = node.entry("kind").map_or(node.line, |kind| kind.line);
            let message = format!("must be one of {}, is {what}{hint}", all.join(", "));
            reader.checker.note(&place, "kind", line, message);
            continue;
        };
        let own = reader.checker.fields(node, &kind.table, &[], place);
        let step = match kind.read(&own, reader) {
            Some(Step::Lower { factor, .. }) => {
                Some(Step::Lower { of: Box::new(occlusion::read(reader, &own)), factor })
            }
            step => step.filter(|step| is_possible(&mut reader.checker, &own, step)),
        };
        steps.extend(step);
    }
    let of_objects = |step: &&Step| step.is_of_objects();
    let count = steps.iter().filter(of_objects).count();
    if count > 0 && (count < steps.len() || fields.given("shape") || fields.given("shapes")) {
        reader.checker.note(&fields.place, "deform", fields.line("deform"), OBJECTS_ALONE.to_owned());
    }
    steps
}

/// How many times as high occluders are, where nobody says so.
const LOWERED: f64 = 0.15;

/// A key of the occluders that a step lowers.
fn occluders(step: &Step, key: &str, options: &Options) -> Option<Data> {
    match step {
        Step::Lower { of, .. } => occlusion::written(of, key, options),
        _ => None,
    }
}

/// Whether the numbers of a step go together; noted where they do not.
fn is_possible(checker: &mut Checker, own: &Fields, step: &Step) -> bool {
    let range = 1.0 / MOST_STRETCHED..=MOST_STRETCHED;
    let is_fine = |factors: &[f64]| factors.iter().all(|f| range.contains(f));
    let shown = |numbers: &[f64]| text::value(&Data::list(numbers.iter().copied()));
    let (key, message) = match step {
        Step::Scale { factors } if !is_fine(&factors.to_array()) => {
            ("factors", format!("must be three numbers from 0.01 to 100, is {}", shown(&factors.to_array())))
        }
        Step::Heights { from, .. } if from[0] >= from[1] => {
            ("from", format!("must be two numbers, ascending, is {}", shown(from)))
        }
        Step::Heights { to, .. } if !is_fine(to) => {
            ("to", format!("must be two numbers from 0.01 to 100, is {}", shown(to)))
        }
        Step::Panorama { near, far, .. } if far <= near => ("far", format!("must be above near, {near}, is {far}")),
        _ => return true,
    };
    checker.note(&own.place, key, own.line(key), message);
    false
}

/// The control of a deformation that has no image: of its keys, or the word in place of them.
fn profile(checker: &mut Checker, own: &Fields, word: Option<&str>) -> Option<ControlProfile> {
    let border = own.number("border").unwrap_or(BORDER);
    match word.or_else(|| own.text("profile")) {
        Some("linear") => Some(ControlProfile::Linear { border }),
        Some("bump") => Some(ControlProfile::Bump),
        Some("everywhere") => Some(ControlProfile::Everywhere),
        Some("ring") => {
            let (inner, outer) = (own.number("inner").unwrap_or(RING[0]), own.number("outer").unwrap_or(RING[1]));
            if outer <= inner {
                let message = format!("must be above inner, {inner}, is {outer}");
                checker.note(&own.place, "outer", own.line("outer"), message);
                return None;
            }
            Some(ControlProfile::Ring { inner, outer })
        }
        Some(_) => Some(ControlProfile::Smooth { border }),
        None => own.given("border").then_some(ControlProfile::Smooth { border }),
    }
}

/// `deform` of a deformation lens.
pub fn steps_data(deform: &Deform, options: &Options) -> Data {
    let step = |step: &Step| match step {
        Step::Map(used) => Some(handled::written(used)),
        _ => Variant::of(STEP_KINDS, step).map(|kind| kind.written(step, options)),
    };
    Data::list(deform.steps.iter().filter_map(step))
}

/// `control`.
pub fn control_data(deform: &Deform, options: &Options) -> Option<Data> {
    let said = |word: &str, keys: &[(&str, f64)]| match keys {
        [] => word.into(),
        keys => {
            let mut data = Data::table([("profile", word.into())]);
            keys.iter().for_each(|(key, number)| data.push(key, *number));
            data
        }
    };
    let with_border = |word: &str, border: f64| match border == BORDER {
        true => said(word, &[]),
        false => said(word, &[("border", border)]),
    };
    Some(match deform.control.as_ref()? {
        ControlProfile::Linear { border } => with_border("linear", *border),
        ControlProfile::Smooth { border } => with_border("smooth", *border),
        ControlProfile::Bump => "bump".into(),
        ControlProfile::Everywhere => "everywhere".into(),
        ControlProfile::Ring { inner, outer } => said("ring", &[("inner", *inner), ("outer", *outer)]),
        ControlProfile::Image(file) => Data::table([("image", Data::Text(options.written(file)))]),
    })
}
