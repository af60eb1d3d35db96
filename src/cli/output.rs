//! Where results go: stdout, or a file that is written beside its place and then renamed, so that nobody ever sees
//! half of it.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use crate::cli::{Failure, Outcome};

/// Writes to `path`, or to stdout for `-`, what `write` puts out.
///
/// The file appears when `write` has succeeded; until then, and if it fails, a file that was there stays as it is.
pub fn write(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Outcome {
    if path.as_os_str() == "-" {
        let mut out = BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
        return write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::io("stdout", &error));
    }
    let place = path.display().to_string();
    let beside = Beside::new(path)?;
    let file = File::create(&beside.path).map_err(|error| Failure::io(&place, &error))?;
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::io(&place, &error))?;
    drop(out);
    beside.into_place(path).map_err(|error| Failure::io(&place, &error))
}

/// Writes text to stdout.
pub fn print(text: &str) -> Outcome {
    write(Path::new("-"), |out| out.write_all(text.as_bytes()))
}

/// A file beside the one it will become; removed unless it does.
struct Beside {
    path: PathBuf,
    done: bool,
}

impl Beside {
    fn new(target: &Path) -> Outcome<Self> {
        let Some(name) = target.file_name().filter(|_| !target.is_dir()) else {
            return Err(Failure::usage(format!("{}: is no file name; a file would be right", target.display())));
        };
        let folder = target.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() && !folder.is_dir() {
            return Err(Failure::failed(format!(
                "{}: the folder {} does not exist; make it first",
                target.display(),
                folder.display()
            )));
        }
        // The process id keeps two programs that write one file apart.
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}.part", std::process::id()));
        Ok(Self { path: folder.join(hidden), done: false })
    }

    fn into_place(mut self, target: &Path) -> std::io::Result<()> {
        std::fs::rename(&self.path, target)?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if !self.done {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_what_was_there() {
        let folder = std::env::temp_dir().join(format!("veduta-output-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("a.txt");
        write(&file, |out| out.write_all(b"first")).unwrap();
        let failed = write(&file, |out| {
            out.write_all(b"second")?;
            Err(std::io::Error::other("the disk is full"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read(&file).unwrap(), b"first");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "nothing is left beside it");
        assert!(write(&folder, |_| Ok(())).is_err(), "a folder is no file");
        assert!(write(&folder.join("no/a.txt"), |_| Ok(())).is_err(), "a folder that is not there");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
