//! Side tables joined: a million rows, against reading them.
//!
//! `cargo bench --bench join [-- --pairs N]`: all are timed in turn, and the medians of ratios are given with their 95 % intervals. Reading is
//! what the `csv` crate takes to make a list of typed rows, numbers and texts; and, less than that, to show each row's fields as UTF-8 and keep none.

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
    let ratios: Vec<[f64; 5]> = (0..pairs)
        .map(|_| {
            let (seen, read, joined) = (see(&file), read(&file), join(&file));
            [seen, read, joined, joined / seen, joined / read]
        })
        .collect();
    std::fs::remove_file(&file).expect("the temporary file");
    let estimate = |i: usize| {
        let all: Vec<f64> = ratios.iter().map(|row| row[i]).collect();
        Estimate::of(&all).expect("times")
    };
    let [seen, read, joined, of_seen, of_read] = [0, 1, 2, 3, 4].map(estimate);
    let ms = |estimate: &Estimate| format!("{:.0} ms", 1e3 * estimate.median);
    println!("{ROWS} rows: seen in {}, read in {}, joined in {}", ms(&seen), ms(&read), ms(&joined));
    for (what, of) in [("reading", of_read), ("seeing", of_seen)] {
        println!("joining / {what} {:.2} ({:.2}..{:.2})", of.median, of.low, of.high);
    }
    println!("target: {TARGET} of reading");
}

/// A register of as many buildings.
fn write_table(file: &Path) {
    let mut out = std::io::BufWriter::new(std::fs::File::create(file).expect("a temporary file"));
    writeln!(out, "id,year,use,height,name").expect("a row");
    for i in 0..ROWS {
        writeln!(out, "b{i},{},use {},{},house {i}", 1500 + i % 500, i % 7, (i % 300) as f64 / 10.0).expect("a row");
    }
}

/// A row as a program has it that reads the table.
#[derive(serde::Deserialize)]
struct Row {
    id: String,
    year: i64,
    #[serde(rename = "use")]
    used: String,
    height: f64,
    name: String,
}

fn read(file: &Path) -> f64 {
    let start = Instant::now();
    let mut reader = csv::Reader::from_path(file).expect("the table");
    let rows: Result<Vec<Row>, _> = reader.deserialize().collect();
    let rows = rows.expect("rows");
    let seconds = start.elapsed().as_secs_f64();
    let is_there = |row: &&Row| row.year > 0 && row.height >= 0.0 && row.id.len() + row.used.len() + row.name.len() > 0;
    assert_eq!(rows.iter().filter(is_there).count(), ROWS);
    seconds
}

fn see(file: &Path) -> f64 {
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
