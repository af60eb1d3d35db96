//! Sheet files, and the scenes of their cells.

use std::path::Path;

use veduta::{
    figure::{
        scene_file::{Options, parse},
        sheet::{cells, file},
    },
    scene::Scene,
};

use super::{Kind, READ_S, always, files_of, refused_in_lines};

pub fn kind() -> Kind {
    let options = Options { allow_outside: true, data: Some("data".into()), ..Options::default() };
    let text = std::fs::read_to_string("scenes/three-lenses.toml").expect("a scene");
    let base = parse(&text, "scene.toml", &options).expect("a scene that is right");
    let files = files_of("scenes", |name| name.ends_with(".sheet.toml"));
    Kind {
        name: "sheets",
        files,
        sample: 400,
        is_worth: always,
        most_s: READ_S,
        read: Box::new(move |_: &Path, _, bytes| read(bytes, &base, &options)),
    }
}

fn read(bytes: &[u8], base: &Scene, options: &Options) -> Result<bool, String> {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(false) };
    let found = file::parse(text, "fuzz.sheet.toml").and_then(|sheet| {
        // Many cells are many equal steps.
        match sheet.grid() {
            [rows, columns] if rows * columns <= 64 => cells::cells(&sheet, base, "fuzz.sheet.toml", options).map(drop),
            _ => Ok(()),
        }
    });
    found.map(|()| true).or_else(|error| refused_in_lines(&error.to_string()))
}
