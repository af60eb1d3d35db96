//! Paths in scene files: what they are relative to, and where they may lead.

use std::path::{Path, PathBuf};

use crate::city::load::LoadOptions;

/// Stands for the folder the environment variable of the same name holds.
const DATA: &str = "${VEDUTA_DATA}";

/// How a scene file's paths are read.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What relative paths are relative to: the scene file's folder. Empty: the current folder.
    pub base: PathBuf,
    /// What `${VEDUTA_DATA}` stands for.
    pub data: Option<PathBuf>,
    /// More folders the user named.
    pub roots: Vec<PathBuf>,
    /// Whether paths may leave `base`, `data` and `roots`.
    pub allow_outside: bool,
    /// Whether the files of `[city]` must be there: for who is about to load them.
    pub must_exist: bool,
}

impl Options {
    /// For a scene file: relative to its folder, `${VEDUTA_DATA}` from the environment.
    pub fn for_file(path: &Path) -> Self {
        let base = path.parent().map(Path::to_owned).unwrap_or_default();
        let data = std::env::var_os("VEDUTA_DATA").filter(|v| !v.is_empty()).map(PathBuf::from);
        Self { base, data, ..Self::default() }
    }

    /// For paths typed by the user: relative to the current folder, and free to lead anywhere.
    pub fn for_command_line() -> Self {
        Self { allow_outside: true, ..Self::for_file(Path::new("")) }
    }

    /// Where a path of the file leads, or why it may not.
    pub fn resolve(&self, written: &str) -> Result<PathBuf, PathProblem> {
        if written.starts_with(crate::city::builtin::PREFIX) {
            return crate::city::builtin::check(written).map(|()| PathBuf::from(written)).map_err(PathProblem::Wrong);
        }
        let at_beginning = written.strip_prefix(DATA);
        if at_beginning.unwrap_or(written).contains("${") {
            return Err(PathProblem::Wrong(format!("only {DATA}, at the beginning, is replaced: \"{written}\"")));
        }
        let path = if let Some(rest) = at_beginning {
            let data = self.data.as_ref().ok_or(PathProblem::NoData)?;
            if !(rest.is_empty() || rest.starts_with('/')) {
                return Err(PathProblem::Wrong(format!("after {DATA} must come a /: \"{written}\"")));
            }
            data.join(rest.trim_start_matches('/'))
        } else {
            self.base.join(written)
        };
        let base = if self.base.as_os_str().is_empty() { Path::new(".") } else { &self.base };
        let roots = self.roots.iter().chain(&self.data).cloned().chain([base.to_owned()]).collect();
        if (LoadOptions { allow_outside: self.allow_outside, roots, ..LoadOptions::default() }).allows(&path) {
            Ok(path)
        } else {
            Err(PathProblem::Wrong(format!(
                "\"{written}\" leads out of the scene's folder ({}); allow it with --allow-outside",
                base.display()
            )))
        }
    }

    /// A path as it is written in a file that is read with these options; the inverse of [`Self::resolve`].
    pub fn written(&self, path: &Path) -> String {
        let shown = |p: &Path| p.to_string_lossy().into_owned();
        if let Some(rest) = self.data.as_ref().and_then(|data| path.strip_prefix(data).ok()) {
            return if rest.as_os_str().is_empty() { DATA.into() } else { format!("{DATA}/{}", shown(rest)) };
        }
        match path.strip_prefix(&self.base) {
            Ok(rest) if !self.base.as_os_str().is_empty() && !rest.as_os_str().is_empty() => shown(rest),
            _ => shown(path),
        }
    }
}

/// Why a path is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathProblem {
    /// It needs `${VEDUTA_DATA}`, which is not set.
    NoData,
    /// Anything else.
    Wrong(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options() -> Options {
        Options {
            base: "a/scenes".into(),
            data: Some("/data".into()),
            roots: vec!["named".into()],
            ..Options::default()
        }
    }

    #[test]
    fn paths_lead_where_they_say() {
        for (written, path) in [
            ("x.json", "a/scenes/x.json"),
            ("sub/../x.json", "a/scenes/sub/../x.json"),
            ("${VEDUTA_DATA}/d/x.json", "/data/d/x.json"),
            ("${VEDUTA_DATA}", "/data/"),
            ("../../named/x.json", "a/scenes/../../named/x.json"),
            ("builtin:town", "builtin:town"),
        ] {
            assert_eq!(options().resolve(written), Ok(PathBuf::from(path)), "{written}");
        }
    }

    #[test]
    fn ways_out_are_refused() {
        for written in
            ["../x.json", "/etc/passwd", "${VEDUTA_DATA}/../x", "${HOME}/x", "${VEDUTA_DATA}x", "builtin:moon"]
        {
            assert!(matches!(options().resolve(written), Err(PathProblem::Wrong(_))), "{written}");
        }
        let free = Options { allow_outside: true, ..options() };
        assert_eq!(free.resolve("/etc/passwd"), Ok("/etc/passwd".into()));
        // What could not be written again is not read.
        for written in ["${VEDUTA_DATA}/a${VEDUTA_DATA}/x", "${VEDUTA_DATA}/x${", "x${VEDUTA_DATA}"] {
            assert!(matches!(free.resolve(written), Err(PathProblem::Wrong(_))), "{written}");
        }
        let without = Options { data: None, ..options() };
        assert_eq!(without.resolve("${VEDUTA_DATA}/x"), Err(PathProblem::NoData));
    }

    #[test]
    fn what_is_written_leads_back() {
        for written in ["x.json", "${VEDUTA_DATA}/d/x.json", "${VEDUTA_DATA}", "builtin:town"] {
            let path = options().resolve(written).unwrap();
            assert_eq!(options().written(&path), written);
        }
    }
}
