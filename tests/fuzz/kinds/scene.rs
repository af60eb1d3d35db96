//! Scene files: read, written, read again.

use std::path::Path;

use veduta::figure::scene_file::{Options, parse, to_edited, to_toml};

use super::{Kind, READ_S, always, files_of, random_scenes, refused_in_lines};

/// How scenes are read: where they lead is not asked.
fn options() -> Options {
    Options { allow_outside: true, data: Some("data".into()), ..Options::default() }
}

pub fn kind() -> Kind {
    let mut files = files_of("scenes", |name| name.ends_with(".toml") && !name.ends_with(".sheet.toml"));
    files.extend(random_scenes(40));
    Kind { name: "scenes", files, sample: 1500, is_worth: always, most_s: READ_S, read: Box::new(read) }
}

fn read(_: &Path, _: &str, bytes: &[u8]) -> Result<bool, String> {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(false) };
    let scene = match parse(text, "fuzz.toml", &options()) {
        Ok(scene) => scene,
        Err(error) => return refused_in_lines(&error.to_string()),
    };
    // Turns are written in degrees, which give the same to a rounding: what is written of both tells whether they are the same.
    let written = to_toml(&scene);
    match parse(&written, "written.toml", &options()) {
        Ok(again) if to_toml(&again) == written => {}
        Ok(again) => return Err(format!("{written}\nis written, and read it is\n{}", to_toml(&again))),
        Err(error) => return Err(format!("what was written is refused: {error}\n{written}")),
    }
    let edited = to_edited(text, &options(), &scene, &options());
    match parse(&edited, "edited.toml", &options()) {
        Ok(again) if to_toml(&again) == written => Ok(true),
        _ => Err(format!("the text of the file, unchanged, is another scene:\n{edited}")),
    }
}
