//! Edits that are not saved are kept in a file of the window's own: what a crash or a power cut ends offers them when it opens next.
//!
//! Each window holds a lock while it lives. A file whose lock nobody holds was left behind.

use std::{
    fs::{self, File, TryLockError},
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use crate::{
    app::document::Document,
    figure::{
        file::write_whole,
        scene_file::{self, Options},
    },
    scene::Scene,
};

/// How often edits are kept at most.
const PAUSE: Duration = Duration::from_secs(2);
/// The beginning of the lines that say where the edits are from.
const HEAD: &str = "#: ";

/// Keeps the edits of a window.
#[derive(Debug)]
pub struct Unsaved {
    folder: PathBuf,
    file: PathBuf,
    /// Held as long as the window lives.
    lock: File,
    /// What the file has, where it is there.
    kept: Option<Scene>,
    /// When it was written last.
    written: Option<Instant>,
}

/// Edits that a window left behind.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftBehind {
    /// Where they are.
    pub file: PathBuf,
    /// The scene file that was edited, if there was one.
    pub of: Option<PathBuf>,
    /// When they were kept.
    pub when: SystemTime,
}

impl LeftBehind {
    /// What they are edits of.
    pub fn name(&self) -> String {
        self.of.as_ref().map_or_else(|| "a scene without a file".to_owned(), |file| file.display().to_string())
    }

    /// How long ago they were kept, in words.
    pub fn age(&self) -> String {
        let minutes = self.when.elapsed().unwrap_or_default().as_secs() / 60;
        let of = |count: u64, unit: &str| format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" });
        match minutes {
            0 => "just now".to_owned(),
            1..60 => of(minutes, "minute"),
            60..2880 => of(minutes / 60, "hour"),
            _ => of(minutes / 1440, "day"),
        }
    }

    /// The edits, as a document that has them beyond its file.
    ///
    /// # Errors
    /// What keeps them from being read, and where they stay.
    pub fn read(&self) -> Result<Document, String> {
        let failed = |why: String| format!("{why}; the edits stay in {}", self.file.display());
        let text = fs::read_to_string(&self.file).map_err(|error| failed(error.to_string()))?;
        let base = head(&text).get("folder").map(PathBuf::from).unwrap_or_default();
        let options = Options { base, allow_outside: true, ..Options::default() };
        let scene = scene_file::parse(&text, "the edits", &options).map_err(|error| failed(error.to_string()))?;
        Ok(Document::with_edits(scene, self.of.clone()))
    }

    /// Throws them away.
    pub fn remove(&self) {
        for file in [&self.file, &lock_of(&self.file)] {
            forget(file);
        }
    }
}

impl Unsaved {
    /// Begins to keep edits in a folder; `None` where that cannot be: no reason to disturb anybody.
    pub fn new(folder: PathBuf) -> Option<Self> {
        // Of several windows of a process, too, each has its own.
        let taken = |number: &u32| {
            let file = folder.join(format!("{}-{number}.toml", std::process::id()));
            let lock = File::options().create(true).append(true).open(lock_of(&file)).ok()?;
            lock.try_lock().ok()?;
            Some((file, lock))
        };
        if let Err(error) = fs::create_dir_all(&folder) {
            log::debug!("{}: {error}", folder.display());
            return None;
        }
        let (file, lock) = (0..100).find_map(|number| taken(&number))?;
        Some(Self { folder, file, lock, kept: None, written: None })
    }

    /// What windows that are gone left behind, the latest first.
    pub fn left_behind(&self) -> Vec<LeftBehind> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut found: Vec<LeftBehind> = Vec::new();
        for path in entries.map(|entry| entry.path()).filter(|path| *path != self.file && *path != lock_of(&self.file))
        {
            let is_gone = |lock: &Path| match File::open(lock) {
                Ok(lock) => !matches!(lock.try_lock(), Err(TryLockError::WouldBlock)),
                Err(_) => true,
            };
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("toml") if is_gone(&lock_of(&path)) => {
                    let text = fs::read_to_string(&path).unwrap_or_default();
                    let of = head(&text).get("file").map(PathBuf::from);
                    let when = path.metadata().and_then(|meta| meta.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
                    found.push(LeftBehind { file: path, of, when });
                }
                Some("lock") if !path.with_extension("toml").exists() && is_gone(&path) => forget(&path),
                _ => {}
            }
        }
        found.sort_by_key(|one| std::cmp::Reverse(one.when));
        found
    }

    /// Keeps what the document has beyond its file; says how long to wait before it is asked again, where something is not kept yet.
    pub fn follow(&mut self, document: &Document) -> Option<Duration> {
        if !document.is_changed() {
            self.forget();
            return None;
        }
        if self.kept.as_ref() == Some(document.scene()) {
            return None;
        }
        let waited = self.written.map_or(PAUSE, |written| written.elapsed());
        if waited < PAUSE {
            return Some(PAUSE - waited);
        }
        self.written = Some(Instant::now());
        match write_whole(&self.file, |out| out.write_all(text(document).as_bytes())) {
            Ok(()) => self.kept = Some(document.scene().clone()),
            Err(error) => log::debug!("{error}"),
        }
        Some(PAUSE)
    }

    /// There is nothing to be kept: all is saved, or a person threw it away.
    pub fn forget(&mut self) {
        if self.kept.take().is_some() {
            forget(&self.file);
        }
    }

    /// Whether the file has all that the document has.
    pub fn has(&self, document: &Document) -> bool {
        self.kept.as_ref() == Some(document.scene())
    }
}

impl Drop for Unsaved {
    fn drop(&mut self) {
        // What is kept is left behind: nobody said that it may be lost.
        if self.kept.is_none() {
            let _ = self.lock.unlock();
            forget(&lock_of(&self.file));
        }
    }
}

