//! The docs' tables and the JSON schema of sheets, both made from the table of keys.

use serde_json::Value;

use crate::figure::{
    scene_file::document::{object, section},
    sheet::keys::{ROOT, TABLES},
};

/// The reference part of `docs/sheet.md`: every key with what it takes, unit, default and an example.
pub fn reference() -> String {
    let mut out = String::new();
    TABLES.iter().for_each(|(head, table)| section(&mut out, head, table));
    format!("{}\n", out.trim_end())
}

/// The JSON schema (draft 2020-12) of sheet files, as `docs/sheet.schema.json` holds it.
pub fn schema_text() -> String {
    let mut schema = object(&ROOT);
    schema.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    schema.insert("title".into(), "Veduta sheet".into());
    format!("{:#}\n", Value::Object(schema))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::scene_file::document::tests::{check_examples, committed};

    #[test]
    fn the_schema_is_committed() {
        committed("sheet.schema.json", |_| schema_text());
    }

    #[test]
    fn the_reference_is_committed() {
        const MARK: &str = "<!-- From here on made from the tables in src/figure/sheet/keys.rs. -->\n";
        committed("sheet.md", |old| {
            let prose = old.split(MARK).next().unwrap_or_default();
            format!("{prose}{MARK}\n{}", reference())
        });
    }

    #[test]
    fn every_key_is_documented_with_an_example_that_is_right() {
        let text = reference();
        TABLES.iter().for_each(|(_, table)| check_examples(table, &text));
    }
}
