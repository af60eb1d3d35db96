//! NetCDF: classic and NetCDF-4 files, their variables over one to three axes of space and one of time.

use netcdf_reader::{NcFile, NcOpenOptions, NcSliceInfo, NcSliceInfoElem, NcType, NcVariable};

use crate::field::{
    data::{Step, Values},
    error::FieldError,
    input::{Input, most_unpacked},
    output::Output,
    resample::Resampling,
};

/// Axes of space of a variable that is a field; what has one is a profile, or says something of an axis.
const AXES: std::ops::RangeInclusive<usize> = 2..=3;
/// What is written where nothing was, unless a file says otherwise.
const FILL: f32 = 9.969_21e36;

/// Reads all variables that lie on a grid.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let limit = usize::try_from(most_unpacked(input.bytes.len())).unwrap_or(usize::MAX);
    let options = NcOpenOptions { max_chunk_bytes: limit, max_read_bytes: limit, ..NcOpenOptions::default() };
    let damaged = |error: netcdf_reader::Error| input.fail(format!("is damaged NetCDF: {error}"));
    let file = NcFile::from_bytes_with_options(&input.bytes, options).map_err(damaged)?;
    let variables = file.variables().map_err(damaged)?;
    for variable in variables {
        let is_coordinate = variable.is_coordinate_variable();
        let is_bounds = variables.iter().any(|other| text(other, "bounds").as_deref() == Some(variable.name()));
        if is_coordinate || is_bounds || !is_number(variable.dtype()) || variable.ndim() == 0 {
            continue;
        }
        let reader = Reader { file: &file, variables, variable, input };
        match reader.axes() {
            Some(axes) => reader.read(&axes, output)?,
            None => output.warn(format!(
                "the variable \"{}\" has not two or three axes of space; it is left out",
                variable.name()
            )),
        }
    }
    Ok(())
}

fn is_number(kind: &NcType) -> bool {
    kind.is_primitive() && !matches!(kind, NcType::Char | NcType::String)
}

/// An attribute that is text.
fn text(variable: &NcVariable, name: &str) -> Option<String> {
    variable.attribute(name).and_then(|attribute| attribute.value.as_string())
}

struct Reader<'a> {
    file: &'a NcFile,
    variables: &'a [NcVariable],
    variable: &'a NcVariable,
    input: &'a Input<'a>,
}

/// The dimensions of a variable by their numbers.
struct Axes {
    time: Option<usize>,
    /// Those of space, the fastest first.
    space: Vec<usize>,
}

