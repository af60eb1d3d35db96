//! How smooth pictures are: arguments that all commands have that draw figures.

use clap::{Args, ValueEnum};

use crate::{
    cli::failure::{Failure, Outcome},
    scene::Scene,
};

/// Samples per pixel at most.
pub const MAX_SAMPLES: i64 = 1024;
/// The word of a [`Quality`] for scenes that say nothing.
const VARIABLE: &str = "VEDUTA_QUALITY";

/// A word for a number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// 1 sample per pixel: quick, hard shadows, jagged edges
    Draft,
    /// 4 samples per pixel
    Interactive,
    /// 16 samples per pixel: smooth edges, soft shadows
    Figure,
    /// 256 samples per pixel: next to no error
    Reference,
}

impl Quality {
    /// Its samples per pixel.
    pub fn samples(self) -> u32 {
        match self {
            Self::Draft => 1,
            Self::Interactive => 4,
            Self::Figure => 16,
            Self::Reference => 256,
        }
    }
}

/// How smooth pictures are to be.
#[derive(Args, Clone, Debug, Default)]
pub struct Smoothness {
    /// Samples per pixel [default: the scene's, else 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES))]
    pub samples: Option<u32>,
    /// Samples per pixel by a word [default: VEDUTA_QUALITY where the scene says nothing]
    #[arg(long, value_enum, conflicts_with = "samples")]
    pub quality: Option<Quality>,
}

impl Smoothness {
    /// Whether the command line says it.
    pub fn is_told(&self) -> bool {
        self.samples.is_some() || self.quality.is_some()
    }

    /// Tells a scene of it.
    ///
    /// # Errors
    /// `VEDUTA_QUALITY` is no such word.
    pub fn put_into(&self, scene: &mut Scene) -> Outcome {
        let told = self.samples.or(self.quality.map(Quality::samples));
        scene.figure.samples = told.or(scene.figure.samples).or(of_variable()?);
        Ok(())
    }
}

fn of_variable() -> Outcome<Option<u32>> {
    let Some(word) = std::env::var_os(VARIABLE).filter(|word| !word.is_empty()) else { return Ok(None) };
    let word = word.to_string_lossy();
    match Quality::from_str(&word, false) {
        Ok(quality) => Ok(Some(quality.samples())),
        Err(_) => Err(Failure::usage(format!(
            "{VARIABLE}=\"{word}\" is no quality; it would be right as draft, interactive, figure or reference"
        ))),
    }
}
