//! Effect files: read, checked, and compiled as the driver gets them.

use std::path::Path;

use veduta::shader::effect_file::checked;

use super::{Kind, READ_S, Seed, always, files_of, refused};

/// The effects of the program under names of a user, and those of the docs.
pub fn files() -> Vec<Seed> {
    let mut files = files_of("shaders/effect", |name| name.ends_with(".wgsl"));
    for file in &mut files {
        let text = String::from_utf8_lossy(&file.bytes).replacen("//! name = \"", "//! name = \"my-", 1);
        file.bytes = text.into_bytes();
    }
    let docs = std::fs::read_to_string("docs/effects.md").expect("docs/effects.md");
    let texts = docs.split("```wgsl\n").skip(1).filter_map(|rest| rest.split("```").next());
    for (i, text) in texts.filter(|text| text.starts_with("//!")).enumerate() {
        files.push(Seed { name: format!("docs-{i}.wgsl"), bytes: text.as_bytes().to_vec() });
    }
    files.retain(|file| checked(&file.name, &String::from_utf8_lossy(&file.bytes)).is_ok());
    assert!(files.len() > 20, "{} effects that a user may have", files.len());
    files
}

pub fn kind() -> Kind {
    Kind { name: "effects", files: files(), sample: 600, is_worth: always, most_s: READ_S, read: Box::new(read) }
}

fn read(_: &Path, name: &str, bytes: &[u8]) -> Result<bool, String> {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(false) };
    checked(name, text).map(|_| true).or_else(|error| refused(&error.to_string()))
}
