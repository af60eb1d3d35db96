//! Loading: read + parse + triangulate + BVH in this process, against Python's `json.load` with the collector off.
//!
//! `cargo bench --bench load [-- --pairs N] [FILE...]`: pairs of both are taken in turn, and the median of their ratios
//! is given with its 95 % interval; a target is met when the interval's upper end meets it. Peak memory is that of a
//! fresh process, over what the same process holds before it loads. Without FILE: the bench city, a city of 40,000
//! buildings, and the shared CityJSON files of 1 MB and more where `VEDUTA_DATA` is set.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Instant,
};

use veduta::city::{
    CityModel,
    load::{LoadOptions, LoadStats, Quiet, load_with_stats},
    shown::shown_geometries,
    spatial::SpatialIndex,
};
use veduta::measure::ratio::Estimate;

/// Ratios: the target for files of 1 MB and more, and for peak memory.
const JSON_TARGET: f64 = 2.5;
const MEMORY_TARGET: f64 = 3.0;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    if let [flag, file] = &arguments[..]
        && flag == "--peak"
    {
        return print_peak(Path::new(file));
    }
    let mut pairs = 31;
    if let Some(at) = arguments.iter().position(|a| a == "--pairs") {
        pairs = arguments.get(at + 1).and_then(|n| n.parse().ok()).expect("--pairs wants a number");
        arguments.drain(at..at + 2);
    }
    let mut files: Vec<PathBuf> = arguments.iter().map(PathBuf::from).collect();
    if files.is_empty() {
        files = vec![bench_city::written(bench_city::BENCH_BUILDINGS), bench_city::written(40_000)];
        files.extend(shared_files());
    }
    let mut python = Python::start();
    if python.is_none() {
        println!("python3 is not here: no ratios");
    }
    println!(
        "{:<36} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7}  {:>22}  {:>7}",
        "file", "MB", "tri", "read", "parse", "build", "bvh ms", "ratio to json.load", "memory"
    );
    for file in files {
        measure(&file, pairs, python.as_mut());
    }
}

/// One file: a line of the table.
fn measure(file: &Path, pairs: usize, mut python: Option<&mut Python>) {
    let mut ratios = Vec::new();
    let mut stages: Vec<[f64; 4]> = Vec::new();
    let mut triangles = 0;
    for _ in 0..pairs {
        let start = Instant::now();
        let (model, stats, bvh) = load(file);
        let ours = start.elapsed().as_secs_f64();
        triangles = model.indices.len() / 3;
        drop(model);
        let ms = |d: std::time::Duration| d.as_secs_f64() * 1e3;
        stages.push([ms(stats.read), ms(stats.parse), ms(stats.build), bvh * 1e3]);
        if let Some(python) = python.as_deref_mut() {
            ratios.push(ours / python.seconds(file));
        }
    }
    let stage = |i: usize| estimate(&stages.iter().map(|s| s[i]).collect::<Vec<_>>()).median;
    let ratio = match ratios.is_empty() {
        true => "-".to_owned(),
        false => {
            let Estimate { median, low, high } = estimate(&ratios);
            format!("{median:.2} ({low:.2}..{high:.2}) {}", if high <= JSON_TARGET { "ok" } else { "over" })
        }
    };
    let memory = peak(file);
    println!(
        "{:<36} {:>6.1} {:>8} {:>7.1} {:>7.1} {:>7.1} {:>7.1}  {:>22}  {:>4.2} {}",
        file.file_name().unwrap_or_default().to_string_lossy(),
        std::fs::metadata(file).map_or(0.0, |m| m.len() as f64 / 1e6),
        triangles,
        stage(0),
        stage(1),
        stage(2),
        stage(3),
        ratio,
        memory,
        if memory <= MEMORY_TARGET { "ok" } else { "over" }
    );
}

fn estimate(values: &[f64]) -> Estimate {
    Estimate::of(values).expect("one pair or more, and finite times")
}

fn load(file: &Path) -> (CityModel, LoadStats, f64) {
    let files = [file.to_owned()];
    let (model, stats) = load_with_stats(&files, &LoadOptions::default(), &Quiet).expect("a bench file loads");
    let start = Instant::now();
    let index = SpatialIndex::build(&model, &shown_geometries(&model, None));
    std::hint::black_box(&index);
    (model, stats, start.elapsed().as_secs_f64())
}

/// Peak memory of a fresh process that loads `file`, over the same process idle, as a multiple of geometry + attributes.
fn peak(file: &Path) -> f64 {
    let this = std::env::current_exe().expect("this program knows itself");
    let output = Command::new(this).arg("--peak").arg(file).output().expect("this program starts");
    String::from_utf8_lossy(&output.stdout).trim().parse().unwrap_or(f64::NAN)
}

fn print_peak(file: &Path) {
    let idle = high_water();
    let (model, ..) = load(file);
    let held = model_bytes(&model);
    println!("{}", (high_water() - idle) as f64 / held as f64);
}

/// `VmHWM`, bytes: the largest resident memory of this process so far.
fn high_water() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|n| n.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// Bytes of the triangulated geometry and of the attributes (texts, ids and types included).
fn model_bytes(model: &CityModel) -> u64 {
    fn of<T>(list: &[T]) -> u64 {
        size_of_val(list) as u64
    }
    let geometry = of(&model.vertices) + of(&model.indices) + of(&model.planes) + of(&model.texcoords);
    let parts = of(&model.tiles) + of(&model.geometries) + of(&model.surfaces);
    let ids: u64 = model.objects.iter().map(|object| object.id.len() as u64).sum();
    let texts: u64 = model.strings.iter().map(|text| text.len() as u64).sum();
    geometry + parts + of(&model.attributes) + of(&model.objects) + ids + texts
}

/// Shared CityJSON files of 1 MB and more.
fn shared_files() -> Vec<PathBuf> {
    let Some(root) = std::env::var_os("VEDUTA_DATA").map(PathBuf::from) else { return Vec::new() };
    let mut found = Vec::new();
    for folder in std::fs::read_dir(root).into_iter().flatten().flatten() {
        for file in std::fs::read_dir(folder.path()).into_iter().flatten().flatten() {
            let name = file.file_name().to_string_lossy().into_owned();
            let is_large = file.metadata().is_ok_and(|m| m.len() >= 1_000_000);
            if is_large && (name.ends_with(".json") || name.ends_with(".jsonl")) {
                found.push(file.path());
            }
        }
    }
    found.sort();
    found
}

/// A Python that loads what it is told and says how long it took.
struct Python {
    child: Child,
    answers: BufReader<std::process::ChildStdout>,
}

impl Python {
    fn start() -> Option<Self> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/json_load.py");
        let mut child =
            Command::new("python3").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
        let answers = BufReader::new(child.stdout.take()?);
        Some(Self { child, answers })
    }

    fn seconds(&mut self, file: &Path) -> f64 {
        let stdin = self.child.stdin.as_mut().expect("stdin was asked for");
        writeln!(stdin, "{}", file.display()).expect("python listens");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("python answers");
        line.trim().parse().expect("python answers with seconds")
    }
}

impl Drop for Python {
    fn drop(&mut self) {
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}
