//! Files that appear whole or not at all.

use std::{
    collections::BTreeSet,
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Read, Seek, Write},
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
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
    #[error("{}: is no file that can be written; a file name would be right", .0.display())]
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
/// nothing is left beside it. One that is replaced keeps its permissions; through a symbolic link the file is written that it leads to, and
/// pipes and terminals are written to.
///
/// # Errors
/// The file system's; and [`WriteError::NoFile`] where `path` is a folder, a disk or a socket.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
    let mut file = WholeFile::begin(path)?;
    write(&mut file).map_err(|error| WriteError::Io { path: path.to_owned(), error })?;
    file.finish()
}

/// A file that is being written, and appears when it is finished ([`write_whole`]).
pub struct WholeFile {
    path: PathBuf,
    out: Out,
}

/// Where it is written to.
enum Out {
    StandardOutput(BufWriter<io::Stdout>),
    Stream(BufWriter<File>),
    /// A file beside the one it will become.
    Part {
        out: BufWriter<File>,
        part: Part,
        real: PathBuf,
    },
}

impl WholeFile {
    /// Begins to write `path`, or standard output for `-`.
    ///
    /// # Errors
    /// Those of [`write_whole`].
    pub fn begin(path: &Path) -> Result<Self, WriteError> {
        let failed = |error| WriteError::Io { path: path.to_owned(), error };
        let buffered = |file: File| BufWriter::with_capacity(1 << 16, file);
        let out = match target_of(path)? {
            Target::StandardOutput => Out::StandardOutput(BufWriter::with_capacity(1 << 16, io::stdout())),
            Target::Stream => Out::Stream(buffered(OpenOptions::new().write(true).open(path).map_err(failed)?)),
            Target::File(real) => {
                let (part, file) = Part::beside(&real).map_err(failed)?;
                Out::Part { out: buffered(file), part, real }
            }
        };
        Ok(Self { path: path.to_owned(), out })
    }

    fn out(&mut self) -> &mut dyn Write {
        match &mut self.out {
            Out::StandardOutput(out) => out,
            Out::Stream(out) | Out::Part { out, .. } => out,
        }
    }

    /// Puts it where it is to be.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let flushed = self.out().flush();
        let Self { path, out } = self;
        let failed = |error| WriteError::Io { path: path.clone(), error };
        flushed.map_err(failed)?;
        let Out::Part { out, part, real } = out else { return Ok(()) };
        if let Ok(before) = fs::metadata(&real) {
            out.get_ref().set_permissions(before.permissions()).map_err(failed)?;
        }
        drop(out);
        part.into_place(&real).map_err(failed)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out().flush()
    }
}

/// What is put down for a while, beside a file that is made of it; nothing of it is left in the end.
pub struct Spool {
    file: File,
    _part: Part,
}

impl Spool {
    /// An empty one beside `path`; of a stream where the system puts such files.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let target = written_file(path).unwrap_or_else(|| std::env::temp_dir().join("spool"));
        let (part, file) = Part::beside(&target)?;
        Ok(Self { file, _part: part })
    }

    /// The same, from its beginning.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn rewound(mut self) -> io::Result<Self> {
        self.file.rewind()?;
        Ok(self)
    }
}

impl Read for Spool {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Write for Spool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Spool {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Whether a file can be written to `path` as far as that is known before it is: its folder is there, and it names no
/// folder itself. Standard output, `-`, always can.
///
/// # Errors
/// Those of [`write_whole`].
pub fn check_target(path: &Path) -> Result<(), WriteError> {
    target_of(path).map(|_| ())
}

/// The file that `path` would write, its folder without links: what tells whether two paths are one file. `None` for streams, and where
/// nothing can be written.
pub fn written_file(path: &Path) -> Option<PathBuf> {
    let Ok(Target::File(real)) = target_of(path) else { return None };
    let folder = real.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(folder.canonicalize().ok()?.join(real.file_name()?))
}

/// What a path leads to.
enum Target {
    StandardOutput,
    /// A pipe or a terminal: there is nothing to keep.
    Stream,
    /// A file, there or not; no link.
    File(PathBuf),
}

fn target_of(path: &Path) -> Result<Target, WriteError> {
    if path.as_os_str() == "-" {
        return Ok(Target::StandardOutput);
    }
    let no_file = || WriteError::NoFile(path.to_owned());
    let failed = |error| WriteError::Io { path: path.to_owned(), error };
    let mut real = path.to_owned();
    // A link that leads nowhere is followed to where its file would be.
    for _ in 0..MOST_LINKS {
        match fs::metadata(&real) {
            Ok(there) if there.is_file() => return Ok(Target::File(real.canonicalize().map_err(failed)?)),
            Ok(there) if is_stream(&there) => return Ok(Target::Stream),
            Ok(_) => return Err(no_file()),
            Err(_) => {}
        }
        let Ok(next) = fs::read_link(&real) else { break };
        real = real.parent().unwrap_or(Path::new("")).join(next);
    }
    if real.file_name().is_none() {
        return Err(no_file());
    }
    let folder = real.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() && !folder.is_dir() {
        let message = format!("the folder {} does not exist; make it first", folder.display());
        return Err(failed(io::Error::other(message)));
    }
    Ok(Target::File(real))
}

/// Links that lead to links, at most; as Linux counts them.
const MOST_LINKS: usize = 40;

#[cfg(unix)]
fn is_stream(file: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    file.file_type().is_fifo() || file.file_type().is_char_device()
}

#[cfg(not(unix))]
fn is_stream(_: &fs::Metadata) -> bool {
    false
}

/// Files that are being written, to be removed if the program ends before they are.
static PARTS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Folders where no file of a program that was ended is left any more.
static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Files that have been begun.
static BEGUN: AtomicU64 = AtomicU64::new(0);
/// How names begin of files that are being written; the number of the process follows.
const PART: &str = ".veduta-";

fn known(set: &Mutex<BTreeSet<PathBuf>>) -> MutexGuard<'_, BTreeSet<PathBuf>> {
    set.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written; for a program that is asked to end.
pub fn remove_parts() {
    for part in std::mem::take(&mut *known(&PARTS)) {
        let _ = fs::remove_file(part);
    }
}

/// A file beside the one it will become; removed unless it does.
struct Part {
    path: PathBuf,
}

impl Part {
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        let folder = target.parent().unwrap_or(Path::new(""));
        sweep(folder);
        // The number of the process keeps two programs apart that write one file, the other two threads of one.
        let name = format!("{PART}{}-{}.part", std::process::id(), BEGUN.fetch_add(1, Ordering::Relaxed));
        let part = Self { path: folder.join(name) };
        known(&PARTS).insert(part.path.clone());
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&part.path)?;
        Ok((part, file))
    }

