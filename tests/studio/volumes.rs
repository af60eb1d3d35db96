//! Volumes for tests: fields of formulas, as files.

use std::{
    fs,
    path::{Path, PathBuf},
};

use glam::DVec3;
use veduta::scene::{
    Volume,
    volume::{Transfer, VolumeMode},
};

/// Writes a field as an NRRD file: the value at each sample.
pub fn written(name: &str, size: [usize; 3], value: impl Fn([usize; 3]) -> f32) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}.nrrd", std::process::id()));
    let [w, h, d] = size;
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {w} {h} {d}\nspacings: 1 1 1\nendian: little\nencoding: raw\n\n"
    )
    .into_bytes();
    for z in 0..d {
        for y in 0..h {
            for x in 0..w {
                bytes.extend(value([x, y, z]).to_le_bytes());
            }
        }
    }
    fs::write(&path, bytes).expect("a file");
    path
}

/// A volume of one colour in a box of the city.
pub fn in_box(file: &Path, size: [usize; 3], low: DVec3, high: DVec3, opacity: &[f32]) -> Volume {
    let cells = DVec3::from_array(size.map(|n| (n - 1) as f64));
    Volume {
        name: "field".to_owned(),
        file: file.to_owned(),
        origin: Some(low),
        spacing: Some((high - low) / cells),
        transfer: Transfer {
            colors: vec![[0.2, 0.4, 1.0]; 2],
            opacity: opacity.to_vec(),
            range: Some([0.0, 1.0]),
            ..Transfer::default()
        },
        mode: VolumeMode::Direct,
        thickness: Some(10.0),
        ..Volume::default()
    }
}
