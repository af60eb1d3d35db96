//! The tables of shapes in scene files.

use crate::figure::scene_file::keys::{FAR_M, Key, Kind, Table, key};

/// The key that says which shape it is; `name` in quotes.
const fn shape_kind(name: &'static str) -> Key {
    key("kind", Kind::Text, "", "", "Which shape.", name)
}

const CENTER: Key = key("center", Kind::Point, "", "m", "The middle of the body.", "[78600.0, 457950.0, 10.0]");
const RADIUS: Key = key("radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Radius; 0 holds nothing.", "60.0");

const HEIGHT: Key = key("height", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "From end to end.", "80.0");
const AXIS: Key = key("axis", Kind::Direction, "[0, 0, 1]", "", "Its direction, of any length but 0.", "[0, 0, 1]");
const ROTATION: Key = key(
    "rotation_deg",
    Kind::Angles,
    "[0, 0, 0]",
    "degrees",
    "`[yaw, pitch, roll]`: yaw turns it counter-clockwise seen from above (0: its x is east), pitch then lifts its x end, roll then turns it about its own x.",
    "[30.0, 0.0, 0.0]",
);

const BASE: Key = key("base", Kind::Number { min: -FAR_M, max: FAR_M }, "", "m", "Height of its foot.", "0.0");
const HIGH: Key =
    key("height", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "From its foot to its top; 0 holds nothing.", "80.0");
pub(super) const IDS: Key = key(
    "ids",
    Kind::Texts,
    "none: `types` or `attribute`",
    "",
    "Ids of city objects; their parts belong to them.",
    "[\"town-hall\"]",
);
pub(super) const TYPES: Key = key(
    "types",
    Kind::Texts,
    "none: `ids` or `attribute`",
    "",
    "Types of city objects, as their files call them; their parts belong to them.",
    "[\"Bridge\"]",
);
pub(super) const ATTRIBUTE: Key = key(
    "attribute",
    Kind::Text,
    "none: `ids` or `types`",
    "",
    "Objects that have this attribute; one without it takes its parent's.",
    "\"yearOfConstruction\"",
);
pub(super) const VALUES: Key =
    key("values", Kind::Texts, "any", "", "Only where the attribute is one of these.", "[\"school\"]");
pub(super) const MIN: Key = key(
    "min",
    Kind::Number { min: f64::MIN, max: f64::MAX },
    "none",
    "the attribute's",
    "Only where the attribute is at least this.",
    "1900.0",
);
pub(super) const MAX: Key = key(
    "max",
    Kind::Number { min: f64::MIN, max: f64::MAX },
    "none",
    "the attribute's",
    "Only where the attribute is at most this.",
    "1945.0",
);
pub(super) const EXCEPT: Key = key("except", Kind::Boolean, "false", "", "All other objects instead.", "true");

const PARTS: Key = key(
    "shapes",
    Kind::Shapes,
    "",
    "",
    "The shapes, of any kind, combinations too; at most 64 in all.",
    "[{ kind = \"sphere\", center = [0, 0, 0], radius = 9 }, { kind = \"sphere\", center = [5, 0, 0], radius = 9 }]",
);

