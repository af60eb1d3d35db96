//! Output of commands: files that appear whole or not at all, and standard output.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use crate::{
    cli::failure::{Failure, Outcome},
    figure::file::{WriteError, check_target, write_whole},
};

/// Writes to `path`, or to stdout for `-`, what `write` puts out; see [`write_whole`].
pub fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Outcome {
    write_whole(path, write).map_err(unwritten)
}

/// Refuses, before anything is drawn, files that could not be written afterwards; see [`check_target`].
pub fn check<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Outcome {
    files.into_iter().try_for_each(|file| check_target(file)).map_err(unwritten)
}

/// Writes text to stdout.
pub fn print(text: &str) -> Outcome {
    write(Path::new("-"), |out| out.write_all(text.as_bytes()))
}

/// A failure to write, for the command line.
pub fn unwritten(error: WriteError) -> Failure {
    match error {
        WriteError::Io { path, error } if path.as_os_str() == "-" => Failure::io("stdout", &error),
        WriteError::Io { path, error } => Failure::io(&path.display().to_string(), &error),
        no_file @ WriteError::NoFile(_) => Failure::usage(no_file),
        format @ WriteError::Format { .. } => Failure::failed(format),
    }
}
