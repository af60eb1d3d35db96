//! The built-in city, so that there is something to look at without any file: `builtin:town`.

use std::path::Path;

use crate::city::synth::{SynthOptions, write_cityjson};

/// What names of built-in cities begin with.
pub const PREFIX: &str = "builtin:";

/// Names after the prefix, and what they are.
pub const NAMES: &[(&str, SynthOptions)] = &[("town", SynthOptions { buildings: 400, seed: 7 })];

fn find(path: &str) -> Option<SynthOptions> {
    let name = path.strip_prefix(PREFIX)?;
    NAMES.iter().find(|(known, _)| *known == name).map(|(_, options)| *options)
}

/// Whether there is such a city; else what there is.
pub fn check(path: &str) -> Result<(), String> {
    let all: Vec<String> = NAMES.iter().map(|(name, _)| format!("{PREFIX}{name}")).collect();
    find(path).map(|_| ()).ok_or_else(|| format!("there is no \"{path}\"; built in: {}", all.join(", ")))
}

/// The CityJSON of a built-in city, if `path` names one.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    let options = find(path.to_str()?)?;
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    write_cityjson(&options, &mut bytes, &mut |_| {}).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::load::{LoadOptions, Quiet, load};

    #[test]
    fn the_town_loads_and_nothing_else_is_built_in() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        assert!(model.objects.len() >= 400 && model.warnings.is_empty());
        assert!(!model.extent().is_empty());
        assert_eq!(read(Path::new("builtin:moon")), None);
        assert_eq!(check("builtin:moon"), Err("there is no \"builtin:moon\"; built in: builtin:town".into()));
    }
}
