use std::path::PathBuf;

use super::*;
use crate::city::{CityObject, ObjectClass};

fn city() -> CityModel {
    let mut model = CityModel::default();
    let (name, number) = (model.strings.intern("name"), model.strings.intern("number"));
    for (i, id) in ["a", "b", "c"].into_iter().enumerate() {
        let first = model.attributes.len() as u32;
        let own = model.strings.intern(&format!("house {id}"));
        model.attributes.push(Attribute { name, value: Value::String(own) });
        model.attributes.push(Attribute { name: number, value: Value::Integer(i as i64 / 2) });
        model.objects.push(CityObject {
            id: id.into(),
            kind: model.strings.intern("Building"),
            class: ObjectClass::Building,
            parents: vec![],
            children: vec![],
            attributes: first..first + 2,
            geometries: 0..0,
        });
    }
    model
}

/// The attributes of an object, written out.
fn attributes(model: &CityModel, object: u32) -> Vec<String> {
    let of = |attribute: &Attribute| {
        let value = match attribute.value {
            Value::String(text) => format!("{:?}", model.strings.get(text)),
            Value::Array(text) | Value::Object(text) => model.strings.get(text).to_owned(),
            Value::Integer(number) => number.to_string(),
            Value::Number(number) => format!("{number:?}"),
            Value::Boolean(is) => is.to_string(),
            Value::Null => "null".to_owned(),
        };
        format!("{}={value}", model.strings.get(attribute.name))
    };
    model.attributes_of(object).iter().map(of).collect()
}

/// A city with a table joined to it.
fn joined(text: &[u8], key: &str, attribute: Option<&str>) -> Result<CityModel, String> {
    static MADE: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let number = MADE.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let file = std::env::temp_dir().join(format!("veduta-join-{}-{number}", std::process::id()));
    std::fs::write(&file, text).expect("a temporary file");
    let mut model = city();
    let join =
        Join { file: file.clone(), key: key.to_owned(), attribute: attribute.map(str::to_owned), ..Join::default() };
    let result = model.join(&join);
    std::fs::remove_file(&file).expect("the temporary file");
    result.map_err(|error| error.to_string().replace(&file.display().to_string(), "T"))?;
    model.validate().expect("a sound model");
    model.joins[0].file = PathBuf::from("T");
    Ok(model)
}

#[test]
fn rows_become_attributes_of_their_objects() {
    let text = b"\xef\xbb\xbfid;built;name;code;open;share\r\nb;1890;\"new; \"\"B\"\"\";007;true;0.5\r\nx;1;;;;\r\nb;1;;;;\r\na;;;;;-2\r\n;9;;;;\r\n";
    let model = joined(text, "", None).expect("a table");
    assert_eq!(attributes(&model, 0), ["name=\"house a\"", "number=0", "share=-2"]);
    let b = ["number=0", "built=1890", "name=\"new; \\\"B\\\"\"", "code=\"007\"", "open=true", "share=0.5"];
    assert_eq!(attributes(&model, 1), b);
    assert_eq!(attributes(&model, 2), ["name=\"house c\"", "number=1"]);
    let facts = &model.joins[0];
    assert_eq!((facts.rows, facts.joined, facts.objects, facts.without_object, facts.repeated), (4, 2, 2, 1, 1));
    assert_eq!((facts.key.as_str(), &facts.first_without_object[..]), ("id", &["x".to_owned()][..]));
    assert_eq!(facts.attributes, ["built", "name", "code", "open", "share"]);
}

#[test]
fn features_of_geojson_are_rows() {
    let text = br#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"ID": 1, "built": "1890-05", "tags": ["x"], "of": {"y": 1}, "none": null}, "geometry": null},
        {"type": "Feature", "properties": null}, {"type": "Feature", "properties": {"ID": "0", "h": 2.5}}]}"#;
    let model = joined(text, "ID", Some("number")).expect("a table");
    assert_eq!(attributes(&model, 0), ["name=\"house a\"", "number=0", "h=2.5"]);
    assert_eq!(attributes(&model, 1), ["name=\"house b\"", "number=0", "h=2.5"], "all that have the number");
    let c = ["name=\"house c\"", "number=1", "built=\"1890-05\"", "tags=[\"x\"]", "of={\"y\":1}"];
    assert_eq!(attributes(&model, 2), c);
    let ids = br#"{"features": [{"id": "c", "properties": {"built": 1700}}]}"#;
    assert_eq!(attributes(&joined(ids, "", None).expect("a table"), 2).last().map(String::as_str), Some("built=1700"));
}

#[test]
fn what_is_no_table_is_told() {
    for (text, key, attribute, expected) in [
        (&b""[..], "", None, "T: is empty; a table, CSV or GeoJSON, would be right"),
        (b"id,built\na,1\n", "key", None, "T: has no column \"key\"; it has id, built"),
        (b"id,built\na\n", "", None, "T, line 2: has 1 cells; 2, as the head has, would be right"),
        (b"id,built\na,\xff\n", "", None, "T, line 2: is no UTF-8; a table saved as UTF-8 would be right"),
        (b"{\"features\": 3}", "", None, "a FeatureCollection of GeoJSON would be right"),
        (b"{\"features\": [{\"properties\": {\"a\": 1}}]}", "", None, "T: has no column \"id\"; it has a"),
        (b"id\na\n", "", Some("street"), "T: is joined by the attribute \"street\", which no object has as a text"),
    ] {
        let message = joined(text, key, attribute).expect_err(expected);
        assert!(message.contains(expected), "{message}");
    }
    let missing = Join { file: "no/such.csv".into(), ..Join::default() };
    assert!(city().join(&missing).expect_err("none").to_string().starts_with("no/such.csv: cannot be read"));
}

#[test]
fn rows_with_dates_are_values_over_time() {
    let file = std::env::temp_dir().join(format!("veduta-over-time-{}.csv", std::process::id()));
    let read = |text: &str, until: &str| {
        std::fs::write(&file, text).expect("a temporary file");
        let valid = [Some("since".to_owned()), Some(until.to_owned())];
        let join = Join { file: file.clone(), valid, ..Join::default() };
        let mut model = city();
        let joined = model.join(&join).map_err(|error| error.to_string());
        joined.map(|()| model)
    };
    let text = "id,use,since,until\na,shop,1900,1950\na,home,,1900\nb,mill,1700,\nd,mill,1700,\n";
    let model = read(text, "until").expect("a table");
    let name = model.strings.find("use").expect("the attribute");
    let year = |year: i64| crate::time::Moment::of_year(year);
    let value = |text: &str| model.strings.find(text).map(Value::String);
    let expected = [(None, value("home")), (year(1900), value("shop")), (year(1950), None)];
    assert_eq!(model.history_of(0, name), Some(&expected[..]));
    assert_eq!(model.history_of(1, name), Some(&[(year(1700), value("mill"))][..]));
    assert_eq!(model.history_of(2, name), None);
    assert!(attributes(&model, 0).contains(&"use=\"shop\"".to_owned()), "what began last");
    let facts = &model.joins[0];
    assert_eq!((facts.rows, facts.joined, facts.objects, facts.repeated), (4, 3, 2, 0));
    assert_eq!(facts.attributes, ["use"], "dates are none");
    let wrong = |text: &str, until: &str| read(text, until).err().unwrap_or_default();
    assert!(wrong(text, "end").contains("has no column \"end\"; it has use, since, until"));
    let message = wrong("id,use,since,until\na,shop,soon,1950\n", "until");
    assert!(message.contains("row 1 of a, since") && message.contains("soon"), "{message}");
    std::fs::remove_file(&file).expect("the temporary file");
}