impl Reader<'_> {
    fn fault(&self, message: impl std::fmt::Display) -> FieldError {
        self.input.fail(format!("the variable \"{}\": {message}", self.variable.name()))
    }

    /// The variable that has the coordinates of a dimension.
    fn coordinate(&self, dimension: &str) -> Option<&NcVariable> {
        self.variables.iter().find(|v| v.is_coordinate_variable_for(dimension) && is_number(v.dtype()))
    }

    fn is_time(&self, dimension: &str) -> bool {
        let by_name = ["time", "t", "times"].contains(&dimension.to_lowercase().as_str());
        by_name
            || self.coordinate(dimension).is_some_and(|coordinate| {
                text(coordinate, "units").is_some_and(|units| units.contains(" since "))
                    || text(coordinate, "axis").is_some_and(|axis| axis == "T")
            })
    }

    fn axes(&self) -> Option<Axes> {
        let dimensions = self.variable.dimensions();
        let time = dimensions.iter().position(|dimension| self.is_time(&dimension.name));
        let space: Vec<usize> = (0..dimensions.len()).rev().filter(|axis| Some(*axis) != time).collect();
        AXES.contains(&space.len()).then_some(Axes { time, space })
    }

    fn coordinates(&self, dimension: &str) -> Result<Option<Vec<f64>>, FieldError> {
        let Some(coordinate) = self.coordinate(dimension) else { return Ok(None) };
        let read = self.file.read_variable_unpacked_masked(coordinate.name()).map_err(|e| self.fault(e))?;
        Ok(Some(read.iter().copied().collect()))
    }

    fn read(&self, axes: &Axes, output: &mut Output) -> Result<(), FieldError> {
        let shape = self.variable.shape();
        let count = |axis: usize| shape.get(axis).and_then(|n| usize::try_from(*n).ok()).unwrap_or(0);
        let mut size = [1; 3];
        let mut places = [vec![0.0], vec![0.0], vec![0.0]];
        for (i, axis) in axes.space.iter().enumerate().take(3) {
            size[i] = count(*axis);
        }
        let elements = shape.iter().fold(1_u64, |all, n| all.saturating_mul(*n));
        let bytes = self.variable.dtype().size().unwrap_or(8) as u64;
        if elements.saturating_mul(bytes) > most_unpacked(self.input.bytes.len()) {
            return Err(self.fault("it is far larger than the file; unpack it yourself if you trust it"));
        }
        let times = axes.time.map_or(1, count);
        if times == 0 || size.contains(&0) {
            output.warn(format!("the variable \"{}\" has no values; it is left out", self.variable.name()));
            return Ok(());
        }
        output.reserve_steps(size, 1, 4, times).map_err(|message| self.fault(message))?;
        for (i, axis) in axes.space.iter().enumerate().take(3) {
            let name = self.variable.dimensions().get(*axis).map_or("", |dimension| &dimension.name);
            let own = self.coordinates(name)?.filter(|own| own.len() == size[i]);
            places[i] = own.unwrap_or_else(|| (0..size[i]).map(|n| n as f64).collect());
        }
        let way = match Resampling::of_axes(places) {
            Ok(way) => way,
            Err(message) => {
                output.warn(format!("\"{}\": {message}; they are counted instead", self.variable.name()));
                let counted = size.map(|n| (0..n).map(|i| i as f64).collect());
                Resampling::of_axes(counted).map_err(|message| self.fault(message))?
            }
        };
        if let Some(note) = &way.note {
            output.warn(format!("\"{}\": {note}", self.variable.name()));
        }
        let time_name = axes.time.and_then(|axis| self.variable.dimensions().get(axis)).map_or("", |d| &d.name);
        let moments = self.coordinates(time_name)?.unwrap_or_default();
        let mut steps = Vec::new();
        for step in 0..times {
            if way.note.is_some() {
                output.reserve(way.grid.size, 1, 4).map_err(|message| self.fault(message))?;
            }
            let values = way.values(self.values(axes, step)?, 1);
            steps.push(Step { time: moments.get(step).copied(), values });
        }
        output.add_steps(self.variable.name().to_owned(), way.grid, 1, steps).map_err(|message| self.fault(message))?;
        output.set_unit(&text(self.variable, "units").unwrap_or_default());
        Ok(())
    }

    fn values(&self, axes: &Axes, step: usize) -> Result<Values, FieldError> {
        let selections = (0..self.variable.ndim()).map(|axis| match axes.time == Some(axis) {
            true => NcSliceInfoElem::Index(step as u64),
            false => NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 },
        });
        let selection = NcSliceInfo { selections: selections.collect() };
        let read = self.file.read_variable_slice_unpacked_masked(self.variable.name(), &selection);
        let read = read.map_err(|error| self.fault(error))?;
        let is_byte = |value: &f64| value.fract() == 0.0 && (0.0..=255.0).contains(value);
        if *self.variable.dtype() == NcType::UByte && read.iter().all(is_byte) {
            return Ok(Values::U8(read.iter().map(|value| *value as u8).collect()));
        }
        let finite = |value: &f64| match *value as f32 {
            value if value.is_finite() && value != FILL => value,
            _ => f32::NAN,
        };
        Ok(Values::F32(read.iter().map(finite).collect()))
    }
}

#[cfg(test)]
mod tests;
