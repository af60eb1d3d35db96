//! What deformation lenses do in scene files: steps and control, read and written.

use glam::DVec2;

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        focus::Reader,
        keys::{FAR_M, Key, Kind, Table, key},
        node::Node,
        occlusion,
        paths::Options,
        test_keys::CHOICE,
        write::{degrees, list, number, point, quoted},
    },
    lens::{
        deform::{BORDER, ControlProfile, Deform, OBJECTS_ALONE, Step},
        nearest::did_you_mean,
    },
};

const fn step_kind(name: &'static str) -> Key {
    key("kind", Kind::Text, "", "", "What it does.", name)
}

/// Most that something is stretched to or pressed from.
const MOST_STRETCHED: f64 = 100.0;
const FACTOR: Kind = Kind::Number { min: 1.0 / MOST_STRETCHED, max: MOST_STRETCHED };
const ANGLE: Kind = Kind::Number { min: -36_000.0, max: 36_000.0 };

/// Steps of deformations.
pub const STEPS: &[Table] = &[
    Table {
        name: "translate",
        doc: "Moves.",
        keys: &[
            step_kind("\"translate\""),
            key("by", Kind::Point, "", "m", "How far along its axes.", "[0.0, 0.0, 40.0]"),
        ],
    },
    Table {
        name: "scale",
        doc: "Stretches or presses, from the middle of the base.",
        keys: &[
            step_kind("\"scale\""),
            key(
                "factors",
                Kind::Point,
                "",
                "",
                "How many times as large along its axes, 0.01 to 100.",
                "[1.0, 1.0, 2.5]",
            ),
        ],
    },
    Table {
        name: "shear",
        doc: "The higher, the further aside.",
        keys: &[
            step_kind("\"shear\""),
            key("by", Kind::PlanPoint, "", "m per m of height", "How far aside.", "[0.4, 0.0]"),
        ],
    },
    Table {
        name: "taper",
        doc: "Gets narrower, or wider, from the base to the top.",
        keys: &[step_kind("\"taper\""), key("factor", FACTOR, "", "", "How many times as wide at the top.", "0.5")],
    },
    Table {
        name: "twist",
        doc: "Turns about its vertical axis: not at all at the base, most at the top.",
        keys: &[
            step_kind("\"twist\""),
            key("angle_deg", ANGLE, "", "degrees", "How far at the top, counter-clockwise from above.", "90.0"),
        ],
    },
    Table {
        name: "bend",
        doc: "Bends along y, from one end to the other; lengths on the base stay.",
        keys: &[
            step_kind("\"bend\""),
            key("angle_deg", ANGLE, "", "degrees", "Between both ends; they rise where it is above 0.", "60.0"),
        ],
    },
    Table {
        name: "open-street",
        doc: "Along a corridor: what stands beside the way is moved away from it, and lowered.",
        keys: &[
            step_kind("\"open-street\""),
            key("width", Kind::Number { min: 0.1, max: 1e4 }, "", "m", "How wide the street is.", "12.0"),
            key("aside", Kind::Number { min: 0.0, max: 1e4 }, "0.0", "m", "How far each side is moved away.", "8.0"),
            key("height", FACTOR, "1.0", "", "How many times as high what stands beside it is.", "0.3"),
        ],
    },
    Table {
        name: "heights",
        doc: "Of city objects, without a shape: each is as many times as high as a number of its says; those without it stay.",
        keys: &[
            step_kind("\"heights\""),
            key(
                "attribute",
                Kind::Text,
                "",
                "",
                "The attribute that has the number; an object without it takes its parent's.",
                "\"yearOfConstruction\"",
            ),
            key(
                "from",
                Kind::PlanPoint,
                "",
                "",
                "Two numbers, ascending; what is beyond them counts as they do.",
                "[1900.0, 2020.0]",
            ),
            key(
                "to",
                Kind::PlanPoint,
                "",
                "",
                "How many times as high objects with these numbers are, 0.01 to 100; between them as much in between.",
                "[1.0, 4.0]",
            ),
        ],
    },
    Table {
        name: "lower",
        doc: "Of city objects, without a shape: those that hide a point of interest are made lower. Who hides it is asked of the city as it is.",
        keys: &[
            step_kind("\"lower\""),
            key("factor", FACTOR, "0.15", "", "How many times as high they are.", "0.1"),
            key("poi", Kind::Names, "none", "", "As of an occlusion lens: what shall be seen.", "\"hall\""),
            key(
                "test",
                Kind::Test,
                "{ kind = \"exact\" }",
                "",
                "Who hides something; see Detection tests.",
                "{ kind = \"exact\", coverage = 0.05 }",
            ),
            key(
                "force",
                Kind::Table(&CHOICE),
                "none",
                "",
                "City objects that are lowered whatever the test says.",
                "{ ids = [\"shed\"] }",
            ),
            key(
                "forbid",
                Kind::Table(&CHOICE),
                "none",
                "",
                "City objects that stay as they are.",
                "{ ids = [\"town-hall\"] }",
            ),
            key(
                "margin",
                Kind::Number { min: 0.0, max: 1000.0 },
                "1.0",
                "metres",
                "In animations, as of an occlusion lens.",
                "5.0",
            ),
            key(
                "fade",
                Kind::Number { min: 0.0, max: 60.0 },
                "0.3",
                "seconds",
                "In animations: how long it takes to sink or to rise.",
                "1.0",
            ),
        ],
    },
    Table {
        name: "panorama",
        doc: "Of the eye, without a shape: raises what is far, so that it is seen as on a map.",
        keys: &[
            step_kind("\"panorama\""),
            key("near", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "What is nearer stays.", "150.0"),
            key("far", Kind::Number { min: 0.001, max: FAR_M }, "", "m", "From here on it goes on straight.", "600.0"),
            key(
                "angle_deg",
                Kind::Number { min: -180.0, max: 180.0 },
                "",
                "degrees",
                "By how much what is far is raised.",
                "50.0",
            ),
        ],
    },
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
pub(super) const OWN: [&str; 3] = ["deform", "control", "strength"];

/// The steps of a deformation; what is wrong is noted.
pub(super) fn steps(reader: &mut Reader, fields: &Fields) -> Vec<Step> {
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
        let Some(table) = STEPS.iter().find(|table| word == Some(table.name)) else {
            let all = STEPS.iter().map(|table| table.name);
            let what = node.entry("kind").map_or_else(|| "missing".to_owned(), Node::quoted);
            let hint = did_you_mean(word.unwrap_or_default(), all.clone());
            let line = node.entry("kind").map_or(node.line, |kind| kind.line);
            let message = format!("must be one of {}, is {what}{hint}", all.collect::<Vec<_>>().join(", "));
            reader.checker.note(&place, "kind", line, message);
            continue;
        };
        let own = reader.checker.fields(node, table, &[], place);
        if table.name == "lower" {
            let factor = own.number("factor").unwrap_or(LOWERED);
            steps.push(Step::Lower { of: Box::new(occlusion::read(reader, &own)), factor });
        } else {
            steps.extend(step(reader.checker, table.name, &own));
        }
    }
    let of_objects = |step: &&Step| matches!(step, Step::Heights { .. } | Step::Lower { .. });
    let count = steps.iter().filter(of_objects).count();
    if count > 0 && (count < steps.len() || fields.given("shape") || fields.given("shapes")) {
        reader.checker.note(&fields.place, "deform", fields.line("deform"), OBJECTS_ALONE.to_owned());
    }
    steps
}

