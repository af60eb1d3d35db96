//! The progress of loading.

use std::path::Path;

/// The stage of loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Bytes come from the disk, and are decompressed.
    Read,
    /// Text becomes objects and polygons.
    Parse,
    /// Polygons become triangles, tiles and planes.
    Build,
}

impl Stage {
    /// As it stands in statistics and on the progress bar.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Parse => "parse",
            Self::Build => "build",
        }
    }
}

/// Is told how far loading got; a progress bar, or nothing ([`Quiet`]).
pub trait Progress: Sync {
    /// `file` (0-based) of `files` entered `stage`; for [`Stage::Build`] `file == files`.
    fn enter(&self, stage: Stage, file: usize, files: usize, path: &Path);

    /// Whether the city is not wanted any more: asked before each stage.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// No progress bar.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Progress for Quiet {
    fn enter(&self, _: Stage, _: usize, _: usize, _: &Path) {}
}
