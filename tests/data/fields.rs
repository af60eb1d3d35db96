//! Every shared volume against a reader that knows nothing but Python's standard library.

use std::{path::Path, process::Command};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;
use veduta::field::{Component, Field, load};

const FILES: &[&str] = &[
    "CO2.general",
    "ROM_ozone.dx",
    "cloudwater.dx",
    "rainwater.dx",
    "temperature.dx",
    "wind.dx",
    "temp_wind.general",
    "frog_tissues.vti",
    "uniform.vtk",
];

pub fn trials() -> Vec<Trial> {
    let trial = |file: &&'static str| {
        let file = *file;
        crate::trial(&format!("fields::{file}"), move |root| compare(&root.join("volumes").join(file)))
    };
    FILES.iter().map(trial).collect()
}

/// What the independent reader says of a file.
fn independent(path: &Path) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent/field_reader.py");
    let output = Command::new("python3").arg(script).arg(path).output().expect("python3 is there");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a line of JSON")
}

fn compare(path: &Path) -> Result<(), Failed> {
    let found = load(path)?;
    let wanted = independent(path);
    let wanted = wanted.as_array().unwrap();
    same("arrays", found.fields.len(), wanted.len())?;
    found.fields.iter().zip(wanted).try_for_each(|(field, wanted)| compare_field(field, wanted))
}

fn compare_field(field: &Field, wanted: &Value) -> Result<(), Failed> {
    same("name", field.name.as_str(), wanted["name"].as_str().unwrap())?;
    same("components", field.components as u64, wanted["components"].as_u64().unwrap())?;
    same("times", field.steps.len() as u64, wanted["times"].as_u64().unwrap())?;
    for axis in 0..3 {
        same("size", field.grid.size[axis] as u64, wanted["size"][axis].as_u64().unwrap())?;
        near("origin", field.grid.origin[axis], &wanted["origin"][axis])?;
        for c in 0..3 {
            near("steps", field.grid.steps[axis][c], &wanted["steps"][axis][c])?;
        }
    }
    for (step, wanted) in [0, field.steps.len() - 1].into_iter().zip(wanted["facts"].as_array().unwrap()) {
        let values = &field.steps[step].values;
        same("count", values.len() as u64, wanted["count"].as_u64().unwrap())?;
        let all = || (0..values.len()).map(|i| f64::from(values.get(i)));
        let finite = || all().filter(|value| value.is_finite());
        near("min", finite().fold(f64::MAX, f64::min), &wanted["min"])?;
        near("max", finite().fold(f64::MIN, f64::max), &wanted["max"])?;
        near("sum", finite().sum(), &wanted["sum"])?;
        let weighted =
            all().enumerate().filter(|(_, value)| value.is_finite()).map(|(i, value)| (i % 251) as f64 * value);
        near("the sum by places", weighted.sum(), &wanted["weighted"])?;
        same("missing", (values.len() - finite().count()) as u64, wanted["missing"].as_u64().unwrap())?;
        for (i, value) in wanted["values"].as_array().unwrap().iter().enumerate() {
            let found = values.get((i * 104_729 + 17) % values.len());
            match value.is_null() {
                true => same("a missing value", found.is_nan(), true)?,
                false => near("a value", f64::from(found), value)?,
            }
        }
        if field.components == 1 {
            let scalars = field.scalar(step, Component::Magnitude);
            let [min, max] = scalars.range.ok_or("no range")?;
            near("the least scalar", f64::from(min), &wanted["min"])?;
            near("the greatest scalar", f64::from(max), &wanted["max"])?;
        }
    }
    Ok(())
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, found: T, wanted: T) -> Result<(), Failed> {
    if found == wanted { Ok(()) } else { Err(format!("{what}: {found:?} is not {wanted:?}").into()) }
}

/// F32 has seven digits; sums of weights round their last.
fn near(what: &str, found: f64, wanted: &Value) -> Result<(), Failed> {
    let wanted = wanted.as_f64().ok_or("no number")?;
    let is_near = (found - wanted).abs() <= 2e-7 * (1.0 + wanted.abs());
    if is_near { Ok(()) } else { Err(format!("{what}: {found} is not {wanted}").into()) }
}
