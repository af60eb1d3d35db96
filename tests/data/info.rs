//! `veduta info --json --list` of every shared CityJSON file against a reader that knows nothing but JSON.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    process::Command,
};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

const FILES: &[&str] = &[
    "3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl",
    "3dbag-delft/3dbag_901.v1.1.city.jsonl",
    "3dbag-delft/3dbag_multi_lod.v2.0.city.json",
    "3dbag-delft/3dbag_small.v2.0.city.jsonl",
    "delft-bgt/delft_bgt.v2.0.city.json",
    "denhaag-01/DH_01_subs.city.json",
    "denhaag-01/DenHaag_01.v1.0.city.json",
    "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json",
    "rotterdam-delfshaven/one-textured/rotterdam_one.city.json",
    "vienna-102081/vienna_102081.v1.1.city.jsonl",
];

/// Formats that cannot be read: named in one line, exit code 1.
const REFUSED: &[(&str, &str)] = &[
    ("denhaag-01/DenHaag_1BwBP.gml", "CityGML"),
    ("denhaag-01/DenHaag_01.citygml1.gml.gz", "CityGML"),
    ("lyon1-3dtiles-time/tileset.json", "3D Tiles"),
    ("lyon1-3dtiles-time/buildings_lyon1.geojson", "GeoJSON"),
];

pub fn trials() -> Vec<Trial> {
    let read = FILES.iter().map(|file| {
        crate::trial(&format!("info::{file}"), move |root| {
            let file = root.join(file);
            compare(&json_facts(&file)?, &independent(&file))
        })
    });
    let refused = REFUSED.iter().map(|(file, name)| {
        crate::trial(&format!("info::refused::{file}"), move |root| {
            let output = info(&root.join(file));
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            same("exit code", &output.status.code(), &Some(1))?;
            same("lines", &message.lines().count(), &1)?;
            if message.contains(name) { Ok(()) } else { Err(format!("{name} is not named: {message}").into()) }
        })
    });
    read.chain(refused).collect()
}

fn info(file: &Path) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_veduta")).args(["info", "--json", "--list"]).arg(file).output().unwrap()
}

fn json_facts(file: &Path) -> Result<Value, Failed> {
    let output = info(file);
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, got: &T, expected: &T) -> Result<(), Failed> {
    if got == expected { Ok(()) } else { Err(format!("{what}: {got:?}, the file says {expected:?}").into()) }
}

/// What the file says, found without the library.
#[derive(Default)]
struct Read {
    /// Id, type, parents, levels of detail.
    objects: Vec<(String, String, Vec<String>, Vec<String>)>,
    by_type: BTreeMap<String, u64>,
    /// Objects and polygons per level.
    lods: BTreeMap<String, (BTreeSet<String>, u64)>,
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
    attributes: BTreeMap<String, Vec<Value>>,
}

fn independent(file: &Path) -> Read {
    let text = std::fs::read_to_string(file).unwrap();
    let lines: Vec<Value> = if file.extension().is_some_and(|e| e == "jsonl") {
        text.lines().filter(|line| !line.trim().is_empty()).map(|line| serde_json::from_str(line).unwrap()).collect()
    } else {
        vec![serde_json::from_str(&text).unwrap()]
    };
    let mut read = Read::default();
    for part in &lines {
        let transform = if part["transform"].is_null() { &lines[0]["transform"] } else { &part["transform"] };
        for (id, object) in part["CityObjects"].as_object().unwrap() {
            read.object(id, object, &part["vertices"], transform);
        }
    }
    read
}

impl Read {
    fn object(&mut self, id: &str, object: &Value, vertices: &Value, transform: &Value) {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        let kind = text(&object["type"]);
        *self.by_type.entry(kind.clone()).or_default() += 1;
        let mut levels = BTreeSet::new();
        for geometry in list(&object["geometry"]) {
            assert_ne!(geometry["type"], "GeometryInstance", "no shared file has templates");
            let lod = canonical(&geometry["lod"]);
            levels.insert(lod.clone());
            let level = self.lods.entry(lod).or_default();
            level.0.insert(id.to_owned());
            level.1 += polygons(&geometry["boundaries"], depth(&geometry));
            self.grow(&geometry["boundaries"], vertices, transform);
        }
        for (name, value) in object["attributes"].as_object().into_iter().flatten() {
            self.attributes.entry(name.clone()).or_default().push(value.clone());
        }
        let parents = list(&object["parents"]).iter().map(text).collect();
        self.objects.push((id.to_owned(), kind, parents, levels.into_iter().collect()));
    }

