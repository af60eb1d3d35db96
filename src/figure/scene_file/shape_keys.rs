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
    lens::{Handled, Region, chosen::Choice},
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

const SHAPE_KINDS: &[Variant<Region>] = &given_keys::with::<{ GIVEN.len() + OTHERS.len() }>(OTHERS);

/// Shapes with rows of their own.
const OTHERS: &[Variant<Region>] = &[
    variant!(
        Region,
        "cone",
        "A cone; its middle is half way up its axis, its tip at the axis' end.",
        Region::Shape(Shape::Frustum { center: DVec3::ZERO, radius: 0.0, top_radius: 0.0, height: 0.0, axis: DVec3::Z }),
        Region::Shape(Shape::Frustum { top_radius: 0.0, .. }),
        &[
            kind!("cone", "Which shape."),
            part!(Region, CENTER, Same, Region::Shape(Shape::Frustum { center, .. }) => center),
            part!(Region, RADIUS, Same, Region::Shape(Shape::Frustum { radius, .. }) => radius),
            part!(Region, HEIGHT, Same, Region::Shape(Shape::Frustum { height, .. }) => height),
            part!(Region, AXIS, Axis, Region::Shape(Shape::Frustum { axis, .. }) => axis),
        ]
    ),
    variant!(
        Region,
        "frustum",
        "A cone without its tip.",
        Region::Shape(Shape::Frustum { center: DVec3::ZERO, radius: 0.0, top_radius: 0.0, height: 0.0, axis: DVec3::Z }),
        Region::Shape(Shape::Frustum { .. }),
        &[
            kind!("frustum", "Which shape."),
            part!(Region, CENTER, Same, Region::Shape(Shape::Frustum { center, .. }) => center),
            part!(Region, key("radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis begins.", "60.0"), Same, Region::Shape(Shape::Frustum { radius, .. }) => radius),
            part!(Region, key("top_radius", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "Where the axis ends.", "20.0"), Same, Region::Shape(Shape::Frustum { top_radius, .. }) => top_radius),
            part!(Region, HEIGHT, Same, Region::Shape(Shape::Frustum { height, .. }) => height),
            part!(Region, AXIS, Axis, Region::Shape(Shape::Frustum { axis, .. }) => axis),
        ]
    ),
    variant!(
        Region,
        "convex",
        "The convex hull of points.",
        Region::Shape(Shape::Convex { points: Vec::new() }),
        Region::Shape(Shape::Convex { .. }),
        &[
            kind!("convex", "Which shape."),
            part!(Region, key(
                "points",
                Kind::Points(4),
                "",
                "m",
                "At least four, not all on one plane; at most 4096.",
                "[[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]",
            ), Same, Region::Shape(Shape::Convex { points, .. }) => points),
        ]
    ),
    variant!(
        Region,
        "polytope",
        "The body between planes.",
        Region::Shape(Shape::Polytope { planes: Vec::new() }),
        Region::Shape(Shape::Polytope { .. }),
        &[
            kind!("polytope", "Which shape."),
            part!(Region, key(
                "planes",
                Kind::Planes(4),
                "",
                "",
                "Planes `[nx, ny, nz, d]`, at most 64: inside is where nx x + ny y + nz z ≤ d for each of them. The normal points outwards and has any length but 0; with length 1, d is in metres. They must close the body on all sides.",
                "[[1, 0, 0, 9], [-1, 0, 0, 0], [0, 1, 0, 9], [0, -1, 0, 0], [0, 0, 1, 9], [0, 0, -1, 0]]",
            ), Same, Region::Shape(Shape::Polytope { planes, .. }) => planes),
        ]
    ),
    variant!(
        Region,
        "corridor",
        "What lies along a line, such as a route: within half the width of it seen from above, and half the height above and below it. Corners are round.",
        Region::Shape(Shape::Corridor { points: Vec::new(), width: 0.0, height: 0.0 }),
        Region::Shape(Shape::Corridor { .. }),
        &[
            kind!("corridor", "Which shape."),
            part!(Region, key(
                "points",
                Kind::Points(2),
                "",
                "m",
                "The line; at least two points, at most 4096.",
                "[[0, 0, 2], [60, 10, 2], [90, 80, 5]]",
            ), Same, Region::Shape(Shape::Corridor { points, .. }) => points),
            part!(Region, key("width", Kind::Number { min: 0.0, max: FAR_M }, "", "m", "From side to side.", "12.0"), Same, Region::Shape(Shape::Corridor { width, .. }) => width),
            part!(Region, key(
                "height",
                Kind::Number { min: 0.0, max: FAR_M },
                "",
                "m",
                "From its floor to its top; the line is in the middle.",
                "30.0",
            ), Same, Region::Shape(Shape::Corridor { height, .. }) => height),
        ]
    ),
    variant!(
        Region,
        "flat",
        "What is seen through a figure: a disc, a rectangle or a polygon; exactly one of `radius`, `size` and `points`. It \
              begins in the figure's plane and reaches from there to infinity, away from the eye: the sky behind it is in it, \
              what stands before it is not. Both sides of the figure are alike. An eye in its plane sees it edge on: it holds \
              nothing then. It acts only in the view that the scene is looked at in.",
        Region::Shape(Shape::Flat {
            center: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            figure: FlatFigure::Disc { radius: 0.0 }
        }),
        Region::Shape(Shape::Flat { .. }),
        &[
            kind!("flat", "Which shape."),
            part!(Region, key("center", Kind::Point, "", "m", "Where the (0, 0) of the figure is.", "[78600.0, 457950.0, 10.0]"), Same, Region::Shape(Shape::Flat { center, .. }) => center),
            part!(Region, key(
                "rotation_deg",
                Kind::Angles,
                "[0, 0, 0]",
                "degrees",
                "`[yaw, pitch, roll]`, as of a box: without, the figure lies level; `[yaw, 0, 90]` stands upright, its x along the yaw.",
                "[30.0, 0.0, 90.0]",
            ), Turn, Region::Shape(Shape::Flat { rotation, .. }) => rotation),
            Row::<Region>::joint(
                key(
                    "radius",
                    Kind::Number { min: 0.0, max: FAR_M },
                    "none",
                    "m",
                    "Of a disc; 0 holds nothing.",
                    "20.0"
                ),
                |region, _| match figure(region)? {
                    FlatFigure::Disc { radius } => Some((*radius).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key(
                    "size",
                    Kind::PlanLengths,
                    "none",
                    "m",
                    "Of a rectangle: full edges along its x and y.",
                    "[40.0, 25.0]",
                ),
                |region, _| match figure(region)? {
                    FlatFigure::Rectangle { size } => Some((*size).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key(
                    "points",
                    Kind::PlanPoints(3),
                    "none",
                    "m",
                    "Of a polygon, convex or not, in the figure's x and y; at most 1024. Where it crosses itself, all that it goes around is in it.",
                    "[[-20, -10], [20, -10], [0, 15]]",
                ),
                |region, _| match figure(region)? {
                    FlatFigure::Polygon { points } => Same::data(points),
                    _ => None,
                }
            )
            .always(),
        ]
    ),
    variant!(
        Region,
        "mesh",
        "What the faces of a file enclose; it may be concave, in several parts, or touch and cross itself. Faces turned the wrong way and small holes are mended.",
        Region::Mesh { file: PathBuf::new(), at: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 },
        Region::Mesh { .. },
        &[
            kind!("mesh", "Which shape."),
            Row::<Region>::joint(
                key("file", Kind::Text, "", "", "The file, of any format that cities are read from, relative to the scene file.", "\"lens.obj\"",),
                |region, options| match region {
                    Region::Mesh { file, .. } => Some(path_data(file, options)),
                    _ => None,
                }
            )
            .always(),
            part!(Region, key("at", Kind::Point, "[0, 0, 0]", "m", "Where its origin is put.", "[78600.0, 457950.0, 10.0]"), Same, Region::Mesh { at, .. } => at),
            part!(Region, ROTATION, Turn, Region::Mesh { rotation, .. } => rotation),
            part!(Region, key(
                "scale",
                Kind::Number { min: 0.0, max: FAR_M },
                "1",
                "metres per unit",
                "Its size; more than 0.",
                "2.5",
            ), Same, Region::Mesh { scale, .. } => scale),
        ]
    ),
    variant!(
        Region,
        "mask",
        "What stands over a polygon, such as a district, or over the light pixels of an image.",
        Region::Prism { points: Vec::new(), holes: Vec::new(), base: 0.0, height: 0.0 },
        Region::Prism { .. } | Region::Mask { .. },
        &[
            kind!("mask", "Which shape."),
            Row::<Region>::joint(
                key(
                    "points",
                    Kind::PlanPoints(3),
                    "none: `image`",
                    "m",
                    "The polygon's corners `[x, y]` along its border, either way round.",
                    "[[0, 0], [90, 0], [60, 80]]",
                ),
                |region, _| match region {
                    Region::Prism { points, .. } => Same::data(points),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key("holes", Kind::Rings, "none", "m", "Corners of its holes.", "[[[40, 10], [50, 10], [50, 20]]]"),
                |region, _| match region {
                    Region::Prism { holes, .. } if !holes.is_empty() => Same::data(holes),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key(
                    "image",
                    Kind::Text,
                    "none: `points`",
                    "",
                    "A PNG or JPEG, relative to the scene file. A pixel is in where it is opaque and at least as light as mid grey. North is up.",
                    "\"district.png\"",
                ),
                |region, options| match region {
                    Region::Mask { image, .. } => Some(path_data(image, options)),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key(
                    "corner",
                    Kind::PlanPoint,
                    "none",
                    "m",
                    "Of an image: its south-west corner.",
                    "[78000.0, 457000.0]"
                ),
                |region, _| match region {
                    Region::Mask { corner, .. } => Some((*corner).into()),
                    _ => None,
                }
            )
            .always(),
            Row::<Region>::joint(
                key(
                    "size",
                    Kind::PlanLengths,
                    "none",
                    "m",
                    "Of an image: its width and height in plan.",
                    "[400.0, 300.0]"
                ),
                |region, _| match region {
                    Region::Mask { size, .. } => Some((*size).into()),
                    _ => None,
                }
            )
            .always(),
            part!(Region, BASE, Same, Region::Prism { base, .. } | Region::Mask { base, .. } => base),
            part!(Region, HIGH, Same, Region::Prism { height, .. } | Region::Mask { height, .. } => height),
        ]
    ),
    variant!(
        Region,
        "mask3d",
        "The light pixels of images that lie on each other, layer by layer.",
        Region::Mask3d { images: Vec::new(), corner: DVec3::ZERO, size: DVec3::ZERO },
        Region::Mask3d { .. },
        &[
            kind!("mask3d", "Which shape."),
            Row::<Region>::joint(
                key(
                    "images",
                    Kind::Texts,
                    "",
                    "",
                    "One PNG or JPEG per layer, bottom to top, all of one size; as for `mask`.",
                    "[\"low.png\", \"high.png\"]",
                ),
                |region, options| match region {
                    Region::Mask3d { images, .. } =>
                        Some(Data::list(images.iter().map(|file| path_data(file, options)))),
                    _ => None,
                }
            )
            .always(),
            part!(Region, key(
                "corner",
                Kind::Point,
                "",
                "m",
                "The south-west corner of the lowest layer.",
                "[78000.0, 457000.0, 0.0]",
            ), Same, Region::Mask3d { corner, .. } => corner),
            part!(Region, key("size", Kind::Lengths, "", "m", "Full extent along x, y, z.", "[40.0, 30.0, 20.0]"), Same, Region::Mask3d { size, .. } => size),
        ]
    ),
    variant!(
        Region,
        "sprite",
        "What a saved depth sprite holds (`veduta render --sprite`, [sprites.md](sprites.md)): what lies between entry and exit of \
              the ray of each of its texels. It is tested in its own space, as a sprite with a `camera` is; `sprite` of the lens may give it other \
              `near`, `far`, `format` and `mapping` than it was saved with. It has no soft border and is no part of combinations.",
        Region::Sprite { file: PathBuf::new() },
        Region::Sprite { .. },
        &[
            kind!("sprite", "Which shape."),
            Row::<Region>::joint(
                key("file", Kind::Text, "", "", "The file, OpenEXR, relative to the scene file.", "\"hall.exr\""),
                |region, options| match region {
                    Region::Sprite { file } => Some(path_data(file, options)),
                    _ => None,
                }
            )
            .always(),
        ]
    ),
    variant!(
        Region,
        "magnified",
        "All that a lens that bends rays shows so many times as large as without it, or larger, along and across: with it a lens acts where there is \
              room for more, as one whose content is a finer level of detail. Of a magnifier its core, from where on behind its plane it is so large; \
              of a sampling-rate lens the part around its middle; of a fisheye and of a handler of your own all of it, where it is so large \
              anywhere. The sky is not in it. Not of feature lenses and of those with a mask. It acts in the scene's own view.",
        Region::Magnified { lens: String::new(), by: 1.5 },
        Region::Magnified { .. },
        &[
            kind!("magnified", "Which shape."),
            part!(Region, key("lens", Kind::Text, "", "", "The name of the lens.", "\"glass\""), Same, Region::Magnified { lens, .. } => lens),
            part!(Region, key(
                "by",
                Kind::Number { min: 0.01, max: 1000.0 },
                "1.5",
                "",
                "How many times as large, at least.",
                "2.0",
            ), Same, Region::Magnified { by, .. } => by),
        ]
    ),
    variant!(
        Region,
        "objects",
        "The union of the volumes of city objects, as they are shown; open ones are closed.",
        Region::Objects(Choice::default()),
        Region::Objects(_),
        &[
            kind!("objects", "Which shape."),
            Row::<Region>::joint(CHOICE.keys[0], |region, options| chosen_key(region, "ids", options)).always(),
            Row::<Region>::joint(CHOICE.keys[1], |region, options| chosen_key(region, "types", options)).always(),
            Row::<Region>::joint(CHOICE.keys[2], |region, options| chosen_key(region, "attribute", options)).always(),
            Row::<Region>::joint(CHOICE.keys[3], |region, options| chosen_key(region, "values", options)).always(),
            Row::<Region>::joint(CHOICE.keys[4], |region, options| chosen_key(region, "min", options)).always(),
            Row::<Region>::joint(CHOICE.keys[5], |region, options| chosen_key(region, "max", options)).always(),
            Row::<Region>::joint(CHOICE.keys[6], |region, options| chosen_key(region, "except", options)).always(),
            Row::<Region>::joint(CHOICE.keys[7], |region, options| chosen_key(region, "where", options)).always(),
        ]
    ),
    variant!(
        Region,
        "thematic",
        "Everything that belongs to city objects, wherever it is: membership by object, not by place. Nothing is in front of it or behind it.",
        Region::Thematic(Choice::default()),
        Region::Thematic(_),
        &[
            kind!("thematic", "Which shape."),
            Row::<Region>::joint(CHOICE.keys[0], |region, options| chosen_key(region, "ids", options)).always(),
            Row::<Region>::joint(CHOICE.keys[1], |region, options| chosen_key(region, "types", options)).always(),
            Row::<Region>::joint(CHOICE.keys[2], |region, options| chosen_key(region, "attribute", options)).always(),
            Row::<Region>::joint(CHOICE.keys[3], |region, options| chosen_key(region, "values", options)).always(),
            Row::<Region>::joint(CHOICE.keys[4], |region, options| chosen_key(region, "min", options)).always(),
            Row::<Region>::joint(CHOICE.keys[5], |region, options| chosen_key(region, "max", options)).always(),
            Row::<Region>::joint(CHOICE.keys[6], |region, options| chosen_key(region, "except", options)).always(),
            Row::<Region>::joint(CHOICE.keys[7], |region, options| chosen_key(region, "where", options)).always(),
        ]
    ),
    variant!(
        Region,
        "enclosed",
        "Everything that belongs to the city objects that some shapes hold or touch, wherever it is: the lens acts on whole buildings, and as it moves, on others. A part stands for all of its building, a member of a group for itself; what others stand on (terrain, water, roads, land use) is never meant. Nothing is in front of it or behind it.",
        Region::Enclosed { parts: Vec::new(), whole: false, types: Vec::new() },
        Region::Enclosed { .. },
        &[
            kind!("enclosed", "Which shape."),
            Row::<Region>::joint(
                key(
                    "shapes",
                    Kind::Shapes,
                    "",
                    "",
                    "What encloses them: shapes of any kind.",
                    "[{ kind = \"sphere\", center = [78600.0, 457950.0, 10.0], radius = 60.0 }]",
                ),
                |region, options| match region {
                    Region::Enclosed { parts, .. } => parts_data(parts, options),
                    _ => None,
                }
            )
            .always(),
            part!(Region, key(
                "whole",
                Kind::Boolean,
                "false",
                "",
                "Only objects that lie in the shapes with all their corners.",
                "true",
            ), Same, Region::Enclosed { whole, .. } => whole),
            part!(Region, key(
                "types",
                Kind::Texts,
                "all",
                "",
                "Only objects of these types, as their files call them; parts are of the type of what they are part of.",
                "[\"Building\"]",
            ), Same, Region::Enclosed { types, .. } => types),
        ]
    ),
    variant!(
        Region,
        "union",
        "What is in any of some shapes.",
        Region::Combined { how: Operation::Union, parts: Vec::new() },
        Region::Combined { how: Operation::Union, .. },
        &[
            kind!("union", "Which shape."),
            Row::<Region>::joint(PARTS, |region, options| match region {
                Region::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
    variant!(
        Region,
        "intersection",
        "What is in all of some shapes.",
        Region::Combined { how: Operation::Intersection, parts: Vec::new() },
        Region::Combined { how: Operation::Intersection, .. },
        &[
            kind!("intersection", "Which shape."),
            Row::<Region>::joint(PARTS, |region, options| match region {
                Region::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
    variant!(
        Region,
        "difference",
        "What is in the first of some shapes and in none of the others.",
        Region::Combined { how: Operation::Difference, parts: Vec::new() },
        Region::Combined { how: Operation::Difference, .. },
        &[
            kind!("difference", "Which shape."),
            Row::<Region>::joint(PARTS, |region, options| match region {
                Region::Combined { parts, .. } => parts_data(parts, options),
                _ => None,
            })
            .always(),
        ]
    ),
];

/// The box of a user's region test; its other keys are its handler's.
pub const OWN: Variant<Region> = variant!(
    Region,
    "own",
    "A region test of your own, in a box.",
    Region::Own { used: Handled::nameless(), center: DVec3::ZERO, size: DVec3::ZERO, rotation: DQuat::IDENTITY },
    Region::Own { .. },
    &[
        part!(Region, CENTER, Same, Region::Own { center, .. } => center),
        part!(Region, key("size", Kind::Lengths, "", "m", "Full edges along its own x, y, z.", "[40.0, 20.0, 30.0]"), Same, Region::Own { size, .. } => size),
        part!(Region, ROTATION, Turn, Region::Own { rotation, .. } => rotation),
    ]
);

/// The kind of shape that a table is by this name.
pub fn kind_of(name: &str) -> Option<&'static Variant<Region>> {
    SHAPE_KINDS.iter().find(|own| own.table.name == name)
}

/// A focus area as its table; `None` where a lens has it as keys of its own.
pub fn written(region: &Region, options: &Options) -> Option<Data> {
    if let Region::Own { used, .. } = region {
        return Some(handled::written_over(used, OWN.written(region, options)));
    }
    Some(Variant::of(SHAPE_KINDS, region)?.written(region, options))
}

fn parts_data(parts: &[Region], options: &Options) -> Option<Data> {
    Some(Data::list(parts.iter().filter_map(|part| written(part, options))))
}

fn path_data(file: &std::path::Path, options: &Options) -> Data {
    Data::Text(options.written(file))
}

fn figure(region: &Region) -> Option<&FlatFigure> {
    match region {
        Region::Shape(Shape::Flat { figure, .. }) => Some(figure),
        _ => None,
    }
}

/// A key of the choice that a shape is.
fn chosen_key(region: &Region, key: &str, options: &Options) -> Option<Data> {
    let (Region::Objects(choice) | Region::Thematic(choice)) = region else { return None };
    Node::of(choice::written(choice, options)).entry(key).map(|node| node.data.clone())
}