/// How many times as high occluders are, where nobody says so.
const LOWERED: f64 = 0.15;

/// What heights are multiplied with between two numbers.
fn heights(checker: &mut Checker, own: &Fields) -> Option<Step> {
    let pair = |key: &str| own.node(key).and_then(Node::numbers::<2>);
    let (attribute, from, to) = (own.text("attribute")?.to_owned(), pair("from")?, pair("to")?);
    let shown = |pair: [f64; 2]| format!("[{}, {}]", number(pair[0]), number(pair[1]));
    let range = 1.0 / MOST_STRETCHED..=MOST_STRETCHED;
    let is_fine = |f: &f64| range.contains(f);
    let wrong = if from[0] >= from[1] {
        Some(("from", format!("must be two numbers, ascending, is {}", shown(from))))
    } else if !to.iter().all(is_fine) {
        Some(("to", format!("must be two numbers from 0.01 to 100, is {}", shown(to))))
    } else {
        None
    };
    if let Some((key, message)) = wrong {
        checker.note(&own.place, key, own.line(key), message);
        return None;
    }
    Some(Step::Heights { attribute, from, to })
}

fn step(checker: &mut Checker, word: &str, own: &Fields) -> Option<Step> {
    let angle = || own.number("angle_deg").map(f64::to_radians);
    Some(match word {
        "translate" => Step::Translate { by: own.point("by")? },
        "scale" => {
            let factors = own.point("factors")?;
            let range = 1.0 / MOST_STRETCHED..=MOST_STRETCHED;
            if !factors.to_array().iter().all(|f| range.contains(f)) {
                let message = format!("must be three numbers from 0.01 to 100, is {}", point(factors));
                checker.note(&own.place, "factors", own.line("factors"), message);
                return None;
            }
            Step::Scale { factors }
        }
        "shear" => Step::Shear { slope: own.node("by").and_then(Node::numbers::<2>).map(DVec2::from)? },
        "taper" => Step::Taper { factor: own.number("factor")? },
        "twist" => Step::Twist { angle: angle()? },
        "bend" => Step::Bend { angle: angle()? },
        "open-street" => Step::OpenStreet {
            width: own.number("width")?,
            aside: own.number("aside").unwrap_or(0.0),
            height: own.number("height").unwrap_or(1.0),
        },
        "heights" => heights(checker, own)?,
        _ => {
            let (near, far, angle) = (own.number("near")?, own.number("far")?, angle()?);
            if far <= near {
                checker.note(&own.place, "far", own.line("far"), format!("must be above near, {near}, is {far}"));
                return None;
            }
            Step::Panorama { near, far, angle }
        }
    })
}

