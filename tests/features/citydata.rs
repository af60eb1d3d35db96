//! Every hand-made city is what its line in `citydata/README.md` says.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use veduta::city::{
    load::{self, LoadOptions, Quiet},
    shown::shown_geometries,
};

/// One line of the table.
struct Row {
    file: String,
    objects: usize,
    triangles: u32,
    warnings: BTreeSet<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("citydata")
}

fn rows() -> Vec<Row> {
    let table = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let lines = table.lines().filter(|line| line.starts_with("| `"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let [file, what, objects, triangles, warnings] = cells[..] else { panic!("five columns expected: {line}") };
            assert!(!what.is_empty(), "{line}");
            Row {
                file: file.trim_matches('`').to_owned(),
                objects: objects.parse().unwrap(),
                triangles: triangles.parse().unwrap(),
                warnings: warnings.split_whitespace().map(|code| code.trim_matches('`').to_owned()).collect(),
            }
        })
        .collect()
}

#[test]
fn every_model_is_in_the_table() {
    let models = ["json", "jsonl", "gz", "gltf", "glb", "obj"];
    let is_model = |name: &String| name.rsplit_once('.').is_some_and(|(_, extension)| models.contains(&extension));
    let entries = std::fs::read_dir(folder()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let found: BTreeSet<String> = entries.filter(is_model).collect();
    let listed: BTreeSet<String> = rows().into_iter().map(|row| row.file).collect();
    assert_eq!(found, listed);
}

#[test]
fn every_model_is_what_its_line_says() {
    let mut wrong = Vec::new();
    for row in rows() {
        let model = match load::load(&[folder().join(&row.file)], &LoadOptions::default(), &Quiet) {
            Ok(model) => model,
            Err(error) => {
                wrong.push(error.to_string());
                continue;
            }
        };
        let triangles: u32 =
            shown_geometries(&model, None).iter().map(|g| model.geometries[*g as usize].triangles).sum();
        let warnings: BTreeSet<String> = model.warnings.iter().map(|(code, _)| code.code().to_owned()).collect();
        if (model.objects.len(), triangles, &warnings) != (row.objects, row.triangles, &row.warnings) {
            let file = &row.file;
            wrong.push(format!("{file}: {} objects, {triangles} triangles, {warnings:?}", model.objects.len()));
        }
    }
    assert!(wrong.is_empty(), "not as the table says:\n{}", wrong.join("\n"));
}
