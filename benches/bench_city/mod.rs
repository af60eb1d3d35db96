//! The bench city: about 500,000 triangles, the same everywhere; made anew when a bench starts (a fifth of a second).

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use veduta::city::synth::{SynthOptions, write_cityjson};

/// Buildings of the bench city: 498,000 triangles.
pub const BENCH_BUILDINGS: u64 = 36_000;

/// Writes a city of so many buildings below `target/`; gives its path.
pub fn written(buildings: u64) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("bench-{buildings}.city.json"));
    let mut out = BufWriter::new(File::create(&path).expect("the bench city can be written"));
    write_cityjson(&SynthOptions { buildings, seed: 1 }, &mut out, &mut |_| {}).expect("the disk holds the bench city");
    out.flush().expect("the disk holds the bench city");
    path
}
