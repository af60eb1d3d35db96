//! `sprite` of a lens in scene files: its keys, read and written.

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        keys::{CAMERA, FAR_M, Kind, Table, key},
        write::{camera_keys, number, quoted},
    },
    lens::{
        LensSprite, OwnEye,
        sprite::{Format, LAYERS, MOST_LAYERS, Mapping},
    },
    view::Camera,
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
    keys: &[
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
        key(
            "resolution",
            Kind::Integer { min: 16, max: 16_384 },
            "the picture's; with `camera` 512",
            "texels",
            "Texels along the longer side of the picture, or of the frame of `camera`.",
            "512",
        ),
        key(
            "format",
            Kind::Word { now: &["unorm8", "unorm16", "uint32", "float16", "float32"], later: &[] },
            "\"float32\"",
            "",
            "What a stored depth is. `uint32` is made from a float: 24 of its bits say something.",
            "\"unorm16\"",
        ),
        key(
            "mapping",
            Kind::Word { now: &["z", "complementary-z", "w", "1/w"], later: &[] },
            "\"1/w\"",
            "",
            "How the distance D along the view axis becomes a depth, n and f being `near` and `far`: `z` f/(f-n)·(1-n/D), \
             `complementary-z` n/(f-n)·(f/D-1), `w` D/f, `1/w` n/D.",
            "\"w\"",
        ),
        key(
            "near",
            Kind::Number { min: 1e-4, max: FAR_M },
            "where the lens begins; of 32-bit `1/w`: the camera's",
            "m",
            "Near clip plane of stored depths. What lies before it is clamped to it.",
            "10.0",
        ),
        key(
            "far",
            Kind::Number { min: 1e-3, max: FAR_M },
            "where the lens ends",
            "m",
            "Far clip plane of stored depths, beyond `near`. `1/w` has none.",
            "500.0",
        ),
        key(
            "layers",
            Kind::Integer { min: 1, max: MOST_LAYERS as i64 },
            "4",
            "",
            "Of lenses that are not convex: how often a ray may enter and leave them. Where one does so more often, its last \
             layer takes in the rest, and a warning says how many rays do.",
            "8",
        ),
        key(
            "aggregate",
            Kind::Boolean,
            "false",
            "",
            "Keeps where a ray enters first and leaves last and nothing of what is between (V's aggregate), for comparison.",
            "true",
        ),
    ],
};

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

/// The sprite of a lens, if it has one. `camera` reads the keys of a camera. A lens whose shapes are all of files (`is_saved`) has
/// their eyes, texels and layers.
pub fn read(
    checker: &mut Checker,
    lens: &Fields,
    is_saved: bool,
    camera: impl Fn(&mut Checker, &Fields) -> Option<Camera>,
) -> Option<LensSprite> {
    let node = lens.node("sprite")?;
    let fields = checker.fields(node, &SPRITE, &[], lens.place.within("sprite", node.line));
    let own = fields.node("camera").and_then(|node| {
        let own = checker.fields(node, &SPRITE_CAMERA, &[], fields.place.within("camera", node.line));
        Some(OwnEye { camera: camera(checker, &own)?, aspect: own.number("aspect").unwrap_or(1.0) })
    });
    for key in ["camera", "resolution", "layers"].into_iter().filter(|key| is_saved && fields.given(key)) {
        let message = "has no meaning where all shapes are depth sprites of files, which have theirs";
        checker.note(&fields.place, key, fields.line(key), message);
    }
    let sprite = LensSprite {
        own,
        resolution: fields.integer("resolution"),
        format: chosen(&Format::WORDS, fields.text("format")),
        mapping: chosen(&Mapping::WORDS, fields.text("mapping")),
        near_m: fields.number("near"),
        far_m: fields.number("far"),
        layers: fields.integer("layers").unwrap_or(LAYERS),
        aggregate: fields.boolean("aggregate").unwrap_or(false),
    };
    if let (Some(near), Some(far)) = (sprite.near_m, sprite.far_m)
        && far <= near
    {
        checker.note(&fields.place, "far", fields.line("far"), format!("must lie beyond near, {near} m, is {far}"));
    }
    Some(sprite)
}

/// What a word stands for; the default without one.
fn chosen<T: Copy + Default>(words: &[(&str, T)], word: Option<&str>) -> T {
    words.iter().find(|(w, _)| Some(*w) == word).map(|(_, value)| *value).unwrap_or_default()
}

/// As TOML; keys at their default are left out.
pub fn written(sprite: &LensSprite) -> String {
    let word = |name: &str, word: &str, is_default: bool| (!is_default).then(|| format!("{name} = {}", quoted(word)));
    let keys = [
        sprite.own.as_ref().map(own_written),
        sprite.resolution.map(|resolution| format!("resolution = {resolution}")),
        word("format", sprite.format.word(), sprite.format == Format::default()),
        word("mapping", sprite.mapping.word(), sprite.mapping == Mapping::default()),
        sprite.near_m.map(|near| format!("near = {}", number(near))),
        sprite.far_m.map(|far| format!("far = {}", number(far))),
        (sprite.layers != LAYERS).then(|| format!("layers = {}", sprite.layers)),
        sprite.aggregate.then(|| "aggregate = true".to_owned()),
    ];
    let keys: Vec<String> = keys.into_iter().flatten().collect();
    if keys.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", keys.join(", ")) }
}

fn own_written(own: &OwnEye) -> String {
    let mut keys: Vec<String> =
        camera_keys(&own.camera).into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
    if own.aspect != 1.0 {
        keys.push(format!("aspect = {}", number(own.aspect)));
    }
    format!("camera = {{ {} }}", keys.join(", "))
}