/// Shapes of lenses.
pub const SHAPES: &[Table] = &[
    Table { name: "sphere", doc: "A ball.", keys: &[shape_kind("\"sphere\""), CENTER, RADIUS] },
    Table {
        name: "ellipsoid",
        doc: "A ball stretched along its own axes.",
        keys: &[
            shape_kind("\"ellipsoid\""),
            CENTER,
            key("radii", Kind::Lengths, "", "m", "Half its extent along its own x, y, z.", "[80.0, 40.0, 20.0]"),
            ROTATION,
        ],
    },
    Table {
        name: "box",
        doc: "A box.",
        keys: &[
            shape_kind("\"box\""),
            CENTER,
            key("size", Kind::Lengths, "", "m", "Full edges along its own x, y, z.", "[40.0, 20.0, 30.0]"),
            ROTATION,
        ],
    },
    Table { name: "cylinder", doc: "A cylinder.", keys: &[shape_kind("\"cylinder\""), CENTER, RADIUS, HEIGHT, AXIS] },
    Table {
        name: "cone",
        doc: "A cone; its middle is half way up its axis, its tip at the axis' end.",
        keys: &[shape_kind("\"cone\""), CENTER, RADIUS, HEIGHT, AXIS],
    },
    Table {
        name: "frustum",
        doc: "A cone without its tip.",
        keys: &[
            shape_kind("\"frustum\""),
            CENTER,
            key("radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis begins.", "60.0"),
            key("top_radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis ends.", "20.0"),
            HEIGHT,
            AXIS,
        ],
    },
    Table {
        name: "convex",
        doc: "The convex hull of points.",
        keys: &[
            shape_kind("\"convex\""),
            key(
                "points",
                Kind::Points(4),
                "",
                "m",
                "At least four, not all on one plane; at most 4096.",
                "[[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]",
            ),
        ],
    },
    Table {
        name: "polytope",
        doc: "The body between planes.",
        keys: &[
            shape_kind("\"polytope\""),
            key(
                "planes",
                Kind::Planes(4),
                "",
                "",
                "Planes `[nx, ny, nz, d]`, at most 64: inside is where nx x + ny y + nz z ≤ d for each of them. The normal points outwards and has any length but 0; with length 1, d is in metres. They must close the body on all sides.",
                "[[1, 0, 0, 9], [-1, 0, 0, 0], [0, 1, 0, 9], [0, -1, 0, 0], [0, 0, 1, 9], [0, 0, -1, 0]]",
            ),
        ],
    },
    Table {
        name: "corridor",
        doc: "What lies along a line, such as a route: within half the width of it seen from above, and half the height above and below it. Corners are round.",
        keys: &[
            shape_kind("\"corridor\""),
            key(
                "points",
                Kind::Points(2),
                "",
                "m",
                "The line; at least two points, at most 4096.",
                "[[0, 0, 2], [60, 10, 2], [90, 80, 5]]",
            ),
            key("width", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "From side to side.", "12.0"),
            key(
                "height",
                Kind::Number { min: 0.0, max: FAR_M },
                "",
                "m",
                "From its floor to its top; the line is in the middle.",
                "30.0",
            ),
        ],
    },
    Table {
        name: "flat",
        doc: "What is seen through a figure: a disc, a rectangle or a polygon; exactly one of `radius`, `size` and `points`. It \
              begins in the figure's plane and reaches from there to infinity, away from the eye: the sky behind it is in it, \
              what stands before it is not. Both sides of the figure are alike. An eye in its plane sees it edge on: it holds \
              nothing then. It acts only in the view that the scene is looked at in.",
        keys: &[
            shape_kind("\"flat\""),
            key("center", Kind::Point, "", "m", "Where the (0, 0) of the figure is.", "[78600.0, 457950.0, 10.0]"),
            key(
                "rotation_deg",
                Kind::Angles,
                "[0, 0, 0]",
                "degrees",
                "`[yaw, pitch, roll]`, as of a box: without, the figure lies level; `[yaw, 0, 90]` stands upright, its x along the yaw.",
                "[30.0, 0.0, 90.0]",
            ),
            key("radius", Kind::Number { min: 0.0, max: FAR_M }, "none", "m", "Of a disc; 0 holds nothing.", "20.0"),
            key(
                "size",
                Kind::PlanLengths,
                "none",
                "m",
                "Of a rectangle: full edges along its x and y.",
                "[40.0, 25.0]",
            ),
            key(
                "points",
                Kind::PlanPoints(3),
                "none",
                "m",
                "Of a polygon, convex or not, in the figure's x and y; at most 1024. Where it crosses itself, all that it goes around is in it.",
                "[[-20, -10], [20, -10], [0, 15]]",
            ),
        ],
    },
    Table {
        name: "mesh",
        doc: "What the faces of a file enclose; it may be concave, in several parts, or touch and cross itself. Faces turned the wrong way and small holes are mended.",
        keys: &[
            shape_kind("\"mesh\""),
            key(
                "file",
                Kind::Text,
                "",
                "",
                "The file, of any format that cities are read from, relative to the scene file.",
                "\"lens.obj\"",
            ),
            key("at", Kind::Point, "[0, 0, 0]", "m", "Where its origin is put.", "[78600.0, 457950.0, 10.0]"),
            ROTATION,
            key(
                "scale",
                Kind::Number { min: 0.0, max: FAR_M },
                "1",
                "metres per unit",
                "Its size; more than 0.",
                "2.5",
            ),
        ],
    },
    Table {
        name: "mask",
        doc: "What stands over a polygon, such as a district, or over the light pixels of an image.",
        keys: &[
            shape_kind("\"mask\""),
            key(
                "points",
                Kind::PlanPoints(3),
                "none: `image`",
                "m",
                "The polygon's corners `[x, y]` along its border, either way round.",
                "[[0, 0], [90, 0], [60, 80]]",
            ),
            key("holes", Kind::Rings, "none", "m", "Corners of its holes.", "[[[40, 10], [50, 10], [50, 20]]]"),
            key(
                "image",
                Kind::Text,
                "none: `points`",
                "",
                "A PNG or JPEG, relative to the scene file. A pixel is in where it is opaque and at least as light as mid grey. North is up.",
                "\"district.png\"",
            ),
            key("corner", Kind::PlanPoint, "none", "m", "Of an image: its south-west corner.", "[78000.0, 457000.0]"),
            key("size", Kind::PlanLengths, "none", "m", "Of an image: its width and height in plan.", "[400.0, 300.0]"),
            BASE,
            HIGH,
        ],
    },
    Table {
        name: "mask3d",
        doc: "The light pixels of images that lie on each other, layer by layer.",
        keys: &[
            shape_kind("\"mask3d\""),
            key(
                "images",
                Kind::Texts,
                "",
                "",
                "One PNG or JPEG per layer, bottom to top, all of one size; as for `mask`.",
                "[\"low.png\", \"high.png\"]",
            ),
            key(
                "corner",
                Kind::Point,
                "",
                "m",
                "The south-west corner of the lowest layer.",
                "[78000.0, 457000.0, 0.0]",
            ),
            key("size", Kind::Lengths, "", "m", "Full extent along x, y, z.", "[40.0, 30.0, 20.0]"),
        ],
    },
    Table {
        name: "sprite",
        doc: "What a saved depth sprite holds (`veduta render --sprite`, [sprites.md](sprites.md)): what lies between entry and exit of \
              the ray of each of its texels. It is tested in its own space, as a sprite with a `camera` is; `sprite` of the lens may give it other \
              `near`, `far`, `format` and `mapping` than it was saved with. It has no soft border and is no part of combinations.",
        keys: &[
            shape_kind("\"sprite\""),
            key("file", Kind::Text, "", "", "The file, OpenEXR, relative to the scene file.", "\"hall.exr\""),
        ],
    },
    Table {
        name: "objects",
        doc: "The union of the volumes of city objects, as they are shown; open ones are closed.",
        keys: &[shape_kind("\"objects\""), IDS, TYPES, ATTRIBUTE, VALUES, MIN, MAX, EXCEPT],
    },
    Table {
        name: "thematic",
        doc: "Everything that belongs to city objects, wherever it is: membership by object, not by place. Nothing is in front of it or behind it.",
        keys: &[shape_kind("\"thematic\""), IDS, TYPES, ATTRIBUTE, VALUES, MIN, MAX, EXCEPT],
    },
    Table {
        name: "enclosed",
        doc: "Everything that belongs to the city objects that some shapes hold or touch, wherever it is: the lens acts on whole buildings, and as it moves, on others. A part stands for all of its building, a member of a group for itself; what others stand on (terrain, water, roads, land use) is never meant. Nothing is in front of it or behind it.",
        keys: &[
            shape_kind("\"enclosed\""),
            key(
                "shapes",
                Kind::Shapes,
                "",
                "",
                "What encloses them: shapes of any kind.",
                "[{ kind = \"sphere\", center = [78600.0, 457950.0, 10.0], radius = 60.0 }]",
            ),
            key(
                "whole",
                Kind::Boolean,
                "false",
                "",
                "Only objects that lie in the shapes with all their corners.",
                "true",
            ),
            key(
                "types",
                Kind::Texts,
                "all",
                "",
                "Only objects of these types, as their files call them; parts are of the type of what they are part of.",
                "[\"Building\"]",
            ),
        ],
    },
    Table { name: "union", doc: "What is in any of some shapes.", keys: &[shape_kind("\"union\""), PARTS] },
    Table {
        name: "intersection",
        doc: "What is in all of some shapes.",
        keys: &[shape_kind("\"intersection\""), PARTS],
    },
    Table {
        name: "difference",
        doc: "What is in the first of some shapes and in none of the others.",
        keys: &[shape_kind("\"difference\""), PARTS],
    },
];

/// Shapes that are made from files, images, polygons or the city ([`crate::lens::Focus`]).
pub const FOCUSES: &[&str] =
    &["mesh", "sprite", "mask", "mask3d", "objects", "thematic", "union", "intersection", "difference"];
