//! Fuzzing: files of every kind that Veduta reads, made wrong in many ways, read, written and drawn; no panic, no hang, bounded memory,
//! messages that can be read, and a result that is sound.
//!
//! `cargo test` runs a short and always equal part. `./dev fuzz SECONDS` (`VEDUTA_FUZZ_SECONDS`) goes on with other
//! numbers each time, as long with one kind as with another; `VEDUTA_FUZZ_SEED` repeats its numbers, `VEDUTA_FUZZ_KINDS` (words that are in the
//! names of kinds, or names) chooses some. An input that fails is left in `target/fuzz/`.

mod kinds;
mod mutate;
#[path = "../studio/mod.rs"]
mod studio;
mod watch;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use kinds::{Kind, Read, Seed, kinds};
use mutate::Pool;
use studio::random_scene::Random;

#[global_allocator]
static MEMORY: watch::Counting = watch::Counting;

/// What a file may make live: so many times its size, and so many bytes.
const MOST_TIMES: usize = 4;
const MOST_BYTES: usize = 512 << 20;
/// What takes longer never ends. A run of `cargo test` is timed for nothing else.
const HANG_S: u64 = 300;
/// Wrong files that are not worth reading, one after the other, at most.
const MOST_TRIES: usize = 100;
/// After so many failures the rest would tell nothing new.
const MAX_FAILURES: usize = 10;

/// Where the last panic was, for the report.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Reads a file, with panics, memory and time judged.
fn judge(read: &mut Read, folder: &Path, name: &str, bytes: &[u8], most_s: Option<f64>) -> Result<bool, String> {
    let (before, started) = (watch::start(), Instant::now());
    let outcome = catch_unwind(AssertUnwindSafe(|| read(folder, name, bytes)));
    let (peak, took) = (watch::peak_over(before), started.elapsed().as_secs_f64());
    match outcome {
        Err(_) => Err(format!("panic: {}", PANIC.lock().unwrap_or_else(PoisonError::into_inner))),
        Ok(Err(unsound)) => Err(unsound),
        Ok(Ok(_)) if peak > MOST_TIMES * bytes.len() + MOST_BYTES => {
            Err(format!("{} MiB for {} bytes", peak >> 20, bytes.len()))
        }
        Ok(Ok(_)) if most_s.is_some_and(|most| took > most) => Err(format!("{took:.1} s")),
        Ok(Ok(is_taken)) => Ok(is_taken),
    }
}

/// Ends the process when one file takes too long; the file is in the folder.
fn watch_for_hangs(finished: Arc<AtomicU64>, folder: PathBuf) {
    std::thread::spawn(move || {
        let mut last = (u64::MAX, Instant::now());
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let now = finished.load(Relaxed);
            if now != last.0 {
                last = (now, Instant::now());
            } else if last.1.elapsed().as_secs() > HANG_S {
                std::fs::write(folder.join("HANGS"), format!("file {now}")).ok();
                std::process::abort();
            }
        }
    });
}

fn number_from(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

/// A kind under way.
struct Run {
    kind: Kind,
    pool: Pool,
    /// Files made wrong so far, how many were taken nevertheless, and seconds that all took.
    number: u64,
    taken: u64,
    seconds: f64,
}

impl Run {
    /// Makes the next file wrong and reads it; why it does harm.
    fn next(&mut self, seed: u64, folder: &Path, is_timed: bool) -> Result<(), String> {
        let started = Instant::now();
        let most_s = is_timed.then_some(self.kind.most_s);
        let Seed { name, bytes } = &self.kind.files[(self.number % self.kind.files.len() as u64) as usize];
        let numbers = &mut Random::new(seed, self.number);
        let mut wrong = mutate::mutated(bytes, name, &self.pool, numbers);
        for _ in 0..MOST_TRIES {
            if (self.kind.is_worth)(name, &wrong) {
                break;
            }
            wrong = mutate::mutated(bytes, name, &self.pool, numbers);
        }
        std::fs::write(folder.join(name), &wrong).expect("target/fuzz/ can be written");
        let judged = judge(&mut self.kind.read, folder, name, &wrong, most_s).map_err(|why| {
            let kept = format!("target/fuzz/{seed}-{}-{name}", self.number);
            std::fs::write(&kept, &wrong).expect("target/fuzz/ can be written");
            format!("{kept}: {why}")
        });
        std::fs::write(folder.join(name), bytes).expect("target/fuzz/ can be written");
        self.number += 1;
        self.seconds += started.elapsed().as_secs_f64();
        judged.map(|is_taken| self.taken += u64::from(is_taken))
    }
}

#[test]
fn wrong_files_do_no_harm() {
    let seconds = number_from("VEDUTA_FUZZ_SECONDS");
    let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |d| d.as_secs());
    let seed = number_from("VEDUTA_FUZZ_SEED").unwrap_or(if seconds.is_some() { clock } else { 1 });
    let wanted = std::env::var("VEDUTA_FUZZ_KINDS").unwrap_or_default();
    let folder = PathBuf::from(format!("target/fuzz/now-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("target/fuzz/ can be made");
    let all = kinds();
    let names: Vec<&str> = all.iter().map(|kind| kind.name).collect();
    // A word that is a name means that kind alone.
    let means = |word: &str, name: &str| if names.contains(&word) { word == name } else { name.contains(word) };
    let is_wanted = |kind: &Kind| wanted.is_empty() || wanted.split(',').any(|word| means(word, kind.name));
    let mut runs: Vec<Run> = all
        .into_iter()
        .filter(is_wanted)
        .map(|kind| {
            let mut pool = Pool::default();
            kind.files.iter().for_each(|file| pool.add(&file.name, &file.bytes));
            Run { kind, pool, number: 0, taken: 0, seconds: 0.0 }
        })
        .collect();
    // What files point to lies beside them.
    for file in runs.iter().flat_map(|run| &run.kind.files) {
        std::fs::write(folder.join(&file.name), &file.bytes).expect("target/fuzz/ can be written");
    }
    for Run { kind, .. } in &mut runs {
        for Seed { name, bytes } in kind.files.iter().take(kind.sample as usize) {
            judge(&mut kind.read, &folder, name, bytes, None).unwrap_or_else(|e| panic!("{name} as it is: {e}"));
        }
    }
    std::panic::set_hook(Box::new(|info| {
        *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string().replace('\n', " ");
    }));
    let finished = Arc::new(AtomicU64::new(0));
    watch_for_hangs(finished.clone(), folder.clone());
    let start = Instant::now();
    let mut failures: Vec<String> = Vec::new();
    while failures.len() < MAX_FAILURES {
        let next = match seconds {
            Some(s) if start.elapsed() >= Duration::from_secs(s) => None,
            Some(_) => runs.iter_mut().min_by(|a, b| a.seconds.total_cmp(&b.seconds)),
            None => runs.iter_mut().find(|run| run.number < run.kind.sample),
        };
        let Some(run) = next else { break };
        failures.extend(run.next(seed, &folder, seconds.is_some()).err());
        finished.fetch_add(1, Relaxed);
    }
    drop(std::panic::take_hook());
    std::fs::remove_dir_all(&folder).ok();
    let number: u64 = runs.iter().map(|run| run.number).sum();
    println!("seed {seed}: {number} files in {:.0} s", start.elapsed().as_secs_f64());
    for run in &runs {
        println!("  {} {}, {} of them taken: {:.0} s", run.number, run.kind.name, run.taken, run.seconds);
    }
    assert!(failures.is_empty(), "seed {seed}, {number} files:\n{}", failures.join("\n"));
}
