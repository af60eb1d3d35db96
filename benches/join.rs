//! Side tables joined: a million rows, against reading them.
//!
//! `cargo bench --bench join [-- --pairs N]`: both are timed in turn, and the median of their ratios is given with its 95 % interval. Reading is
//! what the `csv` crate takes to hand over each row as fields that are UTF-8.

#![expect(clippy::print_stdout, reason = "a bench prints its table")]

use std::{io::Write, path::Path, time::Instant};

use veduta::{
    city::{CityModel, CityObject, side_table::Join},
    measure::ratio::Estimate,
};

const ROWS: usize = 1_000_000;
/// The ratio that is asked for.
const TARGET: f64 = 2.0;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let at = arguments.iter().position(|argument| argument == "--pairs");
    let pairs = at.and_then(|at| arguments.get(at + 1)?.parse().ok()).unwrap_or(9);
    let file = std::env::temp_dir().join(format!("veduta-join-{}.csv", std::process::id()));
    write_table(&file);
    let ratios: Vec<[f64; 3]> = (0..pairs)
        .map(|_| {
            let (read, joined) = (read(&file), join(&file));
            [read, joined, joined / read]
        })
        .collect();
    std::fs::remove_file(&file).expect("the temporary file");
    let estimate = |i: usize| {
        let all: Vec<f64> = ratios.iter().map(|row| row[i]).collect();
        Estimate::of(&all).expect("times")
    };
    let [read, joined, ratio] = [0, 1, 2].map(estimate);
    println!("reading {ROWS} rows: {:.0} ms; joining them: {:.0} ms", 1e3 * read.median, 1e3 * joined.median);
    println!("ratio {:.2} ({:.2}..{:.2}), target {TARGET}", ratio.median, ratio.low, ratio.high);
}

/// A register of as many buildings.
fn write_table(file: &Path) {
    let mut out = std::io::BufWriter::new(std::fs::File::create(file).expect("a temporary file"));
    writeln!(out, "id,year,use,height,name").expect("a row");
    for i in 0..ROWS {
        writeln!(out, "b{i},{},use {},{},house {i}", 1500 + i % 500, i % 7, (i % 300) as f64 / 10.0).expect("a row");
    }
}

fn read(file: &Path) -> f64 {
    let start = Instant::now();
    let mut reader = csv::Reader::from_path(file).expect("the table");
    let mut record = csv::StringRecord::new();
    let mut bytes = 0;
    while reader.read_record(&mut record).expect("a row") {
        bytes += record.iter().map(str::len).sum::<usize>();
    }
    assert!(bytes > ROWS);
    start.elapsed().as_secs_f64()
}

fn join(file: &Path) -> f64 {
    let mut model = CityModel::default();
    let kind = model.strings.intern("Building");
    model.objects.extend((0..ROWS).map(|i| CityObject {
        id: format!("b{i}").into(),
        kind,
        class: Default::default(),
        parents: Vec::new(),
        children: Vec::new(),
        attributes: 0..0,
        geometries: 0..0,
    }));
    let start = Instant::now();
    model.join(&Join { file: file.to_owned(), ..Join::default() }).expect("a join");
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(model.joins[0].objects, ROWS as u64);
    seconds
}