    fn grow(&mut self, boundaries: &Value, vertices: &Value, transform: &Value) {
        if let Some(parts) = boundaries.as_array() {
            return parts.iter().for_each(|part| self.grow(part, vertices, transform));
        }
        let vertex = &vertices[boundaries.as_u64().unwrap() as usize];
        for axis in 0..3 {
            let of = |key: &str, otherwise: f64| transform[key][axis].as_f64().unwrap_or(otherwise);
            let metres = vertex[axis].as_f64().unwrap() * of("scale", 1.0) + of("translate", 0.0);
            let (min, max) = (self.min.get_or_insert([f64::MAX; 3]), self.max.get_or_insert([f64::MIN; 3]));
            min[axis] = min[axis].min(metres);
            max[axis] = max[axis].max(metres);
        }
    }
}

/// How many arrays stand around a polygon.
fn depth(geometry: &Value) -> u32 {
    match geometry["type"].as_str().unwrap() {
        "MultiSurface" | "CompositeSurface" => 1,
        "Solid" => 2,
        "MultiSolid" | "CompositeSolid" => 3,
        other => panic!("{other} is in no shared file"),
    }
}

fn polygons(boundaries: &Value, depth: u32) -> u64 {
    let parts = boundaries.as_array().unwrap();
    if depth == 1 { parts.len() as u64 } else { parts.iter().map(|part| polygons(part, depth - 1)).sum() }
}

/// `2`, `2.0`, `"2.0"` are all `"2"`.
fn canonical(lod: &Value) -> String {
    lod.as_str().map_or_else(|| lod.as_f64().unwrap(), |text| text.parse().unwrap()).to_string()
}

fn compare(facts: &Value, read: &Read) -> Result<(), Failed> {
    let texts = |value: &Value| -> Vec<String> {
        value.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
    };
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    same("total", &facts["objects"]["total"], &read.objects.len().into())?;
    same("by_type", &facts["objects"]["by_type"], &serde_json::to_value(&read.by_type)?)?;
    let list = facts["objects"]["list"].as_array().unwrap();
    for (listed, object) in list.iter().zip(&read.objects) {
        let got = (text(&listed["id"]), text(&listed["type"]), texts(&listed["parents"]), texts(&listed["lods"]));
        same("list", &got, object)?;
    }
    same("list", &list.len(), &read.objects.len())?;
    for (corner, expected) in [("min", read.min.unwrap()), ("max", read.max.unwrap())] {
        for axis in 0..3 {
            let got = facts["extent"][corner][axis].as_f64().unwrap();
            // A nanometre: scale × integer + translate rounds differently when a common multiple is taken out first
            // (one unit in the last place of 458,154.974 is 6e-11).
            same(corner, &((got - expected[axis]).abs() < 1e-9), &true)?;
        }
    }
    let levels = facts["lods"].as_object().unwrap();
    same("lods", &levels.keys().collect::<Vec<_>>(), &read.lods.keys().collect())?;
    for (lod, (objects, polygons)) in &read.lods {
        same(lod, &levels[lod]["objects"], &objects.len().into())?;
        same(lod, &levels[lod]["polygons"], &(*polygons).into())?;
    }
    same("attributes", &facts["attributes"].as_object().unwrap().len(), &read.attributes.len())?;
    for (name, values) in &read.attributes {
        attribute(name, &facts["attributes"][name], values)?;
    }
    Ok(())
}

fn attribute(name: &str, facts: &Value, values: &[Value]) -> Result<(), Failed> {
    let given: Vec<&Value> = values.iter().filter(|value| !value.is_null()).collect();
    same(name, &facts["count"], &given.len().into())?;
    same(name, &facts["nulls"], &(values.len() - given.len()).into())?;
    let is_whole = |value: &&Value| value.is_i64() || value.is_u64();
    if !given.is_empty() && given.iter().all(|value| value.is_number()) {
        let kind = if given.iter().all(is_whole) { "integer" } else { "number" };
        same(name, &facts["type"].as_str(), &Some(kind))?;
        let numbers = || given.iter().map(|value| value.as_f64().unwrap());
        same(name, &facts["min"].as_f64(), &numbers().reduce(f64::min))?;
        same(name, &facts["max"].as_f64(), &numbers().reduce(f64::max))?;
    }
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for value in &given {
        *counts.entry(plain(value)).or_default() += 1;
    }
    for pair in facts["values"].as_array().unwrap() {
        same(name, &counts.get(&plain(&pair[0])).copied(), &pair[1].as_u64())?;
    }
    let mut most: Vec<u64> = counts.into_values().collect();
    most.sort_by_key(|count| std::cmp::Reverse(*count));
    most.truncate(64);
    let listed: Vec<u64> = facts["values"].as_array().unwrap().iter().map(|pair| pair[1].as_u64().unwrap()).collect();
    same(name, &listed, &most)
}

/// Numbers by value, everything else by its JSON text.
fn plain(value: &Value) -> String {
    value.as_f64().map_or_else(|| value.to_string(), |number| number.to_string())
}
