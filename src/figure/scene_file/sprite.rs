//! `sprite` of a lens in scene files: its keys, read and written.

use crate::{
    figure::scene_file::{
        camera::{self, CAMERA, Eye},
        check::Fields,
        forms::{Same, Word},
        keys::{FAR_M, Kind, Table, key},
        node::Data,
        paths::Options,
        reader::Reader,
        row::{self, Given, Row, field, keys_of},
    },
    lens::{
        LensSprite, OwnEye,
        sprite::{Format, LAYERS, MOST_LAYERS, Mapping},
    },
};

/// `sprite` of a lens.
pub const SPRITE: Table = Table {
    name: "sprite",
    doc: "Has the lens tested by a volumetric depth sprite: a picture of where each ray enters and leaves it. Without, it is \
          tested from its shapes: exact to the pixel, and faster; `{}` is a sprite as fine as the picture, in 32-bit float, \
          which agrees with the shapes to a texel; what lies in the surface of a lens, as the walls of its own objects do, may \
          be on either side. All shapes of a lens share one sprite; `thematic` ones, alone or in a \
          combination, have none and stay as they are. Other formats and mappings are there to see what they cost \
          (`veduta measure sprites`).",
    keys: keys_of!(SPRITE_ROWS),
};

const SPRITE_ROWS: &[Row<LensSprite>] = &[
    Row::<LensSprite>::new(
        key(
            "camera",
            Kind::Table(&SPRITE_CAMERA),
            "the picture's eye",
            "",
            "An eye of its own that the sprite is made from, and kept between pictures. What is shown is looked for in the sprite's \
             own space: `front`, `inside` and `behind` are then those of this eye, along its axis. What is behind this eye or out of \
             its frame is in none of them: `rest`.",
            "{ eye = [78500.0, 457800.0, 150.0], target = [78600.0, 458000.0, 10.0] }",
        ),
        |sprite, options| sprite.own.as_ref().map(|own| eye_data(own, options)),
        |sprite, given| sprite.own = eye(given),
    ),
    field!(
        key(
            "resolution",
            Kind::Integer { min: 16, max: 16_384 },
            "the picture's; with `camera` 512",
            "texels",
            "Texels along the longer side of the picture, or of the frame of `camera`.",
            "512",
        ),
        Same,
        |sprite: LensSprite| sprite.resolution
    ),
    field!(
        key(
            "format",
            Kind::Word { now: &["unorm8", "unorm16", "uint32", "float16", "float32"], later: &[] },
            "\"float32\"",
            "",
            "What a stored depth is. `uint32` is made from a float: 24 of its bits say something.",
            "\"unorm16\"",
        ),
        Word,
        |sprite: LensSprite| sprite.format
    ),
    field!(
        key(
            "mapping",
            Kind::Word { now: &["z", "complementary-z", "w", "1/w"], later: &[] },
            "\"1/w\"",
            "",
            "How the distance D along the view axis becomes a depth, n and f being `near` and `far`: `z` f/(f-n)·(1-n/D), \
             `complementary-z` n/(f-n)·(f/D-1), `w` D/f, `1/w` n/D.",
            "\"w\"",
        ),
        Word,
        |sprite: LensSprite| sprite.mapping
    ),
    field!(
        key(
            "near",
            Kind::Number { min: 1e-4, max: FAR_M },
            "where the lens begins; of 32-bit `1/w`: the camera's",
            "m",
            "Near clip plane of stored depths. What lies before it is clamped to it.",
            "10.0",
        ),
        Same,
        |sprite: LensSprite| sprite.near_m
    ),
    field!(
        key(
            "far",
            Kind::Number { min: 1e-3, max: FAR_M },
            "where the lens ends",
            "m",
            "Far clip plane of stored depths, beyond `near`. `1/w` has none.",
            "500.0",
        ),
        Same,
        |sprite: LensSprite| sprite.far_m
    ),
    field!(
        key(
            "layers",
            Kind::Integer { min: 1, max: MOST_LAYERS as i64 },
            "4",
            "",
            "Of lenses that are not convex: how often a ray may enter and leave them. Where one does so more often, its last \
             layer takes in the rest, and a warning says how many rays do.",
            "8",
        ),
        Same,
        |sprite: LensSprite| sprite.layers
    ),
    field!(
        key(
            "aggregate",
            Kind::Boolean,
            "false",
            "",
            "Keeps where a ray enters first and leaves last and nothing of what is between (V's aggregate), for comparison.",
            "true",
        ),
        Same,
        |sprite: LensSprite| sprite.aggregate
    ),
];

/// `camera` of the sprite of a lens.
pub const SPRITE_CAMERA: Table = Table {
    name: "camera",
    doc: "The eye that a sprite is made from, with the keys of `[camera]`; it is in the coordinates of the lens' shapes, and moves \
          with them.",
    keys: &[
        CAMERA.keys[0],
        CAMERA.keys[1],
        CAMERA.keys[2],
        CAMERA.keys[3],
        CAMERA.keys[4],
        CAMERA.keys[5],
        key(
            "near_m",
            Kind::Number { min: 1e-4, max: 1e6 },
            "a 512th of the way to the target, 0.125 to 1",
            "m",
            "Where a lens begins nearer than this along the axis, this eye counts as inside of it.",
            "0.5",
        ),
        key("aspect", Kind::Number { min: 0.01, max: 100.0 }, "1.0", "", "Width of the frame over its height.", "1.5"),
    ],
};

/// A sprite of which nothing is said.
const PLAIN: LensSprite = LensSprite {
    own: None,
    resolution: None,
    format: Format::Float32,
    mapping: Mapping::InverseW,
    near_m: None,
    far_m: None,
    layers: LAYERS,
    aggregate: false,
};

/// The sprite of a lens, if it has one. A lens whose shapes are all of files (`is_saved`) has their eyes, texels and layers.
pub fn read(reader: &mut Reader, lens: &Fields, is_saved: bool) -> Option<LensSprite> {
    let node = lens.node("sprite")?;
    let fields = reader.checker.fields(node, &SPRITE, &[], lens.place.within("sprite", node.line));
    let mut sprite = PLAIN;
    row::read(SPRITE_ROWS, &fields, reader, &mut sprite);
    for key in ["camera", "resolution", "layers"].into_iter().filter(|key| is_saved && fields.given(key)) {
        let message = "has no meaning where all shapes are depth sprites of files, which have theirs";
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
    if let (Some(near), Some(far)) = (sprite.near_m, sprite.far_m)
        && far <= near
    {
        let message = format!("must lie beyond near, {near} m, is {far}");
        reader.checker.note(&fields.place, "far", fields.line("far"), message);
    }
    Some(sprite)
}

/// The table of a sprite.
pub fn written(sprite: &LensSprite, options: &Options) -> Data {
    row::written(SPRITE_ROWS, sprite, &PLAIN, options)
}

/// How wide the frame of an eye is over its height, where nothing is said.
const ASPECT: f64 = 1.0;

fn eye(given: &mut Given) -> Option<OwnEye> {
    let own = given.table(&SPRITE_CAMERA);
    Some(OwnEye { camera: camera::read(given.reader, &own)?.camera, aspect: own.number("aspect").unwrap_or(ASPECT) })
}

fn eye_data(own: &OwnEye, options: &Options) -> Data {
    let mut data = camera::written(&Eye { camera: own.camera, above_ground: false }, options);
    if own.aspect != ASPECT {
        data.push("aspect", own.aspect);
    }
    data
}
