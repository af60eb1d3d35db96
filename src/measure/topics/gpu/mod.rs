//! The probe of a graphics adapter: the hard cases whose answers depend on it, pictures against stored references, and frames in turn.
//!
//! ```text
//! check (checks/NAME.rs) ──────────┐
//! scenes/NAME.toml, references/ ───┼─ probe ─> Report ─ report ──> gpu.json
//! views ─ frames ──────────────────┘                  └ markdown ─> gpu.md
//! ```
//!
//! A probe ends within its limit: parts and their items stop at their share of the time (`clock`), what was left out is said, and what
//! does not answer is not waited for (`patience`). One item that fails does not keep the others from being looked at.

pub mod check;
pub mod checks;
pub mod cities;
pub mod clock;
pub mod frames;
pub mod looks;
pub mod markdown;
pub mod numbers;
pub mod panes;
pub mod patience;
pub mod pictures;
pub mod report;
pub mod shapes;
pub mod views;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use crate::{
    city::load::{LoadOptions, Quiet, load},
    gpu::{Gpu, GpuError},
    measure::topics::gpu::{
        check::{Check, Findings},
        checks::CHECKS,
        clock::{Clock, Part},
        frames::Timing,
        patience::Watch,
        pictures::Easel,
        report::{Checked, Compared, Frames, Report},
    },
    render::{
        picture::{RenderError, Studio},
        stats,
    },
    scene::CitySpec,
};

/// Buildings of the city that frames are timed on where none is named: 498,000 triangles.
pub const BENCH_BUILDINGS: u64 = 36_000;

/// The time that an item is waited for beyond its turn.
const PATIENCE: Duration = Duration::from_secs(20);

/// The plan of a probe.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The time that it may take.
    pub limit: Duration,
    /// The names of what is looked at; empty: everything.
    pub only: Vec<String>,
    /// The folder of the scenes, with their references in its folder `references`.
    pub scenes: PathBuf,
    /// City files that frames are timed on; empty: the generator's city.
    pub city: Vec<PathBuf>,
    /// Width and height of the frames, pixels.
    pub size: [u32; 2],
    /// The number of times that all frames are drawn at most.
    pub rounds: usize,
    /// The command line, shell-ready.
    pub command: String,
    /// The day, `2026-11-21`.
    pub date: String,
}

impl Plan {
    fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|wanted| wanted == name)
    }
}

/// The names that [`Plan::only`] may have.
pub fn names() -> Vec<String> {
    let checks = CHECKS.iter().map(|check| check.name.to_owned());
    let pictures = pictures::SCENES.iter().map(|name| (*name).to_owned());
    checks.chain(pictures).chain(frames::names()).collect()
}

/// Looks at everything that the plan wants and the limit allows.
///
/// # Errors
/// An adapter that cannot be opened; what fails later is told in the report.
pub fn probe(plan: &Plan, watch: Watch<'_>) -> Result<Report, GpuError> {
    let clock = Clock::new(plan.limit);
    let gpu = Gpu::open()?;
    let info = &gpu.info;
    let adapter = stats::Adapter {
        name: info.name.clone(),
        backend: format!("{:?}", info.backend).to_lowercase(),
        kind: gpu.kind().to_owned(),
    };
    let mut report = Report {
        command: plan.command.clone(),
        date: plan.date.clone(),
        adapter,
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        snapping: gpu.snapping,
        is_software: gpu.is_software(),
        seconds: [plan.limit.as_secs_f64(), 0.0],
        checks: Vec::new(),
        pictures: Vec::new(),
        frames: None,
        skipped: Vec::new(),
    };
    drop(gpu);
    run_checks(plan, &clock, watch, &mut report);
    compare_pictures(plan, &clock, watch, &mut report);
    time_frames(plan, &clock, watch, &mut report);
    report.seconds[1] = clock.elapsed().as_secs_f64();
    Ok(report)
}

/// Why something is left out that there was no time for.
fn no_time(clock: &Clock) -> String {
    format!("no time was left of {:.0} s", clock.limit().as_secs_f64())
}

fn run_checks(plan: &Plan, clock: &Clock, watch: Watch<'_>, report: &mut Report) {
    let wanted: Vec<&Check> = CHECKS.iter().filter(|check| plan.wants(check.name)).collect();
    for (i, check) in wanted.iter().enumerate() {
        if !clock.has_time(Part::Checks) {
            report.skipped.push([check.name.to_owned(), no_time(clock)]);
            continue;
        }
        watch(check.name, i, wanted.len());
        report.checks.push(checked(check, clock.turn(Part::Checks, wanted.len() - i), report.snapping));
    }
}

