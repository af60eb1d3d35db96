//! The shared GLB against numbers printed by `tests/independent/glb_reader.py`, which shares no code with Veduta.

use std::process::Command;

use libtest_mimic::{Failed, Trial};
use serde_json::{Value, json};

pub fn trials() -> Vec<Trial> {
    vec![crate::trial("meshes::delfshaven_cj2glb", |root| {
        let file = root.join("rotterdam-delfshaven/delfshaven_cj2glb.glb");
        let output =
            Command::new(env!("CARGO_BIN_EXE_veduta")).args(["info", "--json", "--list"]).arg(file).output()?;
        let facts: Value = serde_json::from_slice(&output.stdout)?;
        same(&facts, "/format", json!("glTF"))?;
        same(&facts, "/extent/min", json!([90409.3203125, 435440.4375, 0.0]))?;
        same(&facts, "/extent/max", json!([91453.8828125, 436089.9375, 41.15800094604492]))?;
        same(&facts, "/objects/total", json!(1))?;
        same(&facts, "/objects/list/0/id", json!("node-0"))?;
        same(&facts, "/objects/list/0/parents", json!([]))?;
        same(&facts, "/lods/none/polygons", json!(37437))?;
        // 28 of them have no area, in exact fractions; none is there twice.
        same(&facts, "/lods/none/triangles", json!(37409))?;
        same(&facts, "/faces_dropped", json!(28))?;
        same(&facts, "/warnings/0/code", json!("zero-area"))?;
        same(&facts, "/warnings/1", Value::Null)
    })]
}

fn same(facts: &Value, place: &str, wanted: Value) -> Result<(), Failed> {
    let found = facts.pointer(place).cloned().unwrap_or_default();
    if found == wanted { Ok(()) } else { Err(format!("{place} is {found}, not {wanted}").into()) }
}
