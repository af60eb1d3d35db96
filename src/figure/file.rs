//! Files that appear whole or not at all.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// What can go wrong while writing.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file system.
    #[error("{path}: cannot be written: {error}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// The path names no file.
    #[error("{}: is no file name; a file would be right", .0.display())]
    NoFile(PathBuf),
    /// The format cannot hold it.
    #[error("{path}: {message}")]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong and what would be right.
        message: String,
    },
}

/// Writes to `path`, or to standard output for `-`, what `write` puts out.
///
/// The file appears when `write` has succeeded; until then, and if it fails, a file that was there stays as it is and
/// nothing is left beside it.
///
/// # Errors
/// The file system's; and [`WriteError::NoFile`] where `path` is a folder.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
    let failed = |error| WriteError::Io { path: path.to_owned(), error };
    if path.as_os_str() == "-" {
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        return write(&mut out).and_then(|()| out.flush()).map_err(failed);
    }
    let beside = Beside::new(path)?;
    let mut out = BufWriter::with_capacity(1 << 16, File::create(&beside.path).map_err(failed)?);
    write(&mut out).and_then(|()| out.flush()).map_err(failed)?;
    drop(out);
    beside.into_place(path).map_err(failed)
}

/// Whether a file can be written to `path` as far as that is known before it is: its folder is there, and it names no
/// folder itself. Standard output, `-`, always can.
///
/// # Errors
/// Those of [`write_whole`].
pub fn check_target(path: &Path) -> Result<(), WriteError> {
    if path.as_os_str() == "-" {
        return Ok(());
    }
    if path.file_name().is_none() || path.is_dir() {
        return Err(WriteError::NoFile(path.to_owned()));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() && !folder.is_dir() {
        let message = format!("the folder {} does not exist; make it first", folder.display());
        return Err(WriteError::Io { path: path.to_owned(), error: io::Error::other(message) });
    }
    Ok(())
}

/// A file beside the one it will become; removed unless it does.
struct Beside {
    path: PathBuf,
    done: bool,
}

impl Beside {
    fn new(target: &Path) -> Result<Self, WriteError> {
        check_target(target)?;
        let Some(name) = target.file_name() else { return Err(WriteError::NoFile(target.to_owned())) };
        // The process id keeps two programs that write one file apart.
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}.part", std::process::id()));
        Ok(Self { path: target.with_file_name(hidden), done: false })
    }

    fn into_place(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if !self.done {
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_what_was_there() {
        let folder = std::env::temp_dir().join(format!("veduta-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let file = folder.join("a.txt");
        write_whole(&file, |out| out.write_all(b"first")).unwrap();
        let failed = write_whole(&file, |out| {
            out.write_all(b"second")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&file).unwrap(), b"first");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing is left beside it");
        assert!(write_whole(&folder, |_| Ok(())).is_err(), "a folder is no file");
        assert!(write_whole(&folder.join("no/a.txt"), |_| Ok(())).is_err(), "a folder that is not there");
        fs::remove_dir_all(&folder).unwrap();
    }
}
