//! `sprite` of a lens in scene files: its keys, read and written.

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        keys::{FAR_M, Kind, Table, key},
        write::{number, quoted},
    },
    lens::{
        LensSprite,
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
    keys: &[
        key(
            "resolution",
            Kind::Integer { min: 16, max: 16_384 },
            "the picture's",
            "texels",
            "Texels along the longer side of the picture.",
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

/// The sprite of a lens, if it has one.
pub fn read(checker: &mut Checker, lens: &Fields) -> Option<LensSprite> {
    let node = lens.node("sprite")?;
    let fields = checker.fields(node, &SPRITE, &[], lens.place.within("sprite", node.line));
    let sprite = LensSprite {
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