/// The control of a deformation that has no image: of its keys, or the word in place of them.
pub(super) fn profile(checker: &mut Checker, own: &Fields, word: Option<&str>) -> Option<ControlProfile> {
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

/// The keys of what a deformation lens does.
pub(super) fn written(deform: &Deform, options: &Options) -> Vec<(&'static str, String)> {
    let mut keys = vec![("deform", list(deform.steps.iter().map(step_written)))];
    keys.extend(deform.control.as_ref().map(|control| ("control", control_written(control, options))));
    keys.extend((deform.strength != 1.0).then(|| ("strength", number(deform.strength))));
    keys
}

fn step_written(step: &Step) -> String {
    let keys = match step {
        Step::Translate { by } => format!("kind = \"translate\", by = {}", point(*by)),
        Step::Scale { factors } => format!("kind = \"scale\", factors = {}", point(*factors)),
        Step::Shear { slope: DVec2 { x, y } } => format!("kind = \"shear\", by = [{}, {}]", number(*x), number(*y)),
        Step::Taper { factor } => format!("kind = \"taper\", factor = {}", number(*factor)),
        Step::Twist { angle } => format!("kind = \"twist\", angle_deg = {}", number(degrees(*angle))),
        Step::Bend { angle } => format!("kind = \"bend\", angle_deg = {}", number(degrees(*angle))),
        Step::OpenStreet { width, aside, height } => format!(
            "kind = \"open-street\", width = {}, aside = {}, height = {}",
            number(*width),
            number(*aside),
            number(*height)
        ),
        Step::Heights { attribute, from, to } => format!(
            "kind = \"heights\", attribute = {}, from = [{}, {}], to = [{}, {}]",
            quoted(attribute),
            number(from[0]),
            number(from[1]),
            number(to[0]),
            number(to[1])
        ),
        Step::Lower { of, factor } => {
            let own = occlusion::occluders_written(of).into_iter().map(|(key, value)| format!(", {key} = {value}"));
            format!("kind = \"lower\", factor = {}{}", number(*factor), own.collect::<String>())
        }
        Step::Panorama { near, far, angle } => format!(
            "kind = \"panorama\", near = {}, far = {}, angle_deg = {}",
            number(*near),
            number(*far),
            number(degrees(*angle))
        ),
    };
    format!("{{ {keys} }}")
}

fn control_written(control: &ControlProfile, options: &Options) -> String {
    let with_border = |word: &str, border: f64| match border == BORDER {
        true => quoted(word),
        false => format!("{{ profile = {}, border = {} }}", quoted(word), number(border)),
    };
    match control {
        ControlProfile::Linear { border } => with_border("linear", *border),
        ControlProfile::Smooth { border } => with_border("smooth", *border),
        ControlProfile::Bump => quoted("bump"),
        ControlProfile::Everywhere => quoted("everywhere"),
        ControlProfile::Ring { inner, outer } => {
            format!("{{ profile = \"ring\", inner = {}, outer = {} }}", number(*inner), number(*outer))
        }
        ControlProfile::Image(file) => format!("{{ image = {} }}", quoted(&options.written(file))),
    }
}
