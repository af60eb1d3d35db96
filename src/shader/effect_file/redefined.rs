//! Names of users' effects that effects are given, too.

use crate::shader::{
    effect::definition::EffectDefinition,
    effect_file::{
        check::module_of,
        error::{File, FileError},
        read::{read_with_names, signature},
    },
    wgsl::token,
};

/// What a file declares that effects are given, too: it is the effect's own there, which its author may not know. Nothing of a file that
/// is wrong.
pub fn redefined(path: &str, text: &str) -> Vec<FileError> {
    let Ok((effect, _)) = read_with_names(path, text, true) else { return Vec::new() };
    let module = module_of(&effect);
    // Its own names are qualified there.
    let tokens = token::tokens(&module);
    let given: Vec<&str> = token::declarations(&module, &tokens).iter().map(|d| d.name).collect();
    let file = File { path, text };
    let own = token::declarations(text, &token::tokens(text));
    let twice = own.iter().filter(|d| given.contains(&d.name));
    twice
        .map(|d| {
            let message = format!("`{}` is what effects are given, too; in this file it is the effect's own", d.name);
            file.error(d.span.start, message)
        })
        .collect()
}

/// Refuses a file that declares a type which its effect is called with.
pub(super) fn check_types(effect: &EffectDefinition, file: &File) -> Result<(), FileError> {
    let called = signature(effect);
    let called: Vec<&str> = called.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let own = token::declarations(file.text, &token::tokens(file.text));
    let is_given = |d: &&token::Declaration| matches!(d.keyword, "struct" | "alias") && called.contains(&d.name);
    match own.iter().find(is_given) {
        Some(d) if d.name != "Parameters" => {
            let message = format!("`{}` is what effects are called with; expected another name", d.name);
            Err(file.error(d.span.start, message))
        }
        _ => Ok(()),
    }
}
