//! Permissions of a loader, what is up, and where paths inside of files lead.

use std::{
    collections::HashMap,
    ffi::OsString,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use glam::DVec3;

use crate::city::{change::CityChange, crs::Frames, lifetime::Dating, model::Materials, side_table::Join};

/// Names of the files of a folder by their lower-case spelling; of several the first by name.
type Listing = Arc<HashMap<String, OsString>>;

/// Folders whose files have been listed, so that each is listed once.
#[derive(Clone, Debug, Default)]
pub struct Listings(Arc<Mutex<HashMap<PathBuf, Listing>>>);

/// The axis that points up in files that do not say which does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// z, as exporters of cities write it.
    #[default]
    Z,
    /// y, as modelling programs write it: (x, y, z) is read as (x, −z, y).
    Y,
}

impl Up {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 2] = [("z", Self::Z), ("y", Self::Y)];

    /// A place or a direction of such a file, z up.
    pub fn placed(self, v: DVec3) -> DVec3 {
        match self {
            Self::Z => v,
            Self::Y => DVec3::new(v.x, -v.z, v.y),
        }
    }
}

/// How a file begins that stands for one kept elsewhere by Git LFS.
pub const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Whether bytes that begin a file are those of a pointer; so many as tell it from anything else will do.
pub fn is_lfs_pointer(bytes: &[u8]) -> bool {
    let length = bytes.len().min(LFS_POINTER.len());
    length >= 16 && bytes[..length] == LFS_POINTER[..length]
}

/// Permissions of a loader, and what files leave open.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Whether paths inside a model (textures, buffers) may leave [`Self::roots`].
    pub allow_outside: bool,
    /// Folders the user named; the folder of each loaded file and `${VEDUTA_DATA}` are added by [`crate::city::load::load`].
    pub roots: Vec<PathBuf>,
    /// What is up in OBJ files.
    pub up: Up,
    /// How colours of materials are shown.
    pub materials: Materials,
    /// Side tables whose attributes its objects get.
    pub joins: Vec<Join>,
    /// Attributes that say what became of its objects, and which attributes say when these are there.
    pub changes: (Vec<CityChange>, Dating),
    /// Timetables by which its objects move.
    pub timetables: Vec<PathBuf>,
    /// The metric frames of another city that this one is to be put in, too; one that is open is chosen by the files.
    pub frames: Frames,
    /// Folders in which files were looked for by other spellings.
    pub listings: Listings,
}

/// Where a path that stands inside a model file leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sibling {
    /// A regular file that may be read.
    Found(PathBuf),
    /// Nothing readable there.
    Missing(PathBuf),
    /// It leaves the folders the user named: note [`crate::city::WarningCode::OutsidePath`] and do not open it.
    Outside(PathBuf),
}

impl LoadOptions {
    /// For other data sets beside the city: what became of their objects is asked otherwise, and nothing of them moves.
    pub fn of_others(&self) -> Self {
        Self { changes: Default::default(), timetables: Vec::new(), ..self.clone() }
    }

    /// Follows `reference` as it stands in `file` (relative to its folder), inside the allowed folders. Exporters quote names, escape
    /// blanks, write the path that was there on their machine, and other letter case: where nothing is found as it stands, it is
    /// taken in these ways, in this order.
    pub fn sibling(&self, file: &Path, reference: &str) -> Sibling {
        let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let as_it_stands = self.followed(folder, &reference.replace('\\', "/"));
        if matches!(as_it_stands, Sibling::Found(_)) {
            return as_it_stands;
        }
        let bare = ['"', '\''].iter().find_map(|mark| reference.trim().strip_prefix(*mark)?.strip_suffix(*mark));
        let name = bare.unwrap_or(reference).replace("\\ ", " ").replace('\\', "/");
        let is_absolute = name.starts_with('/') || name.get(1..3) == Some(":/");
        let last = name.rsplit('/').next().filter(|_| is_absolute);
        for name in [Some(&name[..]), last].into_iter().flatten().filter(|name| !name.is_empty()) {
            let ways = [Some(name.to_owned()), self.in_other_case(folder, name)];
            for way in ways.into_iter().flatten() {
                if let found @ Sibling::Found(_) = self.followed(folder, &way) {
                    return found;
                }
            }
        }
        as_it_stands
    }

    /// The name of a file below a folder, where each part of it is there in other letter case.
    fn in_other_case(&self, folder: &Path, name: &str) -> Option<String> {
        let mut at = folder.to_owned();
        let mut parts: Vec<String> = Vec::new();
        for part in name.split('/').filter(|part| !part.is_empty() && *part != ".") {
            if part == ".." || at.join(part).exists() {
                parts.push(part.to_owned());
            } else {
                let found = self.listing(&at)?.get(&part.to_lowercase())?.to_str()?.to_owned();
                parts.push(found);
            }
            at.push(parts.last()?);
        }
        (!name.starts_with('/') && !parts.is_empty()).then(|| parts.join("/"))
    }

    /// The files of an allowed folder.
    fn listing(&self, folder: &Path) -> Option<Listing> {
        if !self.allows(folder) {
            return None;
        }
        let mut listings = self.listings.0.lock().ok()?;
        if let Some(known) = listings.get(folder) {
            return Some(Arc::clone(known));
        }
        let mut names: Vec<OsString> =
            std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.file_name())).collect();
        names.sort_by(|a, b| b.cmp(a));
        let listing: Listing =
            Arc::new(names.into_iter().map(|name| (name.to_string_lossy().to_lowercase(), name)).collect());
        listings.insert(folder.to_owned(), Arc::clone(&listing));
        Some(listing)
    }

    fn followed(&self, folder: &Path, reference: &str) -> Sibling {
        let path = folder.join(reference);
        // An unresolvable folder can only hold missing files, but a path that climbs out is named as such first.
        let climbs = !self.allow_outside && !self.admits(&lexical(&absolute(&path)));
        if climbs {
            return Sibling::Outside(path);
        }
        match path.canonicalize() {
            Ok(real) if !self.allow_outside && !self.admits(&real) => Sibling::Outside(path),
            Ok(real) if real.is_file() => Sibling::Found(path),
            _ => Sibling::Missing(path),
        }
    }

    /// Whether a path may be read: inside the roots by its text and, where it exists, by what it really is.
    pub fn allows(&self, path: &Path) -> bool {
        self.allow_outside
            || (self.admits(&lexical(&absolute(path))) && path.canonicalize().map_or(true, |real| self.admits(&real)))
    }

    /// Whether a normalised absolute path is inside one of the roots.
    fn admits(&self, path: &Path) -> bool {
        self.roots.iter().any(|root| {
            path.starts_with(lexical(&absolute(root))) || root.canonicalize().is_ok_and(|real| path.starts_with(real))
        })
    }
}

pub(super) fn absolute(path: &Path) -> PathBuf {
    // The folder of `scene.toml` is written as nothing, which is no path: it would hold everything.
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// The path without `.` and `..`, by its text alone.
pub(super) fn lexical(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir => {
                out.pop();
            }
            std::path::Component::CurDir => {}
            other => out.push(other),
        }
    }
    out
}