    fn into_place(self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if known(&PARTS).remove(&self.path) {
            // Where it has become what it was to become there is none any more.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Removes what programs have left in a folder that were ended while they wrote; once for each folder.
fn sweep(folder: &Path) {
    if !known(&SWEPT).insert(folder.to_owned()) {
        return;
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix(PART)?.strip_suffix(".part")?.split('-').next());
        if number.and_then(|number| number.parse().ok()).is_some_and(|process| !is_running(process)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a process runs; where that cannot be told, it does.
fn is_running(process: u32) -> bool {
    let all = Path::new("/proc");
    process == std::process::id() || !all.join("self").exists() || all.join(process.to_string()).exists()
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

    #[cfg(unix)]
    #[test]
    fn what_is_replaced_keeps_its_permissions_and_links_lead_on() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = std::env::temp_dir().join(format!("veduta-links-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [file, link, far, nowhere] = ["a.txt", "link", "far", "nowhere"].map(|name| folder.join(name));
        fs::write(&file, "first").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("a.txt", &link).unwrap();
        symlink(folder.join("link"), &far).unwrap();
        symlink("later.txt", &nowhere).unwrap();
        for (path, text) in [(&file, "one"), (&link, "two"), (&far, "three")] {
            write_whole(path, |out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
            assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
            assert_eq!(written_file(path), Some(folder.canonicalize().unwrap().join("a.txt")));
        }
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink() && fs::symlink_metadata(&far).unwrap().is_symlink());
        write_whole(&nowhere, |out| out.write_all(b"there")).unwrap();
        assert_eq!(fs::read_to_string(folder.join("later.txt")).unwrap(), "there");
        assert_eq!(written_file(&nowhere), written_file(&folder.join("later.txt")));
        // A device is written to, and stays one.
        write_whole(Path::new("/dev/null"), |out| out.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        symlink("round", folder.join("round")).unwrap();
        assert!(write_whole(&folder.join("round"), |_| Ok(())).is_err() || folder.join("round").is_file());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_a_program_left_that_was_ended_is_removed() {
        let folder = std::env::temp_dir().join(format!("veduta-sweep-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        // No process has the highest number.
        let left = folder.join(format!("{PART}{}-0.part", u32::MAX));
        let own = folder.join(format!("{PART}{}-x.part", std::process::id()));
        let other = folder.join(".veduta-notes.part");
        for file in [&left, &own, &other] {
            fs::write(file, "half").unwrap();
        }
        write_whole(&folder.join("a.txt"), |out| out.write_all(b"whole")).unwrap();
        assert_eq!([&left, &own, &other].map(|file| file.exists()), [!Path::new("/proc/self").exists(), true, true]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_is_half_written_goes_when_it_must() {
        let folder = std::env::temp_dir().join(format!("veduta-parts-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let written = write_whole(&folder.join("a.txt"), |out| {
            out.write_all(b"half")?;
            assert_eq!(fs::read_dir(&folder)?.count(), 1);
            remove_parts();
            assert_eq!(fs::read_dir(&folder)?.count(), 0);
            Ok(())
        });
        assert!(written.is_err() && fs::read_dir(&folder).unwrap().count() == 0);
        fs::remove_dir_all(&folder).unwrap();
    }
}
