//! Edges of every shared CityJSON file against its rings, read by something that knows nothing but JSON: each edge of
//! each ring is in the list once per geometry, and nothing else is. And how many of each class there are.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use glam::{DVec3, Vec3};
use libtest_mimic::{Failed, Trial};
use serde_json::Value;
use veduta::city::{
    CityModel, Lod,
    edges::{CreaseAngles, Edge, edges},
    load::{LoadOptions, Quiet, load},
    shown::shown_geometries,
};

/// Objects with refused faces are left out, and so is the file whose only geometry has one.
const FILES: &[&str] = &[
    "3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl",
    "3dbag-delft/3dbag_901.v1.1.city.jsonl",
    "3dbag-delft/3dbag_multi_lod.v2.0.city.json",
    "3dbag-delft/3dbag_small.v2.0.city.jsonl",
    "delft-bgt/delft_bgt.v2.0.city.json",
    "denhaag-01/DH_01_subs.city.json",
    "denhaag-01/DenHaag_01.v1.0.city.json",
    "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json",
    "vienna-102081/vienna_102081.v1.1.city.jsonl",
];

/// (file, borders, creases and flat edges of what is shown by default), as first counted and looked at.
const COUNTS: &[(&str, [usize; 3])] = &[
    ("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl", [34, 30_360, 6084]),
    ("3dbag-delft/3dbag_901.v1.1.city.jsonl", [0, 2923, 666]),
    ("delft-bgt/delft_bgt.v2.0.city.json", [12_551, 31_924, 16_180]),
    ("denhaag-01/DenHaag_01.v1.0.city.json", [533, 32_399, 9724]),
    ("rotterdam-delfshaven/3-20-DELFSHAVEN.city.json", [21_662, 20_459, 2252]),
    ("rotterdam-delfshaven/delfshaven_cj2glb.glb", [17_482, 21_236, 0]),
    ("vienna-102081/vienna_102081.v1.1.city.jsonl", [44, 27_004, 2189]),
];

type Ends = [[i64; 3]; 2];
/// By object and level of detail.
type Shapes = BTreeMap<(String, String), BTreeSet<Ends>>;

pub fn trials() -> Vec<Trial> {
    let rings =
        FILES.iter().map(|&file| crate::trial(&format!("edges::rings::{file}"), move |root| compare(&root.join(file))));
    let counts = COUNTS.iter().map(|&(file, expected)| {
        crate::trial(&format!("edges::counts::{file}"), move |root| {
            let model = load(&[root.join(file)], &LoadOptions::default(), &Quiet)?;
            let mut found = [0; 3];
            for edge in edges(&model, &shown_geometries(&model, None), &CreaseAngles::default()) {
                found[edge.class as usize] += 1;
            }
            if found == expected { Ok(()) } else { Err(format!("{found:?}, not {expected:?}").into()) }
        })
    });
    rings.chain(counts).collect()
}

fn compare(file: &Path) -> Result<(), Failed> {
    let (origin, step, expected) = independent(file)?;
    let model = load(&[file.to_owned()], &LoadOptions::default(), &Quiet)?;
    model.validate()?;
    let (mut found, mut has_dropped) = (Shapes::new(), BTreeSet::new());
    let all: Vec<u32> = (0..model.geometries.len() as u32).collect();
    let mut of_geometry: BTreeSet<(u32, Ends)> = BTreeSet::new();
    for edge in edges(&model, &all, &CreaseAngles::default()) {
        let (number, ends) = (model.tiles[edge.tile as usize].geometry, in_lattice(&model, &edge, origin, step));
        if !of_geometry.insert((number, ends)) {
            return Err(format!("geometry {number} has {ends:?} twice").into());
        }
        found.entry(shape(&model, number)).or_default().insert(ends);
    }
    for (number, geometry) in (0..).zip(&model.geometries) {
        if geometry.dropped > 0 {
            has_dropped.insert(shape(&model, number));
        }
    }
    let mut odd = Vec::new();
    let mut compared = 0;
    for (shape, rings) in &expected {
        if has_dropped.contains(shape) {
            continue;
        }
        compared += rings.len();
        let found = found.remove(shape).unwrap_or_default();
        if found != *rings {
            let (missing, extra) = (rings.difference(&found), found.difference(rings));
            odd.push(format!(
                "{shape:?}: without {:?}, with {:?}",
                missing.collect::<Vec<_>>(),
                extra.collect::<Vec<_>>()
            ));
        }
    }
    if compared == 0 {
        return Err("nothing was compared".into());
    }
    if odd.is_empty() { Ok(()) } else { Err(format!("{} of them\n{}", odd.len(), odd.join("\n")).into()) }
}

