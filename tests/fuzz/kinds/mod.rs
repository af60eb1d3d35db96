//! Kinds of files that Veduta reads, each with files that are right and with what is done to one.

mod drawn;
mod effect;
mod field;
mod model;
mod picture;
mod scene;
mod sheet;
mod sprite;

use std::path::Path;

use crate::studio::random_scene::{FAMILY, Wanted, scene};

/// A file to be made wrong.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// Reads a file (its folder, its name, its bytes) in every way that the program does, and says whether it is taken; the error is why the result is
/// not sound.
pub type Read = Box<dyn FnMut(&Path, &str, &[u8]) -> Result<bool, String>>;

/// A kind of file.
pub struct Kind {
    pub name: &'static str,
    pub files: Vec<Seed>,
    /// Files that a run of `cargo test` makes wrong.
    pub sample: u64,
    /// Whether a wrong file may still be right enough to be worth reading.
    pub is_worth: fn(&str, &[u8]) -> bool,
    /// Seconds that a file may take on an idle machine.
    pub most_s: f64,
    pub read: Read,
}

/// Reading takes well under a second; what takes longer hangs.
const READ_S: f64 = 10.0;
/// The software adapter makes its programs in some seconds each.
const DRAWN_S: f64 = 100.0;

/// All kinds.
pub fn kinds() -> Vec<Kind> {
    vec![
        model::kind(),
        sprite::kind(),
        picture::kind(),
        scene::kind(),
        sheet::kind(),
        effect::kind(),
        field::kind(),
        drawn::scenes(),
        drawn::effects(),
    ]
}

/// Every file is.
fn always(_: &str, _: &[u8]) -> bool {
    true
}

/// The files of a folder, by name.
fn files_of(folder: &str, is_of_it: impl Fn(&str) -> bool) -> Vec<Seed> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut files: Vec<Seed> = entries
        .map(|entry| entry.expect("a folder that can be listed"))
        .filter(|entry| entry.path().is_file() && is_of_it(&entry.file_name().to_string_lossy()))
        .map(|entry| Seed {
            name: entry.file_name().to_string_lossy().into_owned(),
            bytes: std::fs::read(entry.path()).expect("a file that can be read"),
        })
        .collect();
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files
}

/// Random scenes, of as many families.
fn random_scenes(count: u64) -> Vec<Seed> {
    let wanted = Wanted { lenses: [1, 4], deformations: true, history: None };
    let scenes = (0..count).map(|i| Seed {
        name: format!("random-{i}.toml"),
        bytes: scene(i * FAMILY, "builtin:square", wanted).into_bytes(),
    });
    scenes.collect()
}

/// A file is not taken; people must be able to read why: one line, not too long, without what steers a terminal.
fn refused(message: &str) -> Result<bool, String> {
    match message.contains('\n') {
        true => Err(format!("an unreadable message: {message:?}")),
        false => refused_in_lines(message),
    }
}

/// The same, of a message that has a line for each problem.
fn refused_in_lines(message: &str) -> Result<bool, String> {
    let is_bad = |line: &str| line.is_empty() || line.len() > MOST_IN_LINE || line.chars().any(char::is_control);
    match message.is_empty() || message.split('\n').any(is_bad) {
        true => Err(format!("an unreadable message: {message:?}")),
        false => Ok(false),
    }
}

/// Bytes of a line of a message.
const MOST_IN_LINE: usize = 2000;
