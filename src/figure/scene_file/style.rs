//! `[style]` in scene files.

use crate::{
    figure::scene_file::{
        effects,
        forms::{Behind, Same, Word},
        keys::{Kind, Table, key},
        node::Data,
        row::{Given, Row, field, keys_of},
    },
    scene::{Style, Transparency, transparency::MOST_PEELED},
};

/// Words for looks.
pub const LOOKS: Kind = Kind::Word { now: &["natural", "paper", "map", "night", "blueprint"], later: &[] };

/// `[style]`.
pub const STYLE: Table =
    Table { name: "style", doc: "How everything looks that no lens changes.", keys: keys_of!(STYLE_ROWS) };

/// Its rows.
pub const STYLE_ROWS: &[Row<Style>] = &[
    field!(
        key(
            "look",
            LOOKS,
            "\"natural\"",
            "",
            "The look of the whole picture: materials under sun and sky (`natural`), a white model with fine lines on white (`paper`), flat quiet colours with cast shadows (`map`), moonlight (`night`), white lines on blue (`blueprint`). `base`, `effects` and `background` change it: a scene style among the effects stands in place of the look's.",
            "\"paper\"",
        ),
        Word,
        |style: Style| style.look
    ),
    field!(
        key(
            "base",
            Kind::Word { now: &["natural", "clay"], later: &[] },
            "\"natural\"",
            "",
            "The colours surfaces start from: the file's materials and textures, or one clay.",
            "\"clay\"",
        ),
        Word,
        |style: Style| style.base
    ),
    field!(
        key(
            "facades",
            Kind::Boolean,
            "false",
            "",
            "Storeys and windows on the walls of buildings that have no texture: as many as attributes say (`storeysAboveGround` and the like), else one for about 3 m.",
            "true",
        ),
        Same,
        |style: Style| style.facades
    ),
    Row::<Style>::new(
        key("effects", Kind::Effects, "none", "", "Effects on the context, in order; see Effects.", "[\"greyscale\"]"),
        |style, _| effects::listed(&style.effects),
        |style, given| style.effects = effects::of_context(given),
    ),
    field!(
        key(
            "background",
            Kind::Background,
            "\"sky\"",
            "",
            "What is behind the city: what the look has there (`sky`), or one colour.",
            "\"#ffffff\"",
        ),
        Behind,
        |style: Style| style.background
    ),
    field!(
        key(
            "technique",
            Kind::Word { now: &["accumulate", "branches", "regions", "three-pass"], later: &[] },
            "\"accumulate\"",
            "",
            "How lenses are evaluated: effects one after the other where their lens is (`accumulate`), or as the literature has it, for comparison; the picture is the same, see Techniques.",
            "\"regions\"",
        ),
        Word,
        |style: Style| style.technique
    ),
    Row::<Style>::new(
        key(
            "transparency",
            Kind::WordOrTable(&Transparency::WORDS, &TRANSPARENCY),
            "\"exact\"",
            "",
            "How translucent layers are laid one over the other: a method, or a method and how far it goes; see Transparency.",
            "{ method = \"k-buffer\", layers = 8 }",
        ),
        |style, _| Some(transparency_data(style.transparency)),
        |style, given| style.transparency = transparency(given).unwrap_or_default(),
    ),
    field!(
        key(
            "chord_px",
            Kind::Number { min: 0.02, max: 100.0 },
            "0.25",
            "pixels",
            "How far edges that a deformation bends may be from where they should be: what is moved is split until they are nearer.",
            "1.0",
        ),
        Same,
        |style: Style| style.chord_px
    ),
];

/// `transparency` of `[style]`.
pub const TRANSPARENCY: Table = Table {
    name: "transparency",
    doc: "A method of laying translucent layers one over the other, and how far it goes; see Transparency.",
    keys: &[
        key(
            "method",
            Kind::Word { now: &Transparency::WORDS, later: &[] },
            "",
            "",
            "The method: all layers, exactly (`exact`), or one of the literature.",
            "\"k-buffer\"",
        ),
        key(
            "layers",
            Kind::Integer { min: 0, max: MOST_PEELED as i64 },
            "of `peel` 0, of `k-buffer` 8",
            "",
            "How many layers of a pixel, from the eye: of `peel` all that are shown, 0 = until nothing is left; of `k-buffer` those that are exact, 4, 8 or 16.",
            "16",
        ),
    ],
};

fn transparency_data(method: Transparency) -> Data {
    let is_plain = Transparency::of(method.word(), None) == Ok(Some(method));
    match method.layers().filter(|_| !is_plain) {
        None => method.word().into(),
        Some(layers) => Data::table([("method", method.word().into()), ("layers", layers.into())]),
    }
}

fn transparency(given: &mut Given) -> Option<Transparency> {
    if let Some(word) = given.node.text() {
        return Transparency::of(word, None).ok()?;
    }
    let own = given.table(&TRANSPARENCY);
    match Transparency::of(own.text("method")?, own.integer("layers")) {
        Ok(method) => method,
        Err(message) => {
            given.reader.checker.note(&own.place, "layers", own.line("layers"), message);
            None
        }
    }
}
