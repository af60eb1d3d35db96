//! `content` of a lens in scene files: its keys, and what it derives, read and written.

use glam::DQuat;

use crate::{
    city::{
        change::Became,
        derived::{Derive, FORMS, Form, HEIGHT_RANGE_M, Height, LIFT_M, LIFT_RANGE_M, WORDS},
    },
    figure::scene_file::{
        check::{Fields, lod},
        effects::Shown,
        forms::{Form as _, Same, Turn, Word, Worded},
        handled,
        keys::{CLASSES, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    lens::{Content, Copied, Only},
    shader::{Clip, effect::AskedBy},
};

/// `content` of a lens.
pub const CONTENT: Table = Table {
    name: "content",
    doc: "What a lens shows in itself: the scene's city or another data set, in a level of detail, derived of it, moved or not. See Contents.",
    keys: keys_of!(CONTENT_ROWS),
};

const CONTENT_ROWS: &[Row<Content>] = &[
    Row::<Content>::new(
        key(
            "files",
            Kind::Texts,
            "the scene's city",
            "",
            "City files or folders of another data set, by the same rules as those of `[city]`.",
            "[\"plan.city.json\"]",
        ),
        |content, options| {
            (!content.files.is_empty())
                .then(|| Data::list(content.files.iter().map(|file| Data::Text(options.written(file)))))
        },
        |content, given| content.files = given.reader.files(given.fields, given.key, false),
    ),
    Row::<Content>::new(
        key(
            "lod",
            Kind::Lod,
            "as the scene shows its city; of other files the finest",
            "",
            "Shows no level of detail finer than this, one that the data set has.",
            "\"1.2\"",
        ),
        |content, _| content.lod.map(|lod| Data::Text(lod.to_string())),
        |content, given| content.lod = lod(given.node),
    ),
    Row::<Content>::joint(
        key(
            "derive",
            Kind::Word { now: WORDS, later: &[] },
            "as they are",
            "",
            "What objects are shown as: their bounding `box`, the `prism` over their footprint, their convex `hull`, their block model of level of detail 1 (`lod1`; where there is none the prism), themselves pressed `flat` to the ground, the same lit as they stood (`top`), themselves at another `height`. Terrain, roads, water and land use stay as they are below. See Contents.",
            "\"box\"",
        ),
        |content, _| content.derive.map(|derive| derive.form.row().word.into()),
    ),
    Row::<Content>::joint(
        key(
            "parts",
            Kind::Boolean,
            "false: a building with all its parts is one",
            "",
            "For `derive`: whether each part that has faces of its own is derived by itself.",
            "true",
        ),
        |content, _| content.derive.filter(|derive| derive.parts).map(|_| true.into()),
    )
    .after("factor"),
    Row::<Content>::joint(
        key(
            "oriented",
            Kind::Boolean,
            "false: along the axes",
            "",
            "For `derive = \"box\"`: whether boxes stand on the smallest rectangle around the footprint.",
            "true",
        ),
        |content, _| match content.derive.map(|derive| derive.form) {
            Some(Form::Box { oriented: true }) => Some(true.into()),
            _ => None,
        },
    ),
    Row::<Content>::joint(
        key(
            "lift",
            Kind::Number { min: LIFT_RANGE_M[0], max: LIFT_RANGE_M[1] },
            "0.05",
            "m",
            "For `derive = \"flat\"` and `\"top\"`: how far above the lowest point of an object it lies.",
            "0.2",
        ),
        |content, _| match content.derive.map(|derive| derive.form) {
            Some(Form::Flat { lift_m } | Form::Top { lift_m }) if lift_m != LIFT_M => Some(lift_m.into()),
            _ => None,
        },
    ),
    Row::<Content>::joint(
        key(
            "height",
            Kind::Number { min: HEIGHT_RANGE_M[0], max: HEIGHT_RANGE_M[1] },
            "what `factor` says",
            "m",
            "For `derive = \"height\"`: from the lowest point of an object to its highest. Either this or `factor`.",
            "12.0",
        ),
        |content, _| match content.derive.map(|derive| derive.form) {
            Some(Form::Height(Height::Metres(metres))) => Some(metres.into()),
            _ => None,
        },
    ),
    Row::<Content>::joint(
        key(
            "factor",
            Kind::Number { min: 0.001, max: 1000.0 },
            "what `height` says",
            "",
            "For `derive = \"height\"`: how many times as high as it is.",
            "0.5",
        ),
        |content, _| match content.derive.map(|derive| derive.form) {
            Some(Form::Height(Height::Factor(factor))) => Some(factor.into()),
            _ => None,
        },
    ),
    Row::<Content>::new(
        key(
            "only",
            Kind::Names,
            "all objects",
            "",
            "Of the files, an earlier state of the city, only objects of which this became: `removed`, `kept`, `other shape`, `other attributes`, `other shape and attributes`. They have it as their attribute `change`; terrain, roads, water and land use stay as they are below. See Change.",
            "[\"removed\", \"other shape\"]",
        ),
        |content, _| {
            let only = content.only.as_ref()?;
            Some(Data::list(only.became.iter().map(|became| became.word())))
        },
        |content, given| {
            let of = |word: &String| Became::OF_EARLIER.into_iter().find(|became| became.word() == word);
            let words = given.node.names();
            if let Some(wrong) = words.iter().find(|word| of(word).is_none()) {
                let known = Became::OF_EARLIER.map(|became| format!("\"{}\"", became.word())).join(", ");
                let message = format!("\"{wrong}\" became of no object of an earlier state; expected some of {known}");
                given.reader.checker.note(&given.fields.place, given.key, given.node.line, message);
            }
            let became = words.iter().filter_map(of).collect();
            content.only = Some(Only { became, key: given.fields.text("key").map(str::to_owned) });
        },
    ),
    Row::<Content>::joint(
        key(
            "key",
            Kind::Text,
            "the id",
            "",
            "With `only`: the attribute by which objects of both states are the same.",
            "\"identificatie\"",
        ),
        |content, _| content.only.as_ref()?.key.as_deref().map(Into::into),
    ),
    field!(
        key(
            "class",
            Kind::Word { now: CLASSES, later: &[] },
            "\"inside\"",
            "",
            "Which part of the sight line it shows in, as that of an effect.",
            "\"behind\"",
        ),
        Word,
        |content: Content| content.class
    ),
    field!(
        key(
            "keep_terrain",
            Kind::Boolean,
            "false",
            "",
            "Terrain, roads, water, land use and the plain ground stay as they are below, and the content brings none.",
            "true",
        ),
        Same,
        |content: Content| content.keep_terrain
    ),
    Row::<Content>::new(
        key(
            "from",
            Kind::Point,
            "`to`: it is turned and scaled in its place",
            "m",
            "The point of the data set that is put to `to`.",
            "[120.0, 40.0, 0.0]",
        ),
        |content, _| content.copied.as_ref().and_then(|copied| Same::data(&copied.from)),
        |content, given| Same::take(given.node, &mut copied(content).from),
    ),
    Row::<Content>::new(
        key(
            "to",
            Kind::Point,
            "the middle of the box (edges along x, y, z) around the lens, if something else moves it",
            "m",
            "Where `from` is put, counted as the shapes' coordinates are.",
            "[0.0, 0.0, 0.0]",
        ),
        |content, _| content.copied.as_ref().and_then(|copied| Same::data(&copied.to)),
        |content, given| Same::take(given.node, &mut copied(content).to),
    ),
    Row::<Content>::new(
        key(
            "rotation_deg",
            Kind::Angles,
            "[0, 0, 0]",
            "degrees",
            "Turns it about that point: yaw counter-clockwise from above, pitch lifts its east, roll about its east.",
            "[90.0, 0.0, 0.0]",
        ),
        |content, _| content.copied.filter(is_turned).and_then(|copied| Turn::data(&copied.rotation)),
        |content, given| Turn::take(given.node, &mut copied(content).rotation),
    ),
    Row::<Content>::new(
        key("scale", Kind::Number { min: 1e-3, max: 1e3 }, "1.0", "", "Scales it about that point.", "2.0"),
        |content, _| content.copied.filter(says_scale).map(|copied| copied.scale.into()),
        |content, given| Same::take(given.node, &mut copied(content).scale),
    ),
    Row::<Content>::new(
        key(
            "transform",
            Kind::Handler,
            "none",
            "",
            "A transform of your own, about the point that it is put to; see Effects of your own (effects.md).",
            "{ kind = \"upright\" }",
        ),
        |content, _| content.transform.as_ref().map(handled::written),
        |content, given| {
            let place = given.fields.place.within(given.key, given.node.line);
            content.transform = handled::required(given.reader, given.node, &place, AskedBy::Contents);
        },
    ),
];

/// How it is moved, which something says.
fn copied(content: &mut Content) -> &mut Copied {
    content.copied.get_or_insert(Copied { from: None, to: None, rotation: DQuat::IDENTITY, scale: 1.0 })
}

/// Whether it is turned by as much as is written.
fn is_turned(copied: &Copied) -> bool {
    Turn::data(&copied.rotation) != Turn::data(&DQuat::IDENTITY)
}

/// Whether the scale is written: something says that a content is moved.
fn says_scale(copied: &Copied) -> bool {
    copied.scale != 1.0 || (!is_turned(copied) && copied.from.is_none() && copied.to.is_none())
}

/// The table of a content.
pub fn written(content: &Content, options: &Options) -> Data {
    row::written(CONTENT_ROWS, content, &Content::default(), options)
}

/// The content of a lens; `of_effects`: that of its effect `lod`.
pub fn read(reader: &mut Reader, fields: &Fields, of_effects: Option<Shown>) -> Option<Content> {
    let clip = fields.text("clip").and_then(Clip::of_word);
    if let (true, Some(shown)) = (fields.given("content"), &of_effects) {
        let message = "is given together with the effect \"lod\", which is a content too: a lens has one";
        reader.checker.note(&fields.place, "content", shown.line, message);
    }
    let content = match fields.node("content") {
        None => of_effects.map(|shown| shown.content),
        Some(node) => {
            let own = reader.checker.fields(node, &CONTENT, &[], fields.place.within("content", node.line));
            let mut content = Content::default();
            if own.node("files").and_then(Node::list).is_some_and(<[Node]>::is_empty) {
                let message = "is empty: name the files, or leave the key away for the scene's own city";
                reader.checker.note(&own.place, "files", own.line("files"), message);
            }
            content.derive = derived(&own, reader);
            if ["from", "to", "rotation_deg", "scale"].into_iter().any(|key| own.given(key)) {
                copied(&mut content);
            }
            row::read(CONTENT_ROWS, &own, reader, &mut content);
            if content.only.is_some() && !own.given("files") {
                let message = "has a meaning only with files, those of an earlier state of the city";
                reader.checker.note(&own.place, "only", own.line("only"), message);
            }
            if own.given("key") && !own.given("only") {
                let message = "has a meaning only with only; for example only = \"removed\"";
                reader.checker.note(&own.place, "key", own.line("key"), message);
            }
            Some(content)
        }
    };
    if content.is_none() && fields.given("clip") {
        let message = "has a meaning only for a lens with content";
        reader.checker.note(&fields.place, "clip", fields.line("clip"), message);
    }
    if content.is_none() && !fields.given("content") && fields.text("kind") == Some("content") {
        let message = "is missing: a content lens shows something. For example content = { lod = \"1.2\" }";
        reader.checker.note(&fields.place, "content", fields.place.line, message);
    }
    content.map(|content| Content { clip: clip.unwrap_or(content.usual_clip()), ..content })
}

/// What a content derives, of its keys; what is wrong is noted.
fn derived(own: &Fields, reader: &mut Reader) -> Option<Derive> {
    let word = own.text("derive");
    let row = word.and_then(|word| FORMS.iter().find(|row| row.word == word));
    if !own.given("derive") && own.given("parts") {
        let message = "has a meaning only with derive; for example derive = \"box\"";
        reader.checker.note(&own.place, "parts", own.line("parts"), message);
    }
    let mut options: Vec<&str> = FORMS.iter().flat_map(|of| of.options).copied().collect();
    options.dedup();
    for option in options {
        let of: Vec<String> =
            FORMS.iter().filter(|of| of.options.contains(&option)).map(|of| format!("\"{}\"", of.word)).collect();
        let has = row.is_some_and(|row| row.options.contains(&option));
        // A word that is none has its own message.
        if own.given(option) && !has && (row.is_some() || word.is_none()) {
            let message = format!("has a meaning only with derive = {}", of.join(" or "));
            reader.checker.note(&own.place, option, own.line(option), message);
        }
    }
    let height = match (own.number("height"), own.number("factor")) {
        (Some(metres), _) => Height::Metres(metres),
        (None, factor) => Height::Factor(factor.unwrap_or(1.0)),
    };
    let form = match row?.word {
        "box" => Form::Box { oriented: own.boolean("oriented").unwrap_or(false) },
        "prism" => Form::Prism,
        "hull" => Form::Hull,
        "lod1" => Form::Lod1,
        "flat" => Form::Flat { lift_m: own.number("lift").unwrap_or(LIFT_M) },
        "top" => Form::Top { lift_m: own.number("lift").unwrap_or(LIFT_M) },
        _ => {
            let message = match (own.given("height"), own.given("factor")) {
                (true, true) => Some("height and factor are both given; either says how high"),
                (false, false) => Some("\"height\" needs a height in metres or a factor; for example height = 12.0"),
                _ => None,
            };
            message
                .into_iter()
                .for_each(|message| reader.checker.note(&own.place, "derive", own.line("derive"), message));
            Form::Height(height)
        }
    };
    Some(Derive { form, parts: own.boolean("parts").unwrap_or(false) })
}

#[cfg(test)]
mod tests {
    use crate::figure::scene_file::{Options, parse, to_toml};

    #[test]
    fn a_turn_by_next_to_nothing_is_none() {
        for keys in [
            "rotation_deg = [0, 1e-200, 0]",
            "rotation_deg = [0, 0, 1e-30], from = [0, 0, 0]",
            "scale = 2, rotation_deg = [1e-300, 0, 0]",
        ] {
            let text = format!(
                "veduta = 1\n[[lens]]\nkind = \"content\"\nshape = {{ kind = \"sphere\", center = [0, 0, 0], radius = 5 }}\ncontent = {{ {keys} }}\n"
            );
            let read = |text: &str| parse(text, "s", &Options::for_command_line()).unwrap();
            let scene = read(&text);
            let once = to_toml(&scene);
            assert!(!once.contains("rotation_deg"), "{once}");
            assert_eq!(to_toml(&read(&once)), once, "{keys}");
            assert!(read(&once).lenses[0].content().is_some_and(|content| content.copied.is_some()), "{keys}");
        }
    }
}
