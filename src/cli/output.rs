//! Output of commands: files that appear whole or not at all, and standard output.

#[cfg(unix)]
use std::os::unix::fs::MetadataExt;
use std::{
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use crate::{
    cli::failure::{Failure, Outcome},
    figure::file::{WriteError, check_target, write_whole, written_file},
};

/// Writes to `path`, or to stdout for `-`, what `write` puts out; see [`write_whole`].
pub fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Outcome {
    write_whole(path, write).map_err(unwritten)
}

/// Refuses, before anything is drawn, files that could not be written afterwards ([`check_target`]), two results for one file, and
/// results in place of what is read: `inputs`, and of folders what is in them. Links, and other spellings of a path, are the file that
/// they lead to.
pub fn check<'a, 'b>(
    files: impl IntoIterator<Item = &'a PathBuf>,
    inputs: impl IntoIterator<Item = &'b PathBuf>,
) -> Outcome {
    let files: Vec<&PathBuf> = files.into_iter().collect();
    files.iter().try_for_each(|file| check_target(file)).map_err(unwritten)?;
    let written: Vec<(&PathBuf, Identity)> =
        files.iter().filter_map(|file| Some((*file, Identity::of(&written_file(file)?)))).collect();
    for (i, (file, own)) in written.iter().enumerate() {
        if let Some((other, _)) = written[..i].iter().find(|(_, other)| other == own) {
            let also = if other == file { String::new() } else { format!(" ({} too)", other.display()) };
            return Err(Failure::usage(format!("{}: two results cannot go to one file{also}", file.display())));
        }
    }
    keep(files, inputs)
}

/// Refuses results in place of what is read: `inputs`, and of folders what is in them.
pub fn keep<'a, 'b>(
    files: impl IntoIterator<Item = &'a PathBuf>,
    inputs: impl IntoIterator<Item = &'b PathBuf>,
) -> Outcome {
    let identity = |file: &'a PathBuf| Some((file, Identity::of(&written_file(file)?)));
    let written: Vec<(&PathBuf, Identity)> = files.into_iter().filter_map(identity).collect();
    let in_folder = |path: &PathBuf| -> Vec<PathBuf> {
        std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
    };
    for input in inputs {
        for read in in_folder(input).iter().chain([input]).filter_map(|path| path.canonicalize().ok()) {
            let own = Identity::of(&read);
            if let Some((file, _)) = written.iter().find(|(_, written)| *written == own) {
                return Err(Failure::usage(format!(
                    "{}: {} is read, and would be replaced; another name would be right",
                    file.display(),
                    read.display()
                )));
            }
        }
    }
    Ok(())
}

/// What tells whether two paths are one file, there or not: its path without links, and its place on the disk.
struct Identity {
    path: PathBuf,
    #[cfg(unix)]
    place: Option<(u64, u64)>,
}

impl Identity {
    fn of(path: &Path) -> Self {
        #[cfg(unix)]
        let place = std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
        Self {
            path: path.to_owned(),
            #[cfg(unix)]
            place,
        }
    }
}

impl PartialEq for Identity {
    fn eq(&self, other: &Self) -> bool {
        #[cfg(unix)]
        if self.place.is_some() && self.place == other.place {
            return true;
        }
        self.path == other.path
    }
}

/// Writes text to stdout. A reader that leaves early has seen enough.
pub fn print(text: &str) -> Outcome {
    match write_whole(Path::new("-"), |out| out.write_all(text.as_bytes())) {
        Err(WriteError::Io { error, .. }) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(unwritten),
    }
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