fn shape(model: &CityModel, geometry: u32) -> (String, String) {
    let geometry = &model.geometries[geometry as usize];
    (model.objects[geometry.object as usize].id.to_string(), geometry.lod.to_string())
}

fn in_lattice(model: &CityModel, edge: &Edge, origin: DVec3, step: DVec3) -> Ends {
    let tile = model.tiles[edge.tile as usize].origin.as_dvec3();
    let mut ends = edge.ends.map(|p| {
        let at = (tile + Vec3::from(p).as_dvec3() - origin) / step;
        at.round().to_array().map(|c| c as i64)
    });
    ends.sort_unstable();
    ends
}

fn vector(value: &Value) -> Option<DVec3> {
    Some(DVec3::new(value.get(0)?.as_f64()?, value.get(1)?.as_f64()?, value.get(2)?.as_f64()?))
}

/// Origin and step of the file's integers, and the edges of its rings.
fn independent(file: &Path) -> Result<(DVec3, DVec3, Shapes), Failed> {
    let text = std::fs::read_to_string(file)?;
    let documents: Vec<Value> = match file.extension().is_some_and(|e| e == "jsonl") {
        true => text.lines().filter(|l| !l.trim().is_empty()).map(serde_json::from_str).collect::<Result<_, _>>()?,
        false => vec![serde_json::from_str(&text)?],
    };
    let transform = &documents[0]["transform"];
    let (origin, step) = vector(&transform["translate"]).zip(vector(&transform["scale"])).ok_or("no transform")?;
    let mut shapes = Shapes::new();
    for document in &documents {
        let point =
            |v: &Value| -> Option<[i64; 3]> { Some([v.get(0)?.as_i64()?, v.get(1)?.as_i64()?, v.get(2)?.as_i64()?]) };
        let none = Vec::new();
        let vertices: Vec<[i64; 3]> = document["vertices"]
            .as_array()
            .unwrap_or(&none)
            .iter()
            .map(|v| point(v).ok_or("a vertex"))
            .collect::<Result<_, _>>()?;
        for (id, object) in document["CityObjects"].as_object().into_iter().flatten() {
            for geometry in object["geometry"].as_array().unwrap_or(&none) {
                let lod = match &geometry["lod"] {
                    Value::String(lod) => lod.clone(),
                    other => other.to_string(),
                };
                let lod = Lod::parse(&lod).map_or("none".to_owned(), |lod| lod.to_string());
                add_polygons(&geometry["boundaries"], &vertices, shapes.entry((id.clone(), lod)).or_default());
            }
        }
    }
    Ok((origin, step, shapes))
}

/// Walks nested arrays down to polygons: lists of lists of numbers.
fn add_polygons(boundaries: &Value, vertices: &[[i64; 3]], into: &mut BTreeSet<Ends>) {
    let Some(list) = boundaries.as_array() else { return };
    let is_polygon = list.first().and_then(|ring| ring.get(0)).is_some_and(Value::is_u64);
    if !is_polygon {
        list.iter().for_each(|inner| add_polygons(inner, vertices, into));
        return;
    }
    // What a polygon's rings run along twice encloses nothing.
    let mut odd: BTreeSet<Ends> = BTreeSet::new();
    for ring in list.iter().filter_map(Value::as_array) {
        let mut points: Vec<[i64; 3]> = ring.iter().map(|i| vertices[i.as_u64().unwrap_or(0) as usize]).collect();
        points.dedup();
        for i in 0..points.len() {
            let mut ends = [points[i], points[(i + 1) % points.len()]];
            ends.sort_unstable();
            if ends[0] != ends[1] && !odd.remove(&ends) {
                odd.insert(ends);
            }
        }
    }
    into.extend(odd);
}
