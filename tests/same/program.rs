//! Whether two builds of Veduta draw the same: the program behind `./dev same REV`.
//!
//! Every scene of the gallery is drawn by both programs with all AOVs, the stored sprites of its lenses and statistics, by both
//! back ends; every sheet with its cells and figures, and each cell with AOVs; every animation with the statistics of each frame.
//! What they wrote is compared byte by byte. Left out are times, the memory of the process, and of PNGs the texts that name the
//! version and the scene's hash. What programs say and their exit codes are compared as well.
//!
//! ```text
//! same REFERENCE_PROGRAM PROGRAM SCENES ANIMATIONS FOLDER [NAME...]
//! ```
//!
//! FOLDER keeps what the reference program wrote, for the next comparison with it.

#![allow(clippy::print_stdout, reason = "what it finds is what it prints")]

mod compare;
mod jobs;
mod shown;

use std::{
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use compare::Difference;
use jobs::Job;

/// What the file of a finished job's words is called; a job without it is run again.
const SAID: &str = "said.txt";

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [reference, program, scenes, animations, folder, names @ ..] = &arguments[..] else {
        return fail("usage: same REFERENCE_PROGRAM PROGRAM SCENES ANIMATIONS FOLDER [NAME...]");
    };
    let jobs = match jobs::of_folders(scenes, animations) {
        Ok(jobs) => jobs,
        Err(problem) => return fail(&problem),
    };
    let names: Vec<String> = names.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if let Some(unknown) = names.iter().find(|name| !jobs.iter().any(|job| job.is_of(name))) {
        return fail(&format!("there is no scene, sheet or animation {unknown}"));
    }
    let (chosen, skipped): (Vec<Job>, Vec<Job>) = jobs
        .into_iter()
        .filter(|job| names.is_empty() || names.iter().any(|name| job.is_of(name)))
        .partition(|job| !job.needs_data || std::env::var_os("VEDUTA_DATA").is_some());
    let mut scenes: Vec<&str> = skipped.iter().map(|job| job.scene.as_str()).collect();
    scenes.dedup();
    for scene in scenes {
        println!("ignored: {scene} (VEDUTA_DATA is not set)");
    }
    let folders = [folder.join("reference"), folder.join("now")];
    // What was drawn before is of another program.
    let _ = std::fs::remove_dir_all(&folders[1]);
    let found = run_all(&chosen, [reference, program], &folders);
    report(&chosen, &found, folder)
}

fn fail(message: &str) -> ExitCode {
    println!("error: {message}");
    ExitCode::from(2)
}

/// What comparing a job found: files compared, and those that differ.
struct Found {
    files: usize,
    differences: Vec<Difference>,
}

/// Runs all jobs by both programs, two jobs at a time, and compares what they wrote.
fn run_all(jobs: &[Job], programs: [&PathBuf; 2], folders: &[PathBuf; 2]) -> Vec<Result<Found, String>> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<Option<Result<Found, String>>>> = Mutex::new(jobs.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((i, job)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, jobs.get(i)?)))
                {
                    let result = run_both(job, programs, folders);
                    let words = match &result {
                        Ok(found) if found.differences.is_empty() => format!("same ({} files)", found.files),
                        Ok(found) => format!("DIFFERENT in {} of {} files", found.differences.len(), found.files),
                        Err(problem) => format!("FAILED: {problem}"),
                    };
                    println!("{}: {words}", job.name);
                    found.lock().expect("no thread panicked")[i] = Some(result);
                }
            });
        }
    });
    found.into_inner().expect("no thread panicked").into_iter().flatten().collect()
}

fn run_both(job: &Job, programs: [&PathBuf; 2], folders: &[PathBuf; 2]) -> Result<Found, String> {
    let [before, now] = [folders[0].join(&job.name), folders[1].join(&job.name)];
    if !before.join(SAID).is_file() {
        run(job, programs[0], &before)?;
    }
    run(job, programs[1], &now)?;
    let compared = compare::folders(&before, &now).map_err(|error| format!("{}: {error}", before.display()))?;
    Ok(Found { files: compared.files, differences: compared.differences })
}

/// Runs a job into a new folder; last it writes what the program said, and its exit code.
fn run(job: &Job, program: &Path, folder: &Path) -> Result<(), String> {
    let _ = std::fs::remove_dir_all(folder);
    let failed = |what: &Path, error: std::io::Error| format!("{}: {error}", what.display());
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    let output = Command::new(program)
        .args(job.arguments(folder))
        .stdin(Stdio::null())
        .output()
        .map_err(|error| failed(program, error))?;
    let code = output.status.code().map_or_else(|| "killed".to_owned(), |code| code.to_string());
    let here = folder.display().to_string();
    let words = String::from_utf8_lossy(&output.stderr).replace(&here, "FOLDER");
    let said = folder.join(SAID);
    std::fs::write(&said, format!("exit code {code}\n{words}")).map_err(|error| failed(&said, error))
}

/// Prints what differs, with pictures of it, and says whether anything did.
fn report(jobs: &[Job], found: &[Result<Found, String>], folder: &Path) -> ExitCode {
    let files: usize = found.iter().flatten().map(|found| found.files).sum();
    let mut different = 0;
    for (job, result) in jobs.iter().zip(found) {
        let found = match result {
            Ok(found) => found,
            Err(problem) => {
                different += 1;
                println!("\n{}: {problem}", job.name);
                continue;
            }
        };
        for difference in &found.differences {
            different += 1;
            println!("\n{}/{}: {}", job.name, difference.file, difference.what);
            let [before, now] =
                ["reference", "now"].map(|side| folder.join(side).join(&job.name).join(&difference.file));
            let picture = folder.join("differences").join(&job.name).join(&difference.file);
            match shown::side_by_side(&before, &now, &picture) {
                Ok(true) => println!("  {}", picture.display()),
                Ok(false) => {}
                Err(problem) => println!("  no picture of it: {problem}"),
            }
        }
    }
    println!("\n{} runs, {files} files compared, {different} different", found.len());
    if different == 0 && files > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
