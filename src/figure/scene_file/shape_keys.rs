//! The tables of shapes in scene files.

use std::path::PathBuf;

use glam::{DQuat, DVec3};

use crate::{
    figure::scene_file::{
        choice::{self, CHOICE},
        forms::{Axis, Form as _, Same, Turn},
        given_keys::{self, GIVEN},
        handled,
        keys::{FAR_M, Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        row::{Row, Variant, kind, part, tables, variant},
    },
    geom::{Shape, combination::Operation, shape::FlatFigure},
    lens::{Focus, Handled, chosen::Choice},
};

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
const PARTS: Key = key(
    "shapes",
    Kind::Shapes,
    "",
    "",
    "The shapes, of any kind, combinations too; at most 64 in all.",
    "[{ kind = \"sphere\", center = [0, 0, 0], radius = 9 }, { kind = \"sphere\", center = [5, 0, 0], radius = 9 }]",
);

/// Shapes of lenses.
pub const SHAPES: &[Table] = &tables::<_, { SHAPE_KINDS.len() }>(SHAPE_KINDS);

const SHAPE_KINDS: &[Variant<Focus>] = &given_keys::with::<{ GIVEN.len() + OTHERS.len() }>(OTHERS);

/// Shapes with rows of their own.
const OTHERS: &[Variant<Focus>] = &[
    variant!(
        Focus,
        "cone",
        "A cone; its middle is half way up its axis, its tip at the axis' end.",
        Focus::Shape(Shape::Frustum { center: DVec3::ZERO, radius: 0.0, top_radius: 0.0, height: 0.0, axis: DVec3::Z }),
        Focus::Shape(Shape::Frustum { top_radius: 0.0, .. }),
        &[
            kind!("cone", "Which shape."),
            part!(Focus, CENTER, Same, Focus::Shape(Shape::Frustum { center, .. }) => center),
            part!(Focus, RADIUS, Same, Focus::Shape(Shape::Frustum { radius, .. }) => radius),
            part!(Focus, HEIGHT, Same, Focus::Shape(Shape::Frustum { height, .. }) => height),
            part!(Focus, AXIS, Axis, Focus::Shape(Shape::Frustum { axis, .. }) => axis),
        ]
    ),
    variant!(
        Focus,
        "frustum",
        "A cone without its tip.",
        Focus::Shape(Shape::Frustum { center: DVec3::ZERO, radius: 0.0, top_radius: 0.0, height: 0.0, axis: DVec3::Z }),
        Focus::Shape(Shape::Frustum { .. }),
        &[
            kind!("frustum", "Which shape."),
            part!(Focus, CENTER, Same, Focus::Shape(Shape::Frustum { center, .. }) => center),
            part!(Focus, key("radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis begins.", "60.0"), Same, Focus::Shape(Shape::Frustum { radius, .. }) => radius),
            part!(Focus, key("top_radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis ends.", "20.0"), Same, Focus::Shape(Shape::Frustum { top_radius, .. }) => top_radius),
            part!(Focus, HEIGHT, Same, Focus::Shape(Shape::Frustum { height, .. }) => height),
            part!(Focus, AXIS, Axis, Focus::Shape(Shape::Frustum { axis, .. }) => axis),
        ]
    ),
    variant!(
        Focus,
        "convex",
        "The convex hull of points.",
        Focus::Shape(Shape::Convex { points: Vec::new() }),
        Focus::Shape(Shape::Convex { .. }),
        &[
            kind!("convex", "Which shape."),
            part!(Focus, key(
                "points",
                Kind::Points(4),
                "",
                "m",
                "At least four, not all on one plane; at most 4096.",
                "[[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]",
            ), Same, Focus::Shape(Shape::Convex { points, .. }) => points),
        ]
    ),
    variant!(
        Focus,
        "polytope",
        "The body between planes.",
        Focus::Shape(Shape::Polytope { planes: Vec::new() }),
        Focus::Shape(Shape::Polytope { .. }),
        &[
            kind!("polytope", "Which shape."),
            part!(Focus, key(
                "planes",
                Kind::Planes(4),
                "",
                "",
                "Planes `[nx, ny, nz, d]`, at most 64: inside is where nx x + ny y + nz z ≤ d for each of them. The normal points outwards and has any length but 0; with length 1, d is in metres. They must close the body on all sides.",
                "[[1, 0, 0, 9], [-1, 0, 0, 0], [0, 1, 0, 9], [0, -1, 0, 0], [0, 0, 1, 9], [0, 0, -1, 0]]",
            ), Same, Focus::Shape(Shape::Polytope { planes, .. }) => planes),
        ]
    ),
    variant!(
        Focus,
        "corridor",
        "What lies along a line, such as a route: within half the width of it seen from above, and half the height above and below it. Corners are round.",
        Focus::Shape(Shape::Corridor { points: Vec::new(), width: 0.0, height: 0.0 }),
        Focus::Shape(Shape::Corridor { .. }),
        &[
            kind!("corridor", "Which shape."),
            part!(Focus, key(
                "points",
                Kind::Points(2),
                "",
                "m",
                "The line; at least two points, at most 4096.",
                "[[0, 0, 2], [60, 10, 2], [90, 80, 5]]",
            ), Same, Focus::Shape(Shape::Corridor { points, .. }) => points),
            part!(Focus, key("width", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "From side to side.", "12.0"), Same, Focus::Shape(Shape::Corridor { width, .. }) => width),
            part!(Focus, key(
                "height",
                Kind::Number { min: 0.0, max: FAR_M },
                "",
                "m",
                "From its floor to its top; the line is in the middle.",
                "30.0",
            ), Same, Focus::Shape(Shape::Corridor { height, .. }) => height),
        ]
    ),
    variant!(
        Focus,
        "flat",
        "What is seen through a figure: a disc, a rectangle or a polygon; exactly one of `radius`, `size` and `points`. It \
              begins in the figure's plane and reaches from there to infinity, away from the eye: the sky behind it is in it, \
              what stands before it is not. Both sides of the figure are alike. An eye in its plane sees it edge on: it holds \
              nothing then. It acts only in the view that the scene is looked at in.",
        Focus::Shape(Shape::Flat {
            center: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            figure: FlatFigure::Disc { radius: 0.0 }
        }),
        Focus::Shape(Shape::Flat { .. }),
        &[
            kind!("flat", "Which shape."),
            part!(Focus, key("center", Kind::Point, "", "m", "Where the (0, 0) of the figure is.", "[78600.0, 457950.0, 10.0]"), Same, Focus::Shape(Shape::Flat { center, .. }) => center),
            part!(Focus, key(
                "rotation_deg",
                Kind::Angles,
                "[0, 0, 0]",
                "degrees",
                "`[yaw, pitch, roll]`, as of a box: without, the figure lies level; `[yaw, 0, 90]` stands upright, its x along the yaw.",
                "[30.0, 0.0, 90.0]",
            ), Turn, Focus::Shape(Shape::Flat { rotation, .. }) => rotation),
            Row::<Focus>::joint(
                key(
                    "radius",
                    Kind::Number { min: 0.0, max: FAR_M },
                    "none",
                    "m",
                    "Of a disc; 0 holds nothing.",
                    "20.0"
                ),
                |focus, _| match figure(focus)? {
                    FlatFigure::Disc { radius } => Some((*radius).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key(
                    "size",
                    Kind::PlanLengths,
                    "none",
                    "m",
                    "Of a rectangle: full edges along its x and y.",
                    "[40.0, 25.0]",
                ),
                |focus, _| match figure(focus)? {
                    FlatFigure::Rectangle { size } => Some((*size).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key(
                    "points",
                    Kind::PlanPoints(3),
                    "none",
                    "m",
                    "Of a polygon, convex or not, in the figure's x and y; at most 1024. Where it crosses itself, all that it goes around is in it.",
                    "[[-20, -10], [20, -10], [0, 15]]",
                ),
                |focus, _| match figure(focus)? {
                    FlatFigure::Polygon { points } => Same::data(points),
                    _ => None,
                }
            )
            .always(),
        ]
    ),
    variant!(
        Focus,
        "mesh",
        "What the faces of a file enclose; it may be concave, in several parts, or touch and cross itself. Faces turned the wrong way and small holes are mended.",
        Focus::Mesh { file: PathBuf::new(), at: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 },
        Focus::Mesh { .. },
        &[
            kind!("mesh", "Which shape."),
            Row::<Focus>::joint(
                key("file", Kind::Text, "", "", "The file, of any format that cities are read from, relative to the scene file.", "\"lens.obj\"",),
                |focus, options| match focus {
                    Focus::Mesh { file, .. } => Some(path_data(file, options)),
                    _ => None,
                }
            )
            .always(),
            part!(Focus, key("at", Kind::Point, "[0, 0, 0]", "m", "Where its origin is put.", "[78600.0, 457950.0, 10.0]"), Same, Focus::Mesh { at, .. } => at),
            part!(Focus, ROTATION, Turn, Focus::Mesh { rotation, .. } => rotation),
            part!(Focus, key(
                "scale",
                Kind::Number { min: 0.0, max: FAR_M },
                "1",
                "metres per unit",
                "Its size; more than 0.",
                "2.5",
            ), Same, Focus::Mesh { scale, .. } => scale),
        ]
    ),
    variant!(
        Focus,
        "mask",
        "What stands over a polygon, such as a district, or over the light pixels of an image.",
        Focus::Prism { points: Vec::new(), holes: Vec::new(), base: 0.0, height: 0.0 },
        Focus::Prism { .. } | Focus::Mask { .. },
        &[
            kind!("mask", "Which shape."),
            Row::<Focus>::joint(
                key(
                    "points",
                    Kind::PlanPoints(3),
                    "none: `image`",
                    "m",
                    "The polygon's corners `[x, y]` along its border, either way round.",
                    "[[0, 0], [90, 0], [60, 80]]",
                ),
                |focus, _| match focus {
                    Focus::Prism { points, .. } => Same::data(points),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key("holes", Kind::Rings, "none", "m", "Corners of its holes.", "[[[40, 10], [50, 10], [50, 20]]]"),
                |focus, _| match focus {
                    Focus::Prism { holes, .. } if !holes.is_empty() => Same::data(holes),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key(
                    "image",
                    Kind::Text,
                    "none: `points`",
                    "",
                    "A PNG or JPEG, relative to the scene file. A pixel is in where it is opaque and at least as light as mid grey. North is up.",
                    "\"district.png\"",
                ),
                |focus, options| match focus {
                    Focus::Mask { image, .. } => Some(path_data(image, options)),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key(
                    "corner",
                    Kind::PlanPoint,
                    "none",
                    "m",
                    "Of an image: its south-west corner.",
                    "[78000.0, 457000.0]"
                ),
                |focus, _| match focus {
                    Focus::Mask { corner, .. } => Some((*corner).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Focus>::joint(
                key(
                    "size",
                    Kind::PlanLengths,
                    "none",
                    "m",
                    "Of an image: its width and height in plan.",
                    "[400.0, 300.0]"
                ),
                |focus, _| match focus {
                    Focus::Mask { size, .. } => Some((*size).into()),
                    _ => None,
                }
            )
            .always(),
            part!(Focus, BASE, Same, Focus::Prism { base, .. } | Focus::Mask { base, .. } => base),
            part!(Focus, HIGH, Same, Focus::Prism { height, .. } | Focus::Mask { height, .. } => height),
        ]
    ),
    variant!(
        Focus,
        "mask3d",
        "The light pixels of images that lie on each other, layer by layer.",
        Focus::Mask3d { images: Vec::new(), corner: DVec3::ZERO, size: DVec3::ZERO },
        Focus::Mask3d { .. },
        &[
            kind!("mask3d", "Which shape."),
            Row::<Focus>::joint(
                key(
                    "images",
                    Kind::Texts,
                    "",
                    "",
                    "One PNG or JPEG per layer, bottom to top, all of one size; as for `mask`.",
                    "[\"low.png\", \"high.png\"]",
                ),
                |focus, options| match focus {
                    Focus::Mask3d { images, .. } =>
                        Some(Data::list(images.iter().map(|file| path_data(file, options)))),
                    _ => None,
                }
            )
            .always(),
            part!(Focus, key(
                "corner",
                Kind::Point,
                "",
                "m",
                "The south-west corner of the lowest layer.",
                "[78000.0, 457000.0, 0.0]",
            ), Same, Focus::Mask3d { corner, .. } => corner),
            part!(Focus, key("size", Kind::Lengths, "", "m", "Full extent along x, y, z.", "[40.0, 30.0, 20.0]"), Same, Focus::Mask3d { size, .. } => size),
        ]
    ),
    variant!(
        Focus,
        "sprite",
        "What a saved depth sprite holds (`veduta render --sprite`, [sprites.md](sprites.md)): what lies between entry and exit of \
              the ray of each of its texels. It is tested in its own space, as a sprite with a `camera` is; `sprite` of the lens may give it other \
              `near`, `far`, `format` and `mapping` than it was saved with. It has no soft border and is no part of combinations.",
        Focus::Sprite { file: PathBuf::new() },
        Focus::Sprite { .. },
        &[
            kind!("sprite", "Which shape."),
            Row::<Focus>::joint(
                key("file", Kind::Text, "", "", "The file, OpenEXR, relative to the scene file.", "\"hall.exr\""),
                |focus, options| match focus {
                    Focus::Sprite { file } => Some(path_data(file, options)),
                    _ => None,
                }
            )
            .always(),
        ]
    ),
    variant!(
        Focus,
        "objects",
        "The union of the volumes of city objects, as they are shown; open ones are closed.",
        Focus::Objects(Choice::default()),
        Focus::Objects(_),
        &[
            kind!("objects", "Which shape."),
            Row::<Focus>::joint(CHOICE.keys[0], |focus, options| chosen_key(focus, "ids", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[1], |focus, options| chosen_key(focus, "types", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[2], |focus, options| chosen_key(focus, "attribute", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[3], |focus, options| chosen_key(focus, "values", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[4], |focus, options| chosen_key(focus, "min", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[5], |focus, options| chosen_key(focus, "max", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[6], |focus, options| chosen_key(focus, "except", options)).always(),
        ]
    ),
    variant!(
        Focus,
        "thematic",
        "Everything that belongs to city objects, wherever it is: membership by object, not by place. Nothing is in front of it or behind it.",
        Focus::Thematic(Choice::default()),
        Focus::Thematic(_),
        &[
            kind!("thematic", "Which shape."),
            Row::<Focus>::joint(CHOICE.keys[0], |focus, options| chosen_key(focus, "ids", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[1], |focus, options| chosen_key(focus, "types", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[2], |focus, options| chosen_key(focus, "attribute", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[3], |focus, options| chosen_key(focus, "values", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[4], |focus, options| chosen_key(focus, "min", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[5], |focus, options| chosen_key(focus, "max", options)).always(),
            Row::<Focus>::joint(CHOICE.keys[6], |focus, options| chosen_key(focus, "except", options)).always(),
        ]
    ),
    variant!(
        Focus,
        "enclosed",
        "Everything that belongs to the city objects that some shapes hold or touch, wherever it is: the lens acts on whole buildings, and as it moves, on others. A part stands for all of its building, a member of a group for itself; what others stand on (terrain, water, roads, land use) is never meant. Nothing is in front of it or behind it.",
        Focus::Enclosed { parts: Vec::new(), whole: false, types: Vec::new() },
        Focus::Enclosed { .. },
        &[
            kind!("enclosed", "Which shape."),
            Row::<Focus>::joint(
                key(
                    "shapes",
                    Kind::Shapes,
                    "",
                    "",
                    "What encloses them: shapes of any kind.",
                    "[{ kind = \"sphere\", center = [78600.0, 457950.0, 10.0], radius = 60.0 }]",
                ),
                |focus, options| match focus {
                    Focus::Enclosed { parts, .. } => parts_data(parts, options),
                    _ => None,
                }
            )
            .always(),
            part!(Focus, key(
                "whole",
                Kind::Boolean,
                "false",
                "",
                "Only objects that lie in the shapes with all their corners.",
                "true",
            ), Same, Focus::Enclosed { whole, .. } => whole),
            part!(Focus, key(
                "types",
                Kind::Texts,
                "all",
                "",
                "Only objects of these types, as their files call them; parts are of the type of what they are part of.",
                "[\"Building\"]",
            ), Same, Focus::Enclosed { types, .. } => types),
        ]
    ),
    variant!(
        Focus,
        "union",
        "What is in any of some shapes.",
        Focus::Combined { how: Operation::Union, parts: Vec::new() },
        Focus::Combined { how: Operation::Union, .. },
        &[
            kind!("union", "Which shape."),
            Row::<Focus>::joint(PARTS, |focus, options| match focus {
                Focus::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
    variant!(
        Focus,
        "intersection",
        "What is in all of some shapes.",
        Focus::Combined { how: Operation::Intersection, parts: Vec::new() },
        Focus::Combined { how: Operation::Intersection, .. },
        &[
            kind!("intersection", "Which shape."),
            Row::<Focus>::joint(PARTS, |focus, options| match focus {
                Focus::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
    variant!(
        Focus,
        "difference",
        "What is in the first of some shapes and in none of the others.",
        Focus::Combined { how: Operation::Difference, parts: Vec::new() },
        Focus::Combined { how: Operation::Difference, .. },
        &[
            kind!("difference", "Which shape."),
            Row::<Focus>::joint(PARTS, |focus, options| match focus {
                Focus::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
];

/// The box of a user's region test; its other keys are its handler's.
pub const OWN: Variant<Focus> = variant!(
    Focus,
    "own",
    "A region test of your own, in a box.",
    Focus::Own { used: Handled::nameless(), center: DVec3::ZERO, size: DVec3::ZERO, rotation: DQuat::IDENTITY },
    Focus::Own { .. },
    &[
        part!(Focus, CENTER, Same, Focus::Own { center, .. } => center),
        part!(Focus, key("size", Kind::Lengths, "", "m", "Full edges along its own x, y, z.", "[40.0, 20.0, 30.0]"), Same, Focus::Own { size, .. } => size),
        part!(Focus, ROTATION, Turn, Focus::Own { rotation, .. } => rotation),
    ]
);

/// The kind of shape that a table is by this name.
pub fn kind_of(name: &str) -> Option<&'static Variant<Focus>> {
    SHAPE_KINDS.iter().find(|own| own.table.name == name)
}

/// A focus area as its table; `None` where a lens has it as keys of its own.
pub fn written(focus: &Focus, options: &Options) -> Option<Data> {
    if let Focus::Own { used, .. } = focus {
        return Some(handled::written_over(used, OWN.written(focus, options)));
    }
    Some(Variant::of(SHAPE_KINDS, focus)?.written(focus, options))
}

fn parts_data(parts: &[Focus], options: &Options) -> Option<Data> {
    Some(Data::list(parts.iter().filter_map(|part| written(part, options))))
}

fn path_data(file: &std::path::Path, options: &Options) -> Data {
    Data::Text(options.written(file))
}

fn figure(focus: &Focus) -> Option<&FlatFigure> {
    match focus {
        Focus::Shape(Shape::Flat { figure, .. }) => Some(figure),
        _ => None,
    }
}

/// A key of the choice that a shape is.
fn chosen_key(focus: &Focus, key: &str, options: &Options) -> Option<Data> {
    let (Focus::Objects(choice) | Focus::Thematic(choice)) = focus else { return None };
    Node::of(choice::written(choice, options)).entry(key).map(|node| node.data.clone())
}
