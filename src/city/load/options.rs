//! Permissions of a loader, and where paths inside of files lead.

use std::path::{Path, PathBuf};

/// Permissions of a loader.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Whether paths inside a model (textures, buffers) may leave [`Self::roots`].
    pub allow_outside: bool,
    /// Folders the user named; the folder of each loaded file and `${VEDUTA_DATA}` are added by [`crate::city::load::load`].
    pub roots: Vec<PathBuf>,
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
    /// Follows `reference` as it stands in `file` (relative to its folder), inside the allowed folders.
    pub fn sibling(&self, file: &Path, reference: &str) -> Sibling {
        let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let path = folder.join(reference.replace('\\', "/"));
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