fn lock_of(file: &Path) -> PathBuf {
    file.with_extension("lock")
}

fn forget(file: &Path) {
    if let Err(error) = fs::remove_file(file) {
        log::debug!("{}: {error}", file.display());
    }
}

/// The scene as a file, with where it is from: paths in it are relative to where the program runs.
fn text(document: &Document) -> String {
    let mut head = toml::Table::new();
    let mut add = |key: &str, path: PathBuf| head.insert(key.to_owned(), path.to_string_lossy().into_owned().into());
    if let Some(file) = document.file().and_then(|file| std::path::absolute(file).ok()) {
        add("file", file);
    }
    if let Ok(folder) = std::env::current_dir() {
        add("folder", folder);
    }
    let head: String = head.to_string().lines().map(|line| format!("{HEAD}{line}\n")).collect();
    let options = Options { allow_outside: true, ..Options::default() };
    let scene = scene_file::to_toml_for(document.scene(), &options);
    format!("# Edits of a Veduta window that are not saved; it offers them when it opens next.\n{head}\n{scene}")
}

/// Where edits are from, by key.
fn head(text: &str) -> std::collections::BTreeMap<String, String> {
    let lines = text.lines().take_while(|line| line.starts_with('#')).filter_map(|line| line.strip_prefix(HEAD));
    let table: toml::Table = lines.map(|line| format!("{line}\n")).collect::<String>().parse().unwrap_or_default();
    table.into_iter().filter_map(|(key, value)| Some((key, value.as_str()?.to_owned()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("veduta-unsaved-{name}-{}", std::process::id()))
    }

    fn edited(file: Option<&Path>) -> Document {
        let mut document = Document::new(Scene::default(), file.map(Path::to_owned));
        document.set("city.files=[\"builtin:square\", \"a \\\"b\\\".obj\"]").expect("a scene");
        document.set("figure.title=\"mine\"").expect("a title");
        document
    }

    #[test]
    fn what_is_not_saved_is_kept_until_it_is() {
        let folder = folder("kept");
        let mut unsaved = Unsaved::new(folder.clone()).expect("a folder");
        let mut document = edited(None);
        assert_eq!(unsaved.follow(&Document::default()), None);
        assert!(!unsaved.file.exists());
        assert!(unsaved.follow(&document).is_some());
        assert!(unsaved.file.exists());
        // Nothing new: nothing to do. Something new: not at once.
        assert_eq!(unsaved.follow(&document), None);
        document.set("figure.title=\"other\"").expect("a title");
        assert!(unsaved.follow(&document).is_some_and(|pause| pause <= PAUSE));
        assert!(!fs::read_to_string(&unsaved.file).expect("the edits").contains("other"));
        unsaved.written = Instant::now().checked_sub(PAUSE);
        unsaved.follow(&document);
        assert!(fs::read_to_string(&unsaved.file).expect("the edits").contains("other"));
        while document.undo().is_some() {}
        unsaved.follow(&document);
        assert!(!unsaved.file.exists());
        drop(unsaved);
        assert_eq!(fs::read_dir(&folder).expect("the folder").count(), 0);
        fs::remove_dir_all(folder).expect("the folder");
    }

    #[test]
    fn what_was_left_behind_comes_back_beyond_its_file() {
        let folder = folder("left");
        fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("it's \"mine\".toml");
        fs::write(&file, "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n").expect("a scene");
        let kept = folder.join("unsaved");
        let (mut gone, next) = (Unsaved::new(kept.clone()).expect("one"), Unsaved::new(kept).expect("another"));
        let document = edited(Some(&file));
        gone.follow(&document);
        // It lives.
        assert_eq!(next.left_behind(), []);
        drop(gone);
        let left = next.left_behind();
        assert_eq!(left.iter().map(|one| one.of.as_deref()).collect::<Vec<_>>(), [Some(&*file)]);
        assert_eq!((left[0].age(), left[0].name()), ("just now".into(), file.display().to_string()));
        let mut again = left[0].read().expect("the edits");
        assert!(again.is_changed() && again.file() == Some(&*file));
        assert_eq!(again.scene().figure.title.as_deref(), Some("mine"));
        let files_in = |folder: PathBuf| [PathBuf::from("builtin:square"), folder.join("a \"b\".obj")];
        assert_eq!(again.scene().city.files, files_in(folder.clone()));
        // Taken back, it is what the file has.
        again.undo();
        assert!(!again.is_changed() && again.scene().city.files == [PathBuf::from("builtin:square")]);
        left[0].remove();
        assert_eq!(next.left_behind(), []);
        // Without a file, paths are those of the folder that the program ran in.
        let mut gone = Unsaved::new(next.folder.clone()).expect("a third");
        gone.follow(&edited(None));
        drop(gone);
        let again = next.left_behind()[0].read().expect("the edits");
        assert_eq!(again.scene().city.files, files_in(std::env::current_dir().expect("a folder")));
        next.left_behind()[0].remove();
        drop(next);
        fs::remove_dir_all(folder).expect("the folder");
    }

    #[test]
    fn edits_that_cannot_be_read_stay() {
        let folder = folder("stay");
        let unsaved = Unsaved::new(folder.clone()).expect("a folder");
        let file = folder.join("1-0.toml");
        fs::write(&file, "veduta = 1\nlens = 3\n").expect("a file");
        let left = unsaved.left_behind();
        let message = left[0].read().expect_err("no scene");
        assert!(
            message.contains("lens") && message.ends_with(&format!("the edits stay in {}", file.display())),
            "{message}"
        );
        assert!(file.exists());
        fs::remove_dir_all(folder).expect("the folder");
    }
}
