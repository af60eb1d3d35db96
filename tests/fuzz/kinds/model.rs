//! City models, of all formats, and what lies beside them.

use std::path::Path;

use veduta::city::{
    build::ModelBuilder,
    coplanar, facts, ground,
    load::{LoadOptions, input, read_input},
    shown, spatial, texture,
};

use super::{Kind, READ_S, always, files_of, refused};

pub fn kind() -> Kind {
    let is_of_it = |name: &str| !["README.md"].contains(&name) && !name.ends_with(".png");
    Kind {
        name: "models",
        files: files_of("citydata", is_of_it),
        sample: 800,
        is_worth: always,
        most_s: READ_S,
        read: Box::new(read),
    }
}

/// Reads one wrong file in every way that `info` and the renderer do; the error is why the result is not sound.
fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<bool, String> {
    let options = LoadOptions { roots: vec![folder.to_owned()], ..LoadOptions::default() };
    // Libraries of materials are reached through a model; the mutated one lies in `folder`.
    let (name, bytes) = match name.ends_with(".mtl") {
        true => ("textured.obj", std::fs::read("citydata/textured.obj").map_err(|e| e.to_string())?),
        false => (name, bytes.to_vec()),
    };
    let Ok(input) = input::from_bytes(&folder.join(name), bytes) else { return Ok(false) };
    let mut builder = ModelBuilder::default();
    match read_input(&mut builder, input, &options) {
        Ok(()) => {}
        Err(error) => return refused(&error.to_string()),
    }
    let model = builder.finish();
    model.validate()?;
    model.warnings.iter().try_for_each(|(_, warning)| refused(&warning.message).map(drop))?;
    let shown = shown::shown_geometries(&model, None);
    let index = spatial::SpatialIndex::build(&model, &shown);
    let ground = ground::plain_ground(&model, &shown).is_some();
    let coplanar = coplanar::coplanar_triangles(&model, &shown).len();
    std::hint::black_box((index, ground, coplanar));
    let facts = serde_json::to_string(&facts::facts(&model, true)).map_err(|e| format!("facts: {e}"))?;
    serde_json::from_str::<serde_json::Value>(&facts).map_err(|e| format!("facts are no JSON: {e}"))?;
    model.textures.iter().for_each(|t| drop(texture::decode(t)));
    Ok(true)
}
