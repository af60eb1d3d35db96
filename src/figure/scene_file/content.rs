//! `content` of a lens in scene files: its keys, and what it derives, read and written.

use crate::{
    city::derived::{Derive, FORMS, Form, HEIGHT_RANGE_M, Height, LIFT_M, LIFT_RANGE_M, WORDS},
    figure::scene_file::{
        check::{Checker, Fields},
        keys::{CLASSES, Kind, Table, key},
        write::{number, quoted},
    },
};

/// `content` of a lens.
pub const CONTENT: Table = Table {
    name: "content",
    doc: "What a lens shows in itself: the scene's city or another data set, in a level of detail, derived of it, moved or not. See Contents.",
    keys: &[
        key(
            "files",
            Kind::Texts,
            "the scene's city",
            "",
            "City files or folders of another data set, by the same rules as those of `[city]`.",
            "[\"plan.city.json\"]",
        ),
        key(
            "lod",
            Kind::Lod,
            "as the scene shows its city; of other files the finest",
            "",
            "Shows no level of detail finer than this, one that the data set has.",
            "\"1.2\"",
        ),
        key(
            "derive",
            Kind::Word { now: WORDS, later: &[] },
            "as they are",
            "",
            "What objects are shown as: their bounding `box`, the `prism` over their footprint, their convex `hull`, their block model of level of detail 1 (`lod1`; where there is none the prism), themselves pressed `flat` to the ground, the same lit as they stood (`top`), themselves at another `height`. Terrain, roads, water and land use stay as they are below. See Contents.",
            "\"box\"",
        ),
        key(
            "parts",
            Kind::Boolean,
            "false: a building with all its parts is one",
            "",
            "For `derive`: whether each part that has faces of its own is derived by itself.",
            "true",
        ),
        key(
            "oriented",
            Kind::Boolean,
            "false: along the axes",
            "",
            "For `derive = \"box\"`: whether boxes stand on the smallest rectangle around the footprint.",
            "true",
        ),
        key(
            "lift",
            Kind::Number { min: LIFT_RANGE_M[0], max: LIFT_RANGE_M[1] },
            "0.05",
            "m",
            "For `derive = \"flat\"` and `\"top\"`: how far above the lowest point of an object it lies.",
            "0.2",
        ),
        key(
            "height",
            Kind::Number { min: HEIGHT_RANGE_M[0], max: HEIGHT_RANGE_M[1] },
            "what `factor` says",
            "m",
            "For `derive = \"height\"`: from the lowest point of an object to its highest. Either this or `factor`.",
            "12.0",
        ),
        key(
            "factor",
            Kind::Number { min: 0.001, max: 1000.0 },
            "what `height` says",
            "",
            "For `derive = \"height\"`: how many times as high as it is.",
            "0.5",
        ),
        key(
            "class",
            Kind::Word { now: CLASSES, later: &[] },
            "\"inside\"",
            "",
            "Which part of the sight line it shows in, as that of an effect.",
            "\"behind\"",
        ),
        key(
            "keep_terrain",
            Kind::Boolean,
            "false",
            "",
            "Terrain, roads, water, land use and the plain ground stay as they are below, and the content brings none.",
            "true",
        ),
        key(
            "from",
            Kind::Point,
            "`to`: it is turned and scaled in its place",
            "m",
            "The point of the data set that is put to `to`.",
            "[120.0, 40.0, 0.0]",
        ),
        key(
            "to",
            Kind::Point,
            "the middle of the box (edges along x, y, z) around the lens, if something else moves it",
            "m",
            "Where `from` is put, counted as the shapes' coordinates are.",
            "[0.0, 0.0, 0.0]",
        ),
        key(
            "rotation_deg",
            Kind::Angles,
            "[0, 0, 0]",
            "degrees",
            "Turns it about that point: yaw counter-clockwise from above, pitch lifts its east, roll about its east.",
            "[90.0, 0.0, 0.0]",
        ),
        key("scale", Kind::Number { min: 1e-3, max: 1e3 }, "1.0", "", "Scales it about that point.", "2.0"),
    ],
};

/// What a content derives, of its keys; what is wrong is noted.
pub(super) fn derived(own: &Fields, checker: &mut Checker) -> Option<Derive> {
    let word = own.text("derive");
    let row = word.and_then(|word| FORMS.iter().find(|row| row.word == word));
    if !own.given("derive") && own.given("parts") {
        let message = "has a meaning only with derive; for example derive = \"box\"";
        checker.note(&own.place, "parts", own.line("parts"), message);
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
            checker.note(&own.place, option, own.line(option), message);
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
            message.into_iter().for_each(|message| checker.note(&own.place, "derive", own.line("derive"), message));
            Form::Height(height)
        }
    };
    Some(Derive { form, parts: own.boolean("parts").unwrap_or(false) })
}

/// The keys of what a content derives.
pub(super) fn derive_keys(how: &Derive) -> Vec<String> {
    let mut keys = vec![format!("derive = {}", quoted(how.form.row().word))];
    match how.form {
        Form::Box { oriented: true } => keys.push("oriented = true".to_owned()),
        Form::Flat { lift_m } | Form::Top { lift_m } if lift_m != LIFT_M => {
            keys.push(format!("lift = {}", number(lift_m)))
        }
        Form::Height(Height::Metres(metres)) => keys.push(format!("height = {}", number(metres))),
        Form::Height(Height::Factor(factor)) => keys.push(format!("factor = {}", number(factor))),
        Form::Box { .. } | Form::Prism | Form::Hull | Form::Lod1 | Form::Flat { .. } | Form::Top { .. } => {}
    }
    if how.parts {
        keys.push("parts = true".to_owned());
    }
    keys
}
