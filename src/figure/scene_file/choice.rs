//! City objects chosen by their ids, types, an expression or an attribute, in scene files.

use crate::{
    figure::scene_file::{
        check::Fields,
        forms::Same,
        keys::{Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    lens::chosen::Choice,
    query,
};

const IDS: Key = key(
    "ids",
    Kind::Texts,
    "none: `types`, `where` or `attribute`",
    "",
    "Ids of city objects; their parts belong to them.",
    "[\"town-hall\"]",
);
const TYPES: Key = key(
    "types",
    Kind::Texts,
    "none: `ids`, `where` or `attribute`",
    "",
    "Types of city objects, as their files call them; their parts belong to them.",
    "[\"Bridge\"]",
);
const WHERE: Key = key(
    "where",
    Kind::Text,
    "none: `ids`, `types` or `attribute`",
    "",
    "Objects of which this is true; their parts belong to them. See Expressions.",
    "\"height > 25 and yearOfConstruction < 1900\"",
);
const ATTRIBUTE: Key = key(
    "attribute",
    Kind::Text,
    "none: `ids`, `types` or `where`",
    "",
    "Objects that have this attribute; one without it takes its parent's.",
    "\"yearOfConstruction\"",
);
const VALUES: Key = key("values", Kind::Texts, "any", "", "Only where the attribute is one of these.", "[\"school\"]");
const MIN: Key = key(
    "min",
    Kind::Number { min: f64::MIN, max: f64::MAX },
    "none",
    "the attribute's",
    "Only where the attribute is at least this.",
    "1900.0",
);
const MAX: Key = key(
    "max",
    Kind::Number { min: f64::MIN, max: f64::MAX },
    "none",
    "the attribute's",
    "Only where the attribute is at most this.",
    "1945.0",
);
const EXCEPT: Key = key("except", Kind::Boolean, "false", "", "All other objects instead.", "true");

/// `force` and `forbid` of a lens.
pub const CHOICE: Table = Table {
    name: "choice",
    doc: "City objects chosen by their ids, their types, an expression or an attribute: one of `ids`, `types`, `where` and `attribute`. Of an object that has parts one chosen part is enough.",
    keys: keys_of!(CHOICE_ROWS),
};

/// Its rows.
pub const CHOICE_ROWS: &[Row<Choice>] = &[
    field!(IDS, Same, |choice: Choice| choice.ids),
    field!(TYPES, Same, |choice: Choice| choice.types),
    field!(ATTRIBUTE, Same, |choice: Choice| choice.attribute),
    field!(VALUES, Same, |choice: Choice| choice.values),
    field!(MIN, Same, |choice: Choice| choice.min),
    field!(MAX, Same, |choice: Choice| choice.max),
    field!(EXCEPT, Same, |choice: Choice| choice.except),
    field!(WHERE, Same, |choice: Choice| choice.expression),
];

/// A choice; what is wrong is noted.
pub fn read(reader: &mut Reader, fields: &Fields) -> Choice {
    let given: Vec<&str> = ["ids", "types", "where", "attribute"].into_iter().filter(|key| fields.given(key)).collect();
    match given[..] {
        [] => {
            let message = "is missing: give ids = [\"ID\", ...], types = [\"TYPE\", ...], where = \"EXPRESSION\" or attribute = \"NAME\"";
            reader.checker.note(&fields.place, "ids", fields.place.line, message);
        }
        ["attribute"] => {}
        [_] => refuse(reader, fields, &["values", "min", "max"], "has a meaning only with attribute"),
        [first, ..] => {
            let message = format!("is given together with {first}: objects are chosen by one of them");
            for other in &given[1..] {
                reader.checker.note(&fields.place, other, fields.line(other), message.clone());
            }
        }
    }
    for (key, what) in [("ids", "object"), ("types", "type"), ("values", "value")] {
        if fields.node(key).and_then(Node::list).is_some_and(<[Node]>::is_empty) {
            reader.checker.note(&fields.place, key, fields.line(key), format!("must name at least one {what}"));
        }
    }
    if let Some(Err(error)) = fields.text("where").map(query::parse) {
        reader.checker.note(&fields.place, "where", fields.line("where"), error.to_string());
    }
    if let (Some(min), Some(max)) = (fields.number("min"), fields.number("max"))
        && min > max
    {
        let message = format!("must be at least min, {min}, is {max}");
        reader.checker.note(&fields.place, "max", fields.line("max"), message);
    }
    let mut choice = Choice::default();
    row::read(CHOICE_ROWS, fields, reader, &mut choice);
    choice
}

/// Notes keys that have no meaning beside what else is given.
pub fn refuse(reader: &mut Reader, fields: &Fields, keys: &[&'static str], message: &str) {
    for key in keys.iter().filter(|key| fields.given(key)) {
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
}

/// The table of a choice.
pub fn written(choice: &Choice, options: &Options) -> Data {
    row::written(CHOICE_ROWS, choice, &Choice::default(), options)
}
