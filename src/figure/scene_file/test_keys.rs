//! The tables of detection tests in scene files.

use crate::figure::scene_file::{
    keys::{FAR_M, Key, Kind, Table, key},
    shape_keys::{ATTRIBUTE, EXCEPT, IDS, MAX, MIN, TYPES, VALUES},
};

/// The key that says which test it is; `name` in quotes.
const fn test_kind(name: &'static str) -> Key {
    key("kind", Kind::Text, "", "", "Which test.", name)
}

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
pub const TESTS: &[Table] = &[
    Table {
        name: "exact",
        doc: "A triangle of the object lies on a sight line from the eye to the box around a point of interest, before the box, or in the box before a face of what it is. Decided exactly.",
        keys: &[
            test_kind("\"exact\""),
            key(
                "coverage",
                Kind::Number { min: 0.0, max: 1.0 },
                "0: any triangle counts",
                "",
                "Only who covers at least this share of a point of interest, of what would be seen of it were it alone.",
                "0.05",
            ),
            key(
                "rays",
                Kind::Integer { min: 1, max: 65_536 },
                "256",
                "",
                "Rays to the point of interest that the share is measured by: 256 are right to 6 %, 4,096 to 1.5 % (95 % interval).",
                "1024",
            ),
        ],
    },
    Table {
        name: "view-axis",
        doc: "The box meets the line from the eye to the middle of a point of interest. Decided exactly.",
        keys: &[test_kind("\"view-axis\"")],
    },
    Table {
        name: "spherical",
        doc: "The box is near the eye.",
        keys: &[test_kind("\"spherical\""), RADIUS, REFERENCE],
    },
    Table {
        name: "cylindrical",
        doc: "The middle of the box is near the eye, measured across `up`: as seen from above.",
        keys: &[test_kind("\"cylindrical\""), RADIUS, UP],
    },
    Table {
        name: "viewer-height",
        doc: "The box is near the eye, and meets the plane through the eye across `up`: what is as high as the viewer.",
        keys: &[test_kind("\"viewer-height\""), RADIUS, REFERENCE, UP],
    },
    Table {
        name: "ground",
        doc: "The base of the box comes within `radius` of the place under the eye, as seen from above.",
        keys: &[test_kind("\"ground\""), RADIUS],
    },
    Table {
        name: "route",
        doc: "A triangle of the object lies on a sight line from the eye to a point of a way, before that point. Decided exactly.",
        keys: &[
            test_kind("\"route\""),
            key(
                "points",
                Kind::Points(2),
                "",
                "m",
                "The corners of the way.",
                "[[10.0, 0.0, 1.0], [60.0, 20.0, 1.0], [80.0, 70.0, 1.0]]",
            ),
        ],
    },
    Table {
        name: "any",
        doc: "Some of several tests hold.",
        keys: &[key(
            "any",
            Kind::Tests,
            "",
            "",
            "The tests.",
            "[{ kind = \"view-axis\" }, { kind = \"ground\", radius = 30.0 }]",
        )],
    },
    Table {
        name: "all",
        doc: "All of several tests hold.",
        keys: &[key(
            "all",
            Kind::Tests,
            "",
            "",
            "The tests.",
            "[{ kind = \"exact\" }, { kind = \"spherical\", radius = 200.0 }]",
        )],
    },
    Table {
        name: "not",
        doc: "A test does not hold.",
        keys: &[key("not", Kind::Test, "", "", "The test.", "{ kind = \"spherical\", radius = 20.0 }")],
    },
];

/// `force` and `forbid` of a lens.
pub const CHOICE: Table = Table {
    name: "choice",
    doc: "City objects chosen by their ids, their types or an attribute: one of `ids`, `types` and `attribute`. Of an object that has parts one chosen part is enough.",
    keys: &[IDS, TYPES, ATTRIBUTE, VALUES, MIN, MAX, EXCEPT],
};
