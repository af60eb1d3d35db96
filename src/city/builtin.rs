//! The built-in cities, so that there is something to look at without any file: `builtin:old-town`, `builtin:square`, `builtin:town`,
//! `builtin:rooms`.

use std::path::Path;

use crate::city::synth::{SynthOptions, full, write_cityjson};

/// The beginning of the names of built-in cities.
pub const PREFIX: &str = "builtin:";

/// Where a built-in city comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Origin {
    /// A file of `citydata/`, inside the program.
    File(&'static [u8]),
    /// The generator, plain.
    Plain(SynthOptions),
    /// The generator, in full detail.
    Full(SynthOptions),
}

/// The one that shows where none is asked for: a town that grew for six hundred years.
pub const FIRST: &str = "builtin:old-town";

/// Names after the prefix: a town with a history, a hand-made market square, streets and blocks by the generator, and a house with rooms.
const CITIES: &[(&str, Origin)] = &[
    ("old-town", Origin::Full(SynthOptions { buildings: 300, seed: 1 })),
    ("square", Origin::File(include_bytes!("../../citydata/square.city.json"))),
    ("town", Origin::Plain(SynthOptions { buildings: 400, seed: 7 })),
    ("rooms", Origin::File(include_bytes!("../../citydata/rooms.city.json"))),
];

fn find(path: &str) -> Option<Origin> {
    let name = path.strip_prefix(PREFIX)?;
    CITIES.iter().find(|(known, _)| *known == name).map(|(_, origin)| *origin)
}

/// Whether there is such a city; else what there is.
pub fn check(path: &str) -> Result<(), String> {
    let all: Vec<String> = CITIES.iter().map(|(name, _)| format!("{PREFIX}{name}")).collect();
    find(path).map(|_| ()).ok_or_else(|| format!("there is no \"{path}\"; built in: {}", all.join(", ")))
}

/// The CityJSON of a built-in city, if `path` names one.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    match find(path.to_str()?)? {
        Origin::File(bytes) => Some(bytes.to_vec()),
        // Writing to memory does not fail.
        Origin::Plain(options) => {
            let mut bytes = Vec::new();
            write_cityjson(&options, &mut bytes, &mut |_| {}).ok()?;
            Some(bytes)
        }
        Origin::Full(options) => {
            let mut bytes = Vec::new();
            full::write_cityjson(&options, &mut bytes, &mut |_| {}).ok()?;
            Some(bytes)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::load::{load, options::LoadOptions, progress::Quiet};

    #[test]
    fn all_load_and_nothing_else_is_built_in() {
        let least = [("builtin:old-town", 2000), ("builtin:square", 20), ("builtin:town", 400), ("builtin:rooms", 21)];
        for (name, objects) in least {
            let model = load(&[name.into()], &LoadOptions::default(), &Quiet).unwrap();
            assert!(model.objects.len() >= objects && model.warnings.is_empty(), "{name}: {}", model.objects.len());
            assert!(!model.extent().is_empty());
        }
        assert_eq!(read(Path::new("builtin:moon")), None);
        let message =
            "there is no \"builtin:moon\"; built in: builtin:old-town, builtin:square, builtin:town, builtin:rooms";
        assert_eq!(check("builtin:moon"), Err(message.into()));
    }
}
