//! Effects of users, added to those that come with the program.

use crate::shader::{
    effect::registry,
    effect_file::{check::checked, error::FileError},
};

/// Adds a user's effect file; its name must be new.
///
/// # Errors
/// A mistake in the file, or a name that is taken.
pub fn add(path: &str, text: &str) -> Result<(), FileError> {
    put(path, text, false).map(drop)
}

/// Takes a user's effect file that may be another version of one that is there, and says how the effect is called. It keeps its number;
/// pipelines that have the version before in them stay until they are forgotten ([`crate::render::Renderer::forget_shaders`]). Not while a
/// picture is drawn: that would mix both versions.
///
/// # Errors
/// A mistake in the file, or a name that is taken; what was there before stays.
pub fn replace(path: &str, text: &str) -> Result<String, FileError> {
    put(path, text, true)
}

fn put(path: &str, text: &str, may_replace: bool) -> Result<String, FileError> {
    let effect = checked(path, text)?;
    let name = effect.name.clone();
    registry::put(effect, may_replace).map_err(|message| FileError {
        path: path.to_owned(),
        line: 1,
        column: 1,
        message,
    })?;
    Ok(name)
}
