//! The findings of a probe, as data and as JSON.

use serde::Serialize;
use serde_json::{Value as Json, json};

use crate::{
    measure::{
        ratio::Estimate,
        topics::gpu::{
            check::{Check, Findings},
            pictures::STEPS,
        },
    },
    render::stats,
};

/// The version of the JSON's layout; it grows when a key changes its meaning or goes.
pub const SCHEMA: u32 = 1;

/// All that was found.
#[derive(Clone, Debug)]
pub struct Report {
    /// The command line, shell-ready.
    pub command: String,
    /// The day, `2026-11-21`.
    pub date: String,
    /// On what.
    pub adapter: stats::Adapter,
    /// The driver and its version, as far as it tells.
    pub driver: String,
    /// How far it moves corners of triangles at most, pixels ([`crate::gpu::Gpu::snapping`]).
    pub snapping: f64,
    /// Whether the adapter is a program, not a GPU.
    pub is_software: bool,
    /// The time that the probe was to take at most, and the time it took, seconds.
    pub seconds: [f64; 2],
    /// Hard cases.
    pub checks: Vec<Checked>,
    /// Pictures against their references.
    pub pictures: Vec<Compared>,
    /// Frames in turn.
    pub frames: Option<Frames>,
    /// The items that were left out: what, and why.
    pub skipped: Vec<[String; 2]>,
}

/// One hard case.
#[derive(Clone, Debug)]
pub struct Checked {
    /// Which one.
    pub check: Check,
    /// Its findings.
    pub found: Findings,
    /// Why it could not go on.
    pub trouble: Option<String>,
    /// The time that it took, seconds.
    pub seconds: f64,
}

impl Checked {
    /// Why it fails, in one line.
    pub fn failure(&self) -> Option<String> {
        let Findings { tried, wrong, first, is_cut, .. } = &self.found;
        let Check { name, unit, least, .. } = self.check;
        if let Some(trouble) = &self.trouble {
            return Some(format!("{name}: could not go on after {tried} {unit}: {}", one_line(trouble)));
        }
        if *wrong > 0 {
            let first = one_line(first.as_deref().unwrap_or_default());
            return Some(format!("{name}: {wrong} of {tried} {unit} are wrong, first {first}"));
        }
        let says_nothing = *tried < least && !is_cut;
        says_nothing.then(|| format!("{name}: only {tried} {unit} were looked at; {least} or more say something"))
    }

    /// `holds`, `violated`, `failed`.
    pub fn verdict(&self) -> &'static str {
        match (self.failure(), &self.trouble) {
            (_, Some(_)) => "failed",
            (Some(_), None) => "violated",
            (None, None) => "holds",
        }
    }
}

/// A picture against its reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Compared {
    /// The scene.
    pub scene: String,
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels with a channel off by more than one of 255 steps.
    pub wrong: u64,
    /// The number of them that may be.
    pub allowed: u64,
    /// The largest difference of a channel, steps of 255.
    pub max_steps: u8,
    /// The wrong pixel that is off the most: column and row.
    pub worst: Option<[u32; 2]>,
    /// Why there is no comparison.
    pub trouble: Option<String>,
    /// The time that it took, seconds.
    pub seconds: f64,
}

impl Compared {
    /// Why it fails, in one line.
    pub fn failure(&self) -> Option<String> {
        let Self { scene, pixels, wrong, allowed, max_steps, .. } = self;
        if let Some(trouble) = &self.trouble {
            return Some(format!("{scene}: {}", one_line(trouble)));
        }
        let at = self.worst.map(|[x, y]| format!(", most at {x},{y}")).unwrap_or_default();
        (wrong > allowed).then(|| {
            format!("{scene}: {wrong} of {pixels} pixels are off by more than {STEPS} of 255 ({allowed} may be), by up to {max_steps}{at}")
        })
    }
}

/// Frames that were timed in turn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frames {
    /// The city's files, or how it was made.
    pub city: String,
    /// Triangles that can be drawn.
    pub triangles: u64,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The number of times that all were drawn.
    pub rounds: usize,
    /// Whether time ran out before all rounds.
    pub is_cut: bool,
    /// One for each.
    pub rows: Vec<Timed>,
}

/// The time of a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Timed {
    /// `V1 lens`.
    pub name: String,
    /// The content of the picture.
    pub about: String,
    /// From the scene to the last pixel, milliseconds.
    pub ms: Estimate,
    /// The same against the plain frame of its view, round by round.
    pub ratio: Estimate,
    /// The sum of its passes by the GPU's own clock, once, with its lenses counted, milliseconds; `None` where the GPU has none.
    pub gpu_ms: Option<f64>,
}

impl Report {
    /// One line for each that fails.
    pub fn failures(&self) -> Vec<String> {
        let checks = self.checks.iter().filter_map(Checked::failure);
        checks.chain(self.pictures.iter().filter_map(Compared::failure)).collect()
    }

    /// The number of things that were looked at.
    pub fn count(&self) -> usize {
        self.checks.len() + self.pictures.len()
    }

    /// All of it.
    pub fn json(&self) -> Json {
        let check = |c: &Checked| {
            json!({
                "name": c.check.name, "case": c.check.case, "property": c.check.property, "oracle": c.check.oracle,
                "verdict": c.verdict(), "failure": c.failure(), "tried": c.found.tried, "unit": c.check.unit,
                "wrong": c.found.wrong, "is_cut": c.found.is_cut, "seconds": c.seconds,
            })
        };
        json!({
            "schema": SCHEMA,
            "program": format!("veduta {VERSION}"),
            "profile": PROFILE,
            "command": self.command,
            "date": self.date,
            "adapter": self.adapter,
            "driver": self.driver,
            "snapping_pixels": self.snapping,
            "is_software": self.is_software,
            "limit_seconds": self.seconds[0],
            "seconds": self.seconds[1],
            "failures": self.failures(),
            "checks": self.checks.iter().map(check).collect::<Vec<_>>(),
            "pictures": self.pictures,
            "frames": self.frames,
            "skipped": self.skipped.iter().map(|[what, why]| json!({ "what": what, "why": why })).collect::<Vec<_>>(),
        })
    }
}

/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The build profile of this program: times of a debug build say little.
pub const PROFILE: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::measure::topics::gpu::checks::CHECKS;

    #[test]
    fn who_looked_at_nothing_fails() {
        let mut one =
            Checked { check: CHECKS[0], found: Findings::new(Instant::now(), 0.0), trouble: None, seconds: 0.0 };
        assert_eq!(one.verdict(), "violated", "nothing was looked at");
        one.found.goes_on();
        assert_eq!((one.verdict(), one.failure()), ("holds", None), "time ran out");
        one.found.ask(false, || "a\nb".to_owned());
        assert!(one.failure().unwrap().ends_with("1 of 1 pixels are wrong, first a b"));
        one.trouble = Some("lost".into());
        assert_eq!(one.verdict(), "failed");
    }

    #[test]
    fn pictures_fail_by_their_share_of_wrong_pixels() {
        let mut one = Compared {
            scene: "town".into(),
            pixels: 30_000,
            wrong: 3,
            allowed: 3,
            max_steps: 200,
            ..Compared::default()
        };
        assert_eq!(one.failure(), None);
        one.wrong = 4;
        assert!(one.failure().unwrap().contains("4 of 30000 pixels are off by more than 2 of 255 (3 may be)"));
    }
}
