//! Two states of real cities: each file against itself, and Delft against a state of it that is made by editing its JSON.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use serde_json::{Value, json};
use veduta::city::{
    CityModel,
    compare::{Comparison, Counts, Key, State},
    load::{LoadOptions, Quiet, load},
};

use crate::studio::Folder;

const FILES: &[&str] = &[
    "3dbag-delft/3dbag_multi_lod.v2.0.city.json",
    "delft-bgt/delft_bgt.v2.0.city.json",
    "denhaag-01/DenHaag_01.v1.0.city.json",
    "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json",
    "vienna-102081/vienna_102081.v1.1.city.jsonl",
];

pub fn trials() -> Vec<Trial> {
    let same = FILES.iter().map(|file| {
        crate::trial(&format!("compare::itself::{file}"), move |root| {
            let [old, new] = [city(&root.join(file))?, city(&root.join(file))?];
            let found = Comparison::new(&old, &new, &Key::Id)?;
            assert_eq!(found.objects, Counts { unchanged: old.objects.len() as u64, ..Counts::default() });
            Ok(())
        })
    });
    let edited = crate::trial("compare::delft_edited", |root| {
        edited(&root.join("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl"))
    });
    same.chain([edited]).collect()
}

fn city(file: &Path) -> Result<CityModel, Failed> {
    Ok(load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?)
}

/// A building that is gone, one with another attribute, one with a corner a step away, and all features in another order and with their
/// corners in another order.
fn edited(file: &Path) -> Result<(), Failed> {
    let text = std::fs::read_to_string(file)?;
    let mut lines: Vec<Value> = text.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    let folder = Folder::new("compare-delft");
    // Both are written here: JSON of the test reads some numbers to a last digit more or less.
    let write = |name: &str, lines: &[Value]| {
        let lines: Vec<String> = lines.iter().map(Value::to_string).collect();
        folder.write(name, lines.join("\n"))
    };
    let old = city(&write("old.city.jsonl", &lines))?;
    let root = |line: &Value| line["id"].as_str().unwrap_or_default().to_owned();
    let gone = lines.remove(10);
    let (renovated, moved) = (root(&lines[20]), root(&lines[30]));
    let year = &lines[20]["CityObjects"][&renovated]["attributes"]["oorspronkelijkbouwjaar"];
    let year = year.as_i64().ok_or("a building without a year")? + 100;
    lines[20]["CityObjects"][&renovated]["attributes"]["oorspronkelijkbouwjaar"] = json!(year);
    let height = lines[30]["vertices"][0][2].as_i64().ok_or("no corner")?;
    lines[30]["vertices"][0][2] = json!(height + 1);
    lines[1..].reverse();
    lines[1..].iter_mut().for_each(turn_corners);
    let new = city(&write("new.city.jsonl", &lines))?;
    let found = Comparison::new(&old, &new, &Key::Id)?;
    let lost = gone["CityObjects"].as_object().ok_or("no objects")?.len() as u64;
    assert_eq!((found.objects.added, found.objects.removed), (0, lost));
    assert_eq!((found.roots.removed, found.roots.changed), (1, 2));
    assert_eq!((found.roots.changed_geometry, found.roots.changed_attributes), (1, 1));
    assert_eq!((found.attributes.len(), &*found.attributes[0].0), (1, "oorspronkelijkbouwjaar"));
    let state = |id: &str| new.find_object(id).map(|object| found.after[object as usize].state);
    assert_eq!(state(&renovated), Some(State::Changed { geometry: false, attributes: true }));
    assert_eq!(state(&moved), Some(State::Changed { geometry: true, attributes: false }));
    // The register's number names the same buildings as the ids.
    let by_key = Comparison::new(&old, &new, &Key::Attribute("identificatie".into()))?;
    assert_eq!((by_key.objects, by_key.roots), (found.objects, found.roots));
    Ok(())
}

/// Has the corners of a feature in the opposite order.
fn turn_corners(feature: &mut Value) {
    let Some(corners) = feature["vertices"].as_array_mut() else { return };
    corners.reverse();
    let last = corners.len() as u64 - 1;
    for object in feature["CityObjects"].as_object_mut().into_iter().flat_map(|objects| objects.values_mut()) {
        for geometry in object["geometry"].as_array_mut().into_iter().flatten() {
            turn(&mut geometry["boundaries"], last);
        }
    }
}

fn turn(boundaries: &mut Value, last: u64) {
    match boundaries {
        Value::Array(list) => list.iter_mut().for_each(|one| turn(one, last)),
        number => *number = json!(last - number.as_u64().unwrap_or(last)),
    }
}
