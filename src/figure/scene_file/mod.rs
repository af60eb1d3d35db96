//! Scene files (TOML) and back, exactly as `docs/scene.md` has them.
//!
//! Each table is a file with the rows of its keys (`row`): what a key takes, its default, unit, text and example, and how its value comes out of
//! the scene and goes into it. `scene` has the top of the file. `node` reads TOML with line numbers, `check` holds it against the keys, the rows
//! take it over and give it back, `text` writes it. `edit` changes one value, typed or as `PATH=VALUE`; `save` changes the text of a file and
//! leaves what it says besides; `document` makes the docs and the schema.

pub mod animation;
pub mod best_view;
mod camera;
pub mod check;
mod choice;
mod city;
mod content;
pub mod deformation;
pub mod document;
pub mod edit;
mod effects;
mod epoch;
mod figure;
mod forms;
mod given_keys;
mod handled;
pub mod keys;
pub mod lens;
pub mod node;
mod occlusion;
pub mod overlay;
mod paths;
mod poi;
mod problems;
mod ray;
mod reader;
mod region;
mod rendering;
mod row;
mod save;
pub mod scene;
pub mod shape_keys;
pub mod sprite;
mod style;
pub mod test_keys;
mod text;
mod trajectory;
pub mod volume;

use std::{
    io::Read,
    path::{Path, PathBuf},
};

pub use check::Problem;
pub use edit::{Edit, rename_lens, set, set_within};
pub(in crate::figure) use figure::text_size;
pub use forms::{lens_color, rotation};
pub use paths::{Options, PathProblem};
pub use problems::SceneFileError;

use reader::Reader;

use crate::scene::Scene;

/// Largest scene file, bytes.
const MAX_BYTES: u64 = 16 << 20;
/// Reads a scene file (`-`: standard input).
pub fn read(path: &Path, options: &Options) -> Result<Scene, SceneFileError> {
    let name = path.display().to_string();
    parse(&read_text(path, &name, "scene")?, &name, options)
}

/// The text of a file of this kind (`-`: standard input); `name` stands for it in messages.
pub(in crate::figure) fn read_text(path: &Path, name: &str, kind: &str) -> Result<String, SceneFileError> {
    let failed = |e: std::io::Error| SceneFileError::whole(name, 0, format!("cannot be read: {e}"));
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().lock().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    } else {
        let file = std::fs::File::open(path).map_err(failed)?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    }
    if bytes.len() as u64 > MAX_BYTES {
        let message = format!("is larger than 16 MiB; a {kind} file is a page of text");
        return Err(SceneFileError::whole(name, 0, message));
    }
    String::from_utf8(bytes).map_err(|e| {
        let line = e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count() as u32 + 1;
        SceneFileError::whole(name, line, format!("is not UTF-8 text; a {kind} file is TOML"))
    })
}

/// Reads a scene from text; `name` stands for it in messages.
pub fn parse(text: &str, name: &str, options: &Options) -> Result<Scene, SceneFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root =
        node::parse(text).map_err(|(line, message)| SceneFileError::whole(name, line, message.replace('\n', ", ")))?;
    if root.has("veduta_sheet") {
        return Err(SceneFileError::whole(name, 1, "is a sheet and not a scene; `veduta sheet` draws it"));
    }
    let mut reader = Reader::new(options);
    let scene = scene::read(&mut reader, &root);
    if reader.checker.problems.is_empty() { Ok(scene) } else { Err(reader.error(name)) }
}

/// The scene as TOML, paths as they are. Reading it with [`Options::for_command_line`] gives the same scene.
pub fn to_toml(scene: &Scene) -> String {
    to_toml_for(scene, &Options::default())
}

/// The scene as the TOML of a file that is read with `options`: paths relative to its folder where they lie in it.
pub fn to_toml_for(scene: &Scene, options: &Options) -> String {
    text::file(&tree(scene, options))
}

/// The scene as the TOML of a file that is read with `options`, made of the text of a file that is read with `was`: what is another value is changed
/// in it, and comments, order and empty lines stay. Where that text is no scene, or would not mean this one, the scene is written anew.
pub fn to_edited(text: &str, was: &Options, scene: &Scene, options: &Options) -> String {
    let anew = to_toml_for(scene, options);
    let edited = || {
        let (before, after) = (parse(text, "", was).ok()?, parse(&anew, "", options).ok()?);
        let (before, now) = (tree(&before, was), tree(scene, options));
        let means_it = |made: &String| parse(made, "", options).is_ok_and(|made| made == after);
        [false, true].into_iter().find_map(|strict| save::changed(text, &before, &now, strict).filter(means_it))
    };
    edited().unwrap_or(anew)
}

/// The files and folders that a scene names, as far as they are there: of what it says in words what is the path of one.
pub fn files_of(scene: &Scene) -> Vec<PathBuf> {
    fn add(node: &node::Node, files: &mut Vec<PathBuf>) {
        match &node.data {
            node::Data::Text(text) => files.extend(Some(PathBuf::from(text)).filter(|path| path.exists())),
            node::Data::List(nodes) => nodes.iter().for_each(|node| add(node, files)),
            node::Data::Table(entries) => entries.iter().for_each(|(_, _, node)| add(node, files)),
            _ => {}
        }
    }
    let mut files = Vec::new();
    add(&tree(scene, &Options { data: None, base: PathBuf::new(), ..Options::default() }), &mut files);
    files
}

/// The scene as the tree of that file.
pub fn tree(scene: &Scene, options: &Options) -> node::Node {
    scene::written(scene, options)
}

#[cfg(test)]
mod round_trip;
#[cfg(test)]
mod tests;
