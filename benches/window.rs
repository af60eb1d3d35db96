//! Whether loading holds the window up: how long its frames take before and while a city of 30 MB is loaded, drawn nowhere, with everything
//! that the window does in a frame but showing it. The target is that none takes more than three times the median.
//!
//! `cargo bench --bench window [-- --buildings N]`

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

mod bench_city;

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use eframe::egui;
use egui_kittest::Harness;
use veduta::app::{Start, Window};

const PATIENCE: Duration = Duration::from_secs(300);
/// Between two frames, as a display has it.
const PAUSE: Duration = Duration::from_millis(16);
const TARGET: f64 = 3.0;

fn main() {
    let mut buildings = bench_city::BENCH_BUILDINGS;
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--buildings", Some(n)) => buildings = n.parse().expect("--buildings wants a number"),
            _ => panic!("{argument} is not --buildings N"),
        }
    }
    let file = bench_city::written(buildings);
    let megabytes = std::fs::metadata(&file).map_or(0.0, |data| data.len() as f64 / 1e6);
    let context = egui::Context::default();
    let start = Start { files: vec![PathBuf::from("builtin:square")], ..Start::default() };
    let window = Window::new(&context, &start).unwrap_or_else(|error| panic!("{error}"));
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1280.0, 800.0))
        .build_ui_state(|ui: &mut egui::Ui, window: &mut Window| window.ui(ui), window);
    until(&mut harness, |window| window.frame.as_ref().is_some_and(|frame| frame.is_final));
    let mut idle = Vec::new();
    for _ in 0..200 {
        idle.push(frame(&mut harness));
    }
    harness.state_mut().open(&[file]);
    let mut loading = Vec::new();
    let started = Instant::now();
    while harness.state().is_loading() && started.elapsed() < PATIENCE {
        loading.push(frame(&mut harness));
    }
    let whole = started.elapsed().as_secs_f64();
    println!("{megabytes:.0} MB, loaded in {whole:.1} s, {} frames meanwhile", loading.len());
    let [idle, loading] = [idle, loading].map(|mut times| {
        times.sort_by(f64::total_cmp);
        [times[times.len() / 2], times[times.len() - 1]]
    });
    println!("{:<10} {:>10} {:>10} {:>8}", "", "median ms", "longest ms", "ratio");
    for (what, [median, longest]) in [("idle", idle), ("loading", loading)] {
        println!("{what:<10} {median:>10.2} {longest:>10.2} {:>8.2}", longest / median);
    }
    let is_met = loading[1] <= TARGET * loading[0];
    println!("no frame over {TARGET} x the median: {}", if is_met { "met" } else { "MISSED" });
}

fn frame(harness: &mut Harness<'_, Window>) -> f64 {
    std::thread::sleep(PAUSE);
    let started = Instant::now();
    harness.step();
    started.elapsed().as_secs_f64() * 1e3
}

fn until(harness: &mut Harness<'_, Window>, holds: impl Fn(&Window) -> bool) {
    let started = Instant::now();
    while !holds(harness.state()) {
        assert!(started.elapsed() < PATIENCE, "waited in vain");
        frame(harness);
    }
}