/// Runs one check on an adapter that moves corners by so much, pixels; it is to end soon after `until`.
pub fn checked(check: &Check, until: Instant, snapping: f64) -> Checked {
    let start = Instant::now();
    let run = check.run;
    let found = patience::wait(until + PATIENCE, &mut |_, _, _| (), move |_| {
        let mut found = Findings::new(until, snapping);
        let trouble = run(&mut found).err().map(|error| error.to_string());
        Ok((found, trouble))
    });
    let (found, trouble) = found.unwrap_or_else(|trouble| (Findings::new(until, snapping), Some(trouble)));
    Checked { check: *check, found, trouble, seconds: start.elapsed().as_secs_f64() }
}

fn compare_pictures(plan: &Plan, clock: &Clock, watch: Watch<'_>, report: &mut Report) {
    let mut easel = Easel::default();
    let wanted: Vec<&str> = pictures::SCENES.iter().copied().filter(|name| plan.wants(name)).collect();
    for (i, name) in wanted.iter().copied().enumerate() {
        if !clock.has_time(Part::Pictures) {
            report.skipped.push([format!("picture {name}"), no_time(clock)]);
            continue;
        }
        watch(name, i, wanted.len());
        let until = clock.turn(Part::Pictures, wanted.len() - i) + PATIENCE;
        let (mut own, folder) = (std::mem::take(&mut easel), plan.scenes.clone());
        let compared = patience::wait(until, &mut |_, _, _| (), move |_| {
            let compared = pictures::compare(&mut own, &folder, name);
            Ok((own, compared))
        });
        let broken = |trouble| Compared { scene: name.to_owned(), trouble: Some(trouble), ..Compared::default() };
        let (kept, compared) = compared.unwrap_or_else(|trouble| (Easel::default(), broken(trouble)));
        easel = kept;
        report.pictures.push(compared);
    }
}

fn time_frames(plan: &Plan, clock: &Clock, watch: Watch<'_>, report: &mut Report) {
    if !frames::names().iter().any(|name| plan.wants(name)) {
        return;
    }
    if !clock.has_time(Part::Frames) {
        report.skipped.push(["frames".to_owned(), no_time(clock)]);
        return;
    }
    let (own, started) = (plan.clone(), *clock);
    let until = clock.end(Part::Frames) + clock.limit().mul_f64(0.02);
    let timed =
        patience::wait(until, watch, move |watch| timed(&own, &started, watch).map_err(|error| error.to_string()));
    match timed {
        Ok(frames) => report.frames = Some(frames),
        Err(trouble) => report.skipped.push(["frames".to_owned(), trouble]),
    }
}

fn timed(plan: &Plan, clock: &Clock, watch: Watch<'_>) -> Result<Frames, RenderError> {
    watch("the city of the frames", 0, 1);
    let (mut studio, city) = match &plan.city[..] {
        [] => {
            let studio = cities::synthetic(BENCH_BUILDINGS, 1)?;
            (studio, format!("{BENCH_BUILDINGS} buildings of the generator"))
        }
        files => {
            let failed = |error: crate::city::load::LoadError| RenderError::Scene(error.to_string());
            let model = load(files, &LoadOptions::default(), &Quiet).map_err(failed)?;
            let spec = CitySpec { ground: false, ..CitySpec::default() };
            let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            (Studio::new(Gpu::open()?, Arc::new(model), &spec)?, names.join(", "))
        }
    };
    let timing = Timing { size: plan.size, rounds: plan.rounds, clock };
    let is_wanted = |name: &str| plan.wants(name);
    frames::time(&mut studio, city, &timing, &is_wanted, &mut |done, total| watch("frames", done, total))
}

/// Draws all references anew and stores them over those that are there; gives their files.
///
/// # Errors
/// It cannot be drawn or written; an adapter that is no software.
pub fn write_references(scenes: &Path, only: &[String], watch: Watch<'_>) -> Result<Vec<PathBuf>, String> {
    let gpu = Gpu::open().map_err(|error| error.to_string())?;
    if !gpu.is_software() {
        return Err(format!(
            "references come from a software adapter, and {} is none; VEDUTA_ADAPTER=llvmpipe chooses one",
            gpu.name()
        ));
    }
    let adapter = gpu.name();
    drop(gpu);
    let is_wanted = |name: &&&str| only.is_empty() || only.iter().any(|wanted| wanted == **name);
    let wanted: Vec<&&str> = pictures::SCENES.iter().filter(is_wanted).collect();
    let mut easel = Easel::default();
    let mut files = Vec::new();
    for (i, name) in wanted.iter().enumerate() {
        watch(name, i, wanted.len());
        files.push(pictures::write(&mut easel, scenes, name, &adapter)?);
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unlike() {
        let mut names = names();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
