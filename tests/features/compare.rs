//! `veduta info --compare`: two states of a city as people and scripts compare them.

use std::process::{Output, Stdio};

use crate::studio::Folder;
use serde_json::{Value, json};

/// A house with a part, a house, a tree; the bracketed words are replaced.
const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[100.0,200.0,0.0]},
"metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/[crs]"},
"CityObjects":{
"a":{"type":"Building","attributes":{"pand":"1","height":[height],"name":"old"},"children":["a1"]},
"a1":{"type":"BuildingPart","parents":["a"],"geometry":[{"type":"MultiSurface","lod":"2.0","boundaries":[[[0,1,2,3]],[[0,1,4]]]}]},
"[b]":{"type":"Building","attributes":{"pand":"2"},"geometry":[{"type":"Solid","lod":"1","boundaries":[[
[[5,8,7,6]],[[9,10,11,12]],[[5,6,10,9]],[[6,7,11,10]],[[7,8,12,11]],[[8,5,9,12]]]]}]},
"[tree]":{"type":"SolitaryVegetationObject","attributes":{"pand":"t"}}},
"vertices":[[0,0,0],[10000,0,0],[10000,20000,0],[0,20000,[z]],[10000,0,3000],
[20000,0,0],[30000,0,0],[30000,10000,0],[20000,10000,0],[20000,0,10000],[30000,0,10000],[30000,10000,10000],[20000,10000,10000]]}"#;

fn city(words: &[(&str, &str)]) -> String {
    let plain = [("[crs]", "7415"), ("[height]", "3"), ("[b]", "b"), ("[tree]", "t"), ("[z]", "0")];
    words.iter().chain(&plain).fold(CITY.to_owned(), |text, (from, to)| text.replace(from, to))
}

fn run(arguments: &[&str]) -> Output {
    let mut command = crate::program();
    command.args(arguments).env_remove("NO_COLOR").env_remove("VEDUTA_DATA").stdin(Stdio::null()).output().unwrap()
}

fn compared(arguments: &[&str]) -> Value {
    let output = run(&[&["info", "--compare", "--json"], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let mut answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    answer["compare"].take()
}

#[test]
fn two_states_are_compared() {
    let folder = Folder::new("compare");
    let file = |name: &str, words: &[(&str, &str)]| folder.write(name, city(words)).to_str().unwrap().to_owned();
    let old = file("old.city.json", &[]);
    let new = file("new.city.json", &[("[height]", "4.5"), ("[b]", "c"), ("[tree]", "u"), ("[z]", "1")]);
    let found = compared(&["--list", &old, &new]);
    let counts =
        |added: u64, removed: u64, changed: u64| json!({"added": added, "removed": removed, "changed": changed});
    let is =
        |found: &Value, expected: &Value| expected.as_object().unwrap().iter().all(|(key, value)| found[key] == *value);
    assert!(is(&found["objects"], &counts(2, 2, 2)), "{found:#}");
    assert!(is(&found["roots"], &counts(2, 2, 1)), "{found:#}");
    assert_eq!(found["roots"]["changed_geometry"], 1, "by its part");
    assert!(is(&found["by_type"]["BuildingPart"], &counts(0, 0, 1)), "{found:#}");
    assert_eq!(found["attributes"], json!({"height": counts(0, 0, 1)}));
    assert_eq!(found["matched"], json!({"id": 2, "key": 0, "version": 0, "part": 0}));
    assert_eq!((&found["before"]["crs"], &found["before"]["objects"]), (&json!("EPSG:7415"), &json!(4)));
    assert_eq!((&found["volume_m3"]["removed"], &found["volume_m3"]["added"]), (&json!(1000.0), &json!(1000.0)));
    assert!((found["tolerance_m"][0].as_f64().unwrap() - 0.0005).abs() < 2e-5);
    let listed =
        |index: usize, keys: &[&str]| keys.iter().map(|key| found["list"][index][key].clone()).collect::<Vec<_>>();
    assert_eq!(listed(0, &["id", "state"]), ["b", "removed"]);
    let whole = listed(2, &["id", "state", "geometry", "attributes", "parts"]);
    assert_eq!(whole, [json!("a"), json!("changed"), json!(false), json!({"height": [3, 4.5]}), json!(true)]);
    assert_eq!(listed(3, &["id", "geometry", "parts"]), [json!("a1"), json!(true), json!(false)]);
    assert_eq!(found["list"].as_array().unwrap().len(), 6);
    // By an attribute the renamed ones are found again.
    let found = compared(&["--key", "pand", &old, &new]);
    assert_eq!(found["matched"], json!({"id": 1, "key": 3, "version": 0, "part": 0}));
    assert!(is(&found["objects"], &counts(0, 0, 2)) && found["key"] == "pand" && found.get("list").is_none());
    let same = compared(&[&old, &old]);
    assert!(is(&same["objects"], &counts(0, 0, 0)) && same["objects"]["unchanged"] == 4, "{same:#}");
    let text = run(&["info", "--compare", "--list", &old, &new]);
    let text = String::from_utf8(text.stdout).unwrap();
    for part in ["2 by id", "corners up to 0.52 mm apart", "added", "BuildingPart", "height 3 → 4.5; parts", "1,000 m³"]
    {
        assert!(text.contains(part), "{part} is missing in:\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn what_cannot_be_compared_is_told() {
    let folder = Folder::new("compare-wrong");
    let file = |name: &str, words: &[(&str, &str)]| folder.write(name, city(words)).to_str().unwrap().to_owned();
    let old = file("old.city.json", &[]);
    let elsewhere = file("elsewhere.city.json", &[("[crs]", "28992")]);
    let missing = folder.0.join("missing.json").to_str().unwrap().to_owned();
    for (arguments, code, parts) in [
        (
            &["--compare", &old, &elsewhere][..],
            1,
            &["elsewhere.city.json: its reference system is EPSG:28992", "old.city.json is EPSG:7415"][..],
        ),
        (
            &["--compare", "--key", "pant", &old, &old],
            1,
            &["old.city.json: --key: no object has an attribute \"pant\"", "did you mean \"pand\"?"],
        ),
        (&["--compare", &old, &missing], 1, &["missing.json: cannot be read"]),
        (&["--compare", &old], 2, &["two states would be right", "1 given"]),
        (&["--compare", &old, &old, &old], 2, &["3 given"]),
        (&["--compare", "-", "-"], 2, &["stdin"]),
        (&["--key", "pand", &old, &old], 2, &["--compare"]),
        (&["--compare", "--landmarks", "3", &old, &old], 2, &["--landmarks"]),
    ] {
        let output = run(&[&["info"], arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty() && (code == 2 || message.lines().count() == 1), "{arguments:?}: {message}");
    }
}
