//! Cities made for the checks: in memory, of corners on whole millimetres, without any file.

use std::{path::Path, sync::Arc};

use glam::DVec3;

use crate::{
    city::{
        CityModel,
        build::ModelBuilder,
        load::{LoadError, LoadOptions, input, read_input},
        synth::{SynthOptions, write_cityjson},
    },
    gpu::Gpu,
    render::picture::{RenderError, Studio},
    scene::CitySpec,
};

/// A place in whole millimetres from a city's origin.
pub type Corner = [i64; 3];

/// A city object: its faces, each a ring of corners, and a number.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Its attribute `n`; its id is `b` and this number.
    pub number: usize,
    /// Rings of corners.
    pub faces: Vec<Vec<Corner>>,
    /// Index into [`COLORS`].
    pub material: usize,
}

/// Diffuse colours of the materials, linear parts of 1.
pub const COLORS: [&str; 4] = ["[0.9,0.85,0.7]", "[0.7,0.25,0.15]", "[0.1,0.3,0.8]", "[0.2,0.7,0.2]"];

/// Where Dutch cities are, metres (EPSG:28992).
pub const DUTCH: DVec3 = DVec3::new(85_000.0, 447_000.0, 3.0);
/// Where Bavarian ones are, metres (EPSG:25832).
pub const UTM: DVec3 = DVec3::new(691_607.0, 5_334_760.0, 519.0);

/// The place of a corner, metres.
pub fn place(origin: DVec3, corner: Corner) -> DVec3 {
    origin + 0.001 * DVec3::from(corner.map(|c| c as f64))
}

/// The six faces of a box from corner to corner, seen from outside.
pub fn block(low: Corner, high: Corner) -> Vec<Vec<Corner>> {
    let at = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.into_iter().map(|face| face.map(at).to_vec()).collect()
}

/// A rectangle across the x axis, from its lower to its upper corner in y and z.
pub fn pane(x: i64, low: [i64; 2], high: [i64; 2]) -> Vec<Vec<Corner>> {
    vec![vec![[x, low[0], low[1]], [x, high[0], low[1]], [x, high[0], high[1]], [x, low[0], high[1]]]]
}

/// Numbers solids from 0 on, materials in turn.
pub fn numbered(faces: impl IntoIterator<Item = Vec<Vec<Corner>>>) -> Vec<Solid> {
    let solid = |(number, faces)| Solid { number, faces, material: number % COLORS.len() };
    faces.into_iter().enumerate().map(solid).collect()
}

/// CityJSON of these solids about an origin.
fn written(origin: DVec3, solids: &[Solid]) -> String {
    let mut vertices: Vec<String> = Vec::new();
    let mut objects = Vec::new();
    for solid in solids {
        let mut faces = Vec::new();
        for ring in &solid.faces {
            let first = vertices.len();
            vertices.extend(ring.iter().map(|[x, y, z]| format!("[{x},{y},{z}]")));
            let corners: Vec<String> = (first..vertices.len()).map(|v| v.to_string()).collect();
            faces.push(format!("[[{}]]", corners.join(",")));
        }
        objects.push(format!(
            r#""b{0}": {{"type": "Building", "attributes": {{"n": {0}}}, "geometry": [{{"type": "MultiSurface", "lod": "2",
                "boundaries": [{1}], "material": {{"a": {{"value": {2}}}}}}}]}}"#,
            solid.number,
            faces.join(","),
            solid.material
        ));
    }
    let material = |(i, color): (usize, &&str)| format!(r#"{{"name": "m{i}", "diffuseColor": {color}}}"#);
    let materials: Vec<String> = COLORS.iter().enumerate().map(material).collect();
    format!(
        r#"{{"type": "CityJSON", "version": "2.0",
            "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [{}, {}, {}]}}, "CityObjects": {{{}}},
            "appearance": {{"default-theme-material": "a", "materials": [{}]}}, "vertices": [{}]}}"#,
        origin.x,
        origin.y,
        origin.z,
        objects.join(",\n"),
        materials.join(","),
        vertices.join(",")
    )
}

/// A studio on a device of its own over these solids, without the plain ground.
///
/// # Errors
/// The adapter refuses it.
pub fn of_solids(origin: DVec3, solids: &[Solid]) -> Result<Studio, RenderError> {
    studio(model(written(origin, solids).into_bytes())?)
}

/// A studio on a device of its own over the generator's city.
///
/// # Errors
/// The adapter refuses it.
pub fn synthetic(buildings: u64, seed: u64) -> Result<Studio, RenderError> {
    let mut bytes = Vec::new();
    write_cityjson(&SynthOptions { buildings, seed }, &mut bytes, &mut |_| {})
        .map_err(|error| RenderError::Scene(error.to_string()))?;
    studio(model(bytes)?)
}

fn model(bytes: Vec<u8>) -> Result<CityModel, RenderError> {
    let failed = |error: LoadError| RenderError::Scene(error.to_string());
    let input = input::from_bytes(Path::new("check.city.json"), bytes).map_err(failed)?;
    let mut builder = ModelBuilder::default();
    read_input(&mut builder, input, &LoadOptions::default()).map_err(failed)?;
    Ok(builder.finish())
}

fn studio(model: CityModel) -> Result<Studio, RenderError> {
    Studio::new(Gpu::open()?, Arc::new(model), &CitySpec { ground: false, ..CitySpec::default() })
}
