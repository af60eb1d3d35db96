//! `veduta render --sprite`: the depth sprites that lenses are tested by, as files.

use std::{path::PathBuf, str::FromStr};

use crate::{
    cli::{
        failure::{Failure, Outcome},
        output,
    },
    figure::file::{WriteError, write_whole},
    lens::{nearest::did_you_mean, sprite_file},
    render::picture::{RenderError, Studio},
    scene::Scene,
};

/// One `--sprite`: `hall=hall.exr`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpriteRequest {
    /// Name of the lens, or its number.
    pub lens: String,
    /// Where to.
    pub file: PathBuf,
}

impl FromStr for SpriteRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let split = text.split_once('=').filter(|(lens, file)| !lens.is_empty() && !file.is_empty());
        let (lens, file) = split.ok_or("LENS=FILE.exr would be right, with LENS the name of a lens or its number")?;
        let file = PathBuf::from(file);
        match file.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some("exr") => Ok(Self { lens: lens.to_owned(), file }),
            _ => Err(format!("{}: sprites are OpenEXR; .exr would be right", file.display())),
        }
    }
}

impl SpriteRequest {
    /// Which lens of a scene it names: by its name, else by its number.
    pub fn lens(&self, scene: &Scene) -> Outcome<usize> {
        let by_name = scene.lenses.iter().position(|lens| lens.name == self.lens);
        let by_number = || self.lens.parse().ok().filter(|n| *n < scene.lenses.len());
        by_name.or_else(by_number).ok_or_else(|| {
            let hint = did_you_mean(&self.lens, scene.lenses.iter().map(|lens| lens.name.as_str()));
            Failure::usage(format!("--sprite: the scene has no lens \"{}\"{hint}", self.lens))
        })
    }
}

/// Writes the sprite of a lens in the scene's picture.
pub fn write(studio: &mut Studio, scene: &Scene, request: &SpriteRequest) -> Outcome {
    let lens = request.lens(scene)?;
    let file = &request.file;
    let sprite = studio.sprite_of(scene, scene.figure.pixels(), lens).map_err(|error| match error {
        RenderError::Scene(message) => Failure::failed(format!("{}: {message}", file.display())),
        other => Failure::failed(other),
    })?;
    let bytes = sprite_file::bytes(&sprite)
        .map_err(|message| output::unwritten(WriteError::Format { path: file.clone(), message }))?;
    write_whole(file, |out| out.write_all(&bytes)).map_err(output::unwritten)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sprites_name_lens_and_file() {
        let right = SpriteRequest { lens: "old town".into(), file: "a/b=c.EXR".into() };
        assert_eq!("old town=a/b=c.EXR".parse(), Ok(right));
        for wrong in ["hall", "hall=", "=a.exr", "hall=a.png", "hall=exr"] {
            assert!(wrong.parse::<SpriteRequest>().is_err(), "{wrong}");
        }
    }
}
