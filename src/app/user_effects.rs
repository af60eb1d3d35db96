//! A user's effect files are read again when they change: their folders are looked at a few times a second, which works on every file system,
//! and costs nothing to speak of for the few files that they are.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

/// The time between two looks at them.
pub const EVERY: Duration = Duration::from_millis(300);

/// When a file was written, and how long it is.
type Stamp = (Option<SystemTime>, u64);

/// Files and folders that are watched.
#[derive(Debug, Default)]
pub struct Watch {
    places: Vec<PathBuf>,
    /// As they were when they were read.
    read: BTreeMap<PathBuf, Stamp>,
    /// As they were at the last look.
    seen: BTreeMap<PathBuf, Stamp>,
}

impl Watch {
    /// Whether there is anything to look at.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Files that were read just now, and folders of such files.
    pub fn add_read(&mut self, places: &[PathBuf]) {
        self.read.extend(places.iter().flat_map(|place| stamps(place)));
        self.add(places);
    }

    /// Files and folders that are yet to be read.
    pub fn add(&mut self, places: &[PathBuf]) {
        for place in places {
            if !self.places.contains(place) {
                self.places.push(place.clone());
            }
        }
    }

    /// Files that are others than when they were read, in order. What is being written is told once it has been left alone for a look.
    pub fn changed(&mut self) -> Vec<PathBuf> {
        let now: BTreeMap<PathBuf, Stamp> = self.places.iter().flat_map(|place| stamps(place)).collect();
        let is_settled = |path: &PathBuf, stamp: &Stamp| self.seen.get(path) == Some(stamp);
        let is_new = |path: &PathBuf, stamp: &Stamp| self.read.get(path) != Some(stamp);
        let all = now.iter().filter(|(path, stamp)| is_settled(path, stamp) && is_new(path, stamp));
        let changed: Vec<(PathBuf, Stamp)> = all.map(|(path, stamp)| (path.clone(), *stamp)).collect();
        self.seen = now;
        self.read.extend(changed.iter().cloned());
        changed.into_iter().map(|(path, _)| path).collect()
    }
}

/// Whether a path is called as effect files are.
pub fn is_effect(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "wgsl")
}

/// The effect files at a place.
fn stamps(place: &Path) -> Vec<(PathBuf, Stamp)> {
    let files = match std::fs::read_dir(place) {
        Ok(entries) => entries.flatten().map(|entry| entry.path()).filter(|path| is_effect(path)).collect(),
        Err(_) => vec![place.to_owned()],
    };
    let stamp = |path: PathBuf| {
        let meta = std::fs::metadata(&path).ok().filter(std::fs::Metadata::is_file)?;
        Some((path, (meta.modified().ok(), meta.len())))
    };
    files.into_iter().filter_map(stamp).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_told_when_it_was_written_and_left_alone() {
        let folder = std::env::temp_dir().join(format!("veduta-watch-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let [a, b, other] = ["a.wgsl", "b.wgsl", "c.txt"].map(|name| folder.join(name));
        std::fs::write(&a, "one").unwrap();
        let mut watch = Watch::default();
        assert!(watch.is_empty());
        watch.add_read(std::slice::from_ref(&folder));
        let looks = |watch: &mut Watch| (0..3).flat_map(|_| watch.changed()).collect::<Vec<_>>();
        assert_eq!(looks(&mut watch), [] as [PathBuf; 0], "it was read");
        std::fs::write(&a, "other").unwrap();
        std::fs::write(&other, "no effect").unwrap();
        assert_eq!(watch.changed(), [] as [PathBuf; 0], "it may still be written");
        assert_eq!(looks(&mut watch), std::slice::from_ref(&a));
        std::fs::write(&b, "new").unwrap();
        std::fs::remove_file(&a).unwrap();
        assert_eq!(looks(&mut watch), std::slice::from_ref(&b));
        // A file of its own that was not read before.
        let lone = folder.join("below");
        std::fs::create_dir_all(&lone).unwrap();
        let lone = lone.join("d.wgsl");
        std::fs::write(&lone, "d").unwrap();
        watch.add(std::slice::from_ref(&lone));
        assert_eq!(looks(&mut watch), [lone]);
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(looks(&mut watch), [] as [PathBuf; 0]);
    }
}
