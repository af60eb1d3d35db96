//! Detection tests in scene files.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        check::Place,
        forms::{Axis, Same, Word},
        keys::{FAR_M, Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{Row, Variant, kind, part, tables, variant},
    },
    lens::nearest::did_you_mean,
    visibility::{Reference, Test},
};

const RADIUS: Key =
    key("radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "How near to the eye; 50 to 150 in streets.", "80.0");
const REFERENCE: Key = key(
    "reference",
    Kind::Word { now: &["centre", "nearest", "any-corner", "all-corners"], later: &[] },
    "\"centre\"",
    "",
    "Which point of the box must be near: its middle, the point nearest to the eye, some corner, or all of them.",
    "\"nearest\"",
);
const UP: Key =
    key("up", Kind::Direction, "[0, 0, 1]", "", "What is up for whoever looks, of any length but 0.", "[0, 0, 1]");

/// All tests. The box of an object is the one (edges along x, y, z) around what is shown of it and its parts.
pub const TESTS: &[Table] = &tables::<_, { TEST_KINDS.len() }>(TEST_KINDS);

const TEST_KINDS: &[Variant<Test>] = &[
    variant!(
        Test,
        "exact",
        "A triangle of the object lies on a sight line from the eye to the box around a point of interest, before the box, or in the box before a face of what it is. Decided exactly.",
        Test::Exact { coverage: 0.0, rays: Test::RAYS },
        Test::Exact { .. },
        &[
            kind!("exact", "Which test."),
            part!(Test, key(
                "coverage",
                Kind::Number { min: 0.0, max: 1.0 },
                "0: any triangle counts",
                "",
                "Only who covers at least this share of a point of interest, of what would be seen of it were it alone.",
                "0.05",
            ), Same, Test::Exact { coverage, .. } => coverage),
            part!(Test, key(
                "rays",
                Kind::Integer { min: 1, max: 65_536 },
                "256",
                "",
                "Rays to the point of interest that the share is measured by: 256 are right to 6 %, 4,096 to 1.5 % (95 % interval).",
                "1024",
            ), Same, Test::Exact { rays, .. } => rays),
        ]
    ),
    variant!(
        Test,
        "view-axis",
        "The box meets the line from the eye to the middle of a point of interest. Decided exactly.",
        Test::ViewAxis,
        Test::ViewAxis,
        &[kind!("view-axis", "Which test."),]
    ),
    variant!(
        Test,
        "spherical",
        "The box is near the eye.",
        Test::Spherical { radius: 0.0, reference: Reference::Centre },
        Test::Spherical { .. },
        &[
            kind!("spherical", "Which test."),
            part!(Test, RADIUS, Same, Test::Spherical { radius, .. } => radius),
            part!(Test, REFERENCE, Word, Test::Spherical { reference, .. } => reference),
        ]
    ),
    variant!(
        Test,
        "cylindrical",
        "The middle of the box is near the eye, measured across `up`: as seen from above.",
        Test::Cylindrical { radius: 0.0, up: DVec3::Z },
        Test::Cylindrical { .. },
        &[
            kind!("cylindrical", "Which test."),
            part!(Test, RADIUS, Same, Test::Cylindrical { radius, .. } => radius),
            part!(Test, UP, Axis, Test::Cylindrical { up, .. } => up),
        ]
    ),
    variant!(
        Test,
        "viewer-height",
        "The box is near the eye, and meets the plane through the eye across `up`: what is as high as the viewer.",
        Test::ViewerHeight { radius: 0.0, reference: Reference::Centre, up: DVec3::Z },
        Test::ViewerHeight { .. },
        &[
            kind!("viewer-height", "Which test."),
            part!(Test, RADIUS, Same, Test::ViewerHeight { radius, .. } => radius),
            part!(Test, REFERENCE, Word, Test::ViewerHeight { reference, .. } => reference),
            part!(Test, UP, Axis, Test::ViewerHeight { up, .. } => up),
        ]
    ),
    variant!(
        Test,
        "ground",
        "The base of the box comes within `radius` of the place under the eye, as seen from above.",
        Test::Ground { radius: 0.0 },
        Test::Ground { .. },
        &[kind!("ground", "Which test."), part!(Test, RADIUS, Same, Test::Ground { radius, .. } => radius),]
    ),
    variant!(
        Test,
        "route",
        "A triangle of the object lies on a sight line from the eye to a point of a way, before that point. Decided exactly.",
        Test::Route { points: Vec::new() },
        Test::Route { .. },
        &[
            kind!("route", "Which test."),
            part!(Test, key(
                "points",
                Kind::Points(2),
                "",
                "m",
                "The corners of the way.",
                "[[10.0, 0.0, 1.0], [60.0, 20.0, 1.0], [80.0, 70.0, 1.0]]",
            ), Same, Test::Route { points, .. } => points),
        ]
    ),
    variant!(
        Test,
        "any",
        "Some of several tests hold.",
        Test::Any(Vec::new()),
        Test::Any(_),
        &[Row::<Test>::joint(
            key(
                "any",
                Kind::Tests,
                "",
                "",
                "The tests.",
                "[{ kind = \"view-axis\" }, { kind = \"ground\", radius = 30.0 }]",
            ),
            |test, _| match test {
                Test::Any(parts) => Some(Data::list(parts.iter().map(test_data))),
                _ => None,
            }
        ),]
    ),
    variant!(
        Test,
        "all",
        "All of several tests hold.",
        Test::All(Vec::new()),
        Test::All(_),
        &[Row::<Test>::joint(
            key(
                "all",
                Kind::Tests,
                "",
                "",
                "The tests.",
                "[{ kind = \"exact\" }, { kind = \"spherical\", radius = 200.0 }]",
            ),
            |test, _| match test {
                Test::All(parts) => Some(Data::list(parts.iter().map(test_data))),
                _ => None,
            }
        ),]
    ),
    variant!(
        Test,
        "not",
        "A test does not hold.",
        Test::Not(Box::new(Test::ViewAxis)),
        Test::Not(_),
        &[Row::<Test>::joint(
            key("not", Kind::Test, "", "", "The test.", "{ kind = \"spherical\", radius = 20.0 }"),
            |test, _| match test {
                Test::Not(part) => Some(test_data(part)),
                _ => None,
            }
        ),]
    ),
];

/// A test; `None` where something is wrong (and noted).
pub fn read(reader: &mut Reader, node: &Node, place: &Place) -> Option<Test> {
    let Data::Table(entries) = &node.data else {
        reader.checker.note(
            place,
            "",
            node.line,
            format!("must be a table {{ kind = ..., ... }}, is {}", node.quoted()),
        );
        return None;
    };
    let find = |name: &str| entries.iter().find(|(k, ..)| k == name).map(|(.., n)| n);
    let joints = ["any", "all", "not"];
    let kinds = || TESTS.iter().map(|t| t.name).filter(|name| !joints.contains(name));
    let kind = match (joints.iter().find(|name| find(name).is_some()), find("kind")) {
        (Some(name), _) => TEST_KINDS.iter().find(|own| own.table.name == *name),
        (None, Some(kind)) => {
            TEST_KINDS.iter().find(|own| kind.text() == Some(own.table.name) && !joints.contains(&own.table.name))
        }
        (None, None) => None,
    };
    let Some(kind) = kind else {
        let all = kinds().collect::<Vec<_>>().join(", ");
        let (line, message) = match find("kind") {
            None => {
                let mut hints = entries.iter().map(|(name, ..)| did_you_mean(name, joints.into_iter().chain(["kind"])));
                let hint = hints.find(|hint| !hint.is_empty()).unwrap_or_default();
                (
                    node.line,
                    format!(
                        "is missing: one of {all}, or a table {{ any = [...] }}, {{ all = [...] }} or {{ not = ... }}{hint}"
                    ),
                )
            }
            Some(n) => {
                let hint = did_you_mean(n.text().unwrap_or_default(), kinds());
                (n.line, format!("must be one of {all}, is {}{hint}", n.quoted()))
            }
        };
        reader.checker.note(place, "kind", line, message);
        return None;
    };
    let fields = reader.checker.fields(node, &kind.table, &[], place.clone());
    let test = kind.read(&fields, reader)?;
    let mut parts = |key: &str| -> Option<Vec<Test>> {
        let nodes = fields.node(key).and_then(Node::list)?;
        let part =
            |(i, node): (usize, &Node)| read(reader, node, &fields.place.within(&format!("{key}.{i}"), node.line));
        let read: Vec<Option<Test>> = nodes.iter().enumerate().map(part).collect();
        read.into_iter().collect()
    };
    Some(match test {
        Test::Any(_) => Test::Any(parts("any")?),
        Test::All(_) => Test::All(parts("all")?),
        Test::Not(_) => {
            let inner = fields.node("not")?;
            Test::Not(Box::new(read(reader, inner, &fields.place.within("not", inner.line))?))
        }
        one => one,
    })
}

/// The table of a test.
pub fn test_data(test: &Test) -> Data {
    Variant::of(TEST_KINDS, test)
        .map_or_else(|| Data::Table(Vec::new()), |kind| kind.written(test, &Options::default()))
}
