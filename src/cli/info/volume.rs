//! What is in files of volumes.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::{
    cli::{
        failure::{Failure, Outcome},
        output, report,
        terminal::Paint,
    },
    field::{self, Component, Field, FieldFile},
};

/// Facts about a file of fields.
#[derive(Clone, Debug, Serialize)]
pub struct VolumeFacts {
    /// The file.
    pub file: String,
    /// The name of its format.
    pub format: &'static str,
    /// Its arrays, in its order.
    pub fields: Vec<FieldFacts>,
    /// What was done to make it readable.
    pub warnings: Vec<String>,
}

/// Facts about one array.
#[derive(Clone, Debug, Serialize)]
pub struct FieldFacts {
    /// Its name.
    pub name: String,
    /// Samples along each axis.
    pub size: [usize; 3],
    /// Where the first sample is, as the file has coordinates.
    pub origin: [f64; 3],
    /// From a sample to the next along each axis.
    pub steps: [[f64; 3]; 3],
    /// Numbers of a sample.
    pub components: usize,
    /// Whether all values are whole: they may be labels.
    pub whole_numbers: bool,
    /// Their unit.
    pub unit: Option<String>,
    /// The time of each step, as the file counts it.
    pub times: Vec<Option<f64>>,
    /// The smallest and the largest number of all steps; of vectors of their lengths.
    pub min: Option<f32>,
    /// The largest.
    pub max: Option<f32>,
    /// How many samples have no value, in all steps together.
    pub missing: usize,
}

impl FieldFacts {
    fn new(field: &Field) -> Self {
        let scalars: Vec<_> = (0..field.steps.len()).map(|step| field.scalar(step, Component::Magnitude)).collect();
        let ranges = || scalars.iter().filter_map(|scalars| scalars.range);
        Self {
            name: field.name.clone(),
            size: field.grid.size,
            origin: field.grid.origin.to_array(),
            steps: field.grid.steps.map(|step| step.to_array()),
            components: field.components,
            whole_numbers: field.is_integer,
            unit: field.unit.clone(),
            times: field.steps.iter().map(|step| step.time).collect(),
            min: ranges().map(|[min, _]| min).reduce(f32::min),
            max: ranges().map(|[_, max]| max).reduce(f32::max),
            missing: scalars.iter().map(|scalars| scalars.missing).sum(),
        }
    }
}

impl VolumeFacts {
    fn new(path: &Path, file: &FieldFile) -> Self {
        Self {
            file: path.display().to_string(),
            format: file.format,
            fields: file.fields.iter().map(FieldFacts::new).collect(),
            warnings: file.warnings.clone(),
        }
    }
}

/// Whether these are files of volumes, by their names.
pub fn are_volumes(files: &[PathBuf]) -> bool {
    !files.is_empty() && files.iter().all(|file| field::is_field(file))
}

/// Loads the files and says what is in them.
///
/// # Errors
/// What cannot be read.
pub fn run(files: &[PathBuf], json: bool) -> Outcome {
    let facts = |path: &PathBuf| {
        let file = field::load(path).map_err(|error| Failure::failed(error.to_string()))?;
        Ok(VolumeFacts::new(path, &file))
    };
    let all = files.iter().map(facts).collect::<Outcome<Vec<VolumeFacts>>>()?;
    if json {
        let text = match &all[..] {
            [one] => serde_json::to_string_pretty(one),
            all => serde_json::to_string_pretty(all),
        };
        return output::print(&(text.map_err(Failure::failed)? + "\n"));
    }
    output::print(&report::volumes_text(&all, Paint::for_stdout()))
}
