//! Fields written as NRRD.

use std::io::Write;

use glam::DVec3;

use crate::field::data::{Field, Values};

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// As they are.
    Raw,
    /// Compressed with gzip.
    Gzip,
}

/// The bytes of an NRRD file of a field, all its steps and components.
///
/// Values are bytes where they all are, else F32, little-endian; times are kept where they are evenly spaced.
pub fn write_nrrd(field: &Field, packing: Packing) -> Vec<u8> {
    let is_bytes = field.steps.iter().all(|step| matches!(step.values, Values::U8(_)));
    let mut axes: Vec<[String; 4]> = Vec::new();
    if field.components > 1 {
        axes.push([field.components.to_string(), "vector".into(), "none".into(), "nan".into()]);
    }
    for (size, step) in field.grid.size.iter().zip(field.grid.steps) {
        axes.push([size.to_string(), "domain".into(), vector(step), "nan".into()]);
    }
    let times: Option<Vec<f64>> = field.steps.iter().map(|step| step.time).collect();
    let times = times.unwrap_or_default();
    if field.steps.len() > 1 || !times.is_empty() {
        let spacing = match times[..] {
            [first, second, ..] => second - first,
            [_] => 1.0,
            [] => f64::NAN,
        };
        axes.push([field.steps.len().to_string(), "time".into(), "none".into(), spacing.to_string().to_lowercase()]);
    }
    let column = |of: usize| axes.iter().map(|axis| axis[of].as_str()).collect::<Vec<_>>().join(" ");
    let mut header = format!(
        "NRRD0005\n# made by Veduta\ncontent: {}\ntype: {}\ndimension: {}\nspace dimension: 3\nsizes: {}\nkinds: {}\nspace directions: {}\n",
        one_line(&field.name),
        if is_bytes { "uint8" } else { "float" },
        axes.len(),
        column(0),
        column(1),
        column(2),
    );
    header += &format!("space origin: {}\nendian: little\n", vector(field.grid.origin));
    if let Some(first) = times.first() {
        header += &format!("spacings: {}\n", column(3));
        let mins = axes.iter().map(|axis| if axis[1] == "time" { first.to_string() } else { "nan".into() });
        header += &format!("axis mins: {}\n", mins.collect::<Vec<_>>().join(" "));
    }
    if let Some(unit) = &field.unit {
        header += &format!("sample units: \"{}\"\n", one_line(unit).replace('"', "'"));
    }
    header += if packing == Packing::Gzip { "encoding: gzip\n\n" } else { "encoding: raw\n\n" };
    let mut numbers = Vec::new();
    for step in &field.steps {
        match &step.values {
            Values::U8(bytes) if is_bytes => numbers.extend_from_slice(bytes),
            Values::U8(bytes) => numbers.extend(bytes.iter().flat_map(|value| f32::from(*value).to_le_bytes())),
            Values::F32(values) => numbers.extend(values.iter().flat_map(|value| value.to_le_bytes())),
        }
    }
    let mut file = header.into_bytes();
    match packing {
        Packing::Raw => file.extend(numbers),
        Packing::Gzip => file.extend(gzip(&numbers)),
    }
    file
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    // Writing into memory has no way to fail.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}

/// All digits that a number needs to be read again.
fn vector(v: DVec3) -> String {
    format!("({},{},{})", v.x, v.y, v.z)
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}
