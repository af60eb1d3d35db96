//! Raw or tabled numbers with a header of OpenDX's general array importer (`.general`).
//!
//! The header says how many samples there are, how the numbers of several arrays follow each other, and where the samples are.

mod data;
mod header;
mod missing;

use glam::DVec3;

use crate::field::{
    data::{Step, Values},
    error::FieldError,
    general::{
        data::{Column, Data},
        header::{Header, Positions, Variable},
    },
    grid::{Grid, cells_of},
    input::Input,
    numbers::{self, Layout, Meaning, NumberKind},
    output::Output,
    resample::{Resampling, Scattered},
    words::Words,
};

/// The name of the array that has the places of samples.
const LOCATIONS: &str = "locations";

/// Reads a header and the numbers that it describes.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let header = Header::read(input)?;
    if header.variables.iter().all(|variable| variable.name == LOCATIONS) {
        return Err(input.fail("names no array but `locations`; values belong there, too"));
    }
    let beside = match &header.file {
        Some(name) => Some(input.beside(name, true)?),
        None => None,
    };
    let (file, start) = match &beside {
        Some(file) => (file, 0),
        None => (input, header.end),
    };
    let mut data = Data { header: &header, words: Words::from(&file.bytes, start), moved: 0 };
    data.skip_header().map_err(|message| file.at(data.words.at(), message))?;
    let columns = data.columns().map_err(|message| file.at(data.words.at(), message))?;
    if data.moved > 0 {
        let lines = data.moved;
        output
            .warn(format!("{lines} lines do not keep to `layout`; their numbers are taken as white space parts them"));
    }
    let sampling = Sampling::new(&header, &columns).map_err(|message| input.fail(message))?;
    for (variable, columns) in header.variables.iter().zip(&columns) {
        if variable.name == LOCATIONS {
            continue;
        }
        let fail = |message: String| input.fail(format!("\"{}\": {message}", variable.name));
        let steps = sampling.steps(&header, variable, columns, output).map_err(fail)?;
        let grid = sampling.grid(variable.is_cells);
        output.add_steps(variable.name.clone(), grid, variable.components, steps).map_err(fail)?;
    }
    Ok(())
}

/// Where the samples are, and the way to a regular grid.
enum Sampling {
    Grid(Box<OnGrid>),
    Scattered {
        scattered: Scattered,
        /// The places of each step; of one, if all are the same.
        places: Vec<Vec<DVec3>>,
    },
}

struct OnGrid {
    points: Resampling,
    cells: Option<Resampling>,
}

impl Sampling {
    fn new(header: &Header, columns: &[Vec<Column<'_>>]) -> Result<Self, String> {
        let located = header.variables.iter().zip(columns).find(|(variable, _)| variable.name == LOCATIONS);
        if let Some((variable, columns)) = located {
            return Self::located(header, variable, columns);
        }
        let size = header.size();
        let has_cells = header.variables.iter().any(|variable| variable.is_cells);
        let (points, cells) = match &header.positions {
            Positions::None => {
                let grid = Grid::new(size, DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z])?;
                (Resampling::regular(grid), Some(Resampling::regular(grid.cells())))
            }
            Positions::Axes(axes) => {
                let points = Resampling::of_axes(axes.clone())?;
                let middles = |axis: &Vec<f64>| match axis.len() {
                    0 | 1 => axis.clone(),
                    _ => axis.windows(2).map(|ends| ends.iter().sum::<f64>() / 2.0).collect(),
                };
                (points, Some(Resampling::of_axes(axes.each_ref().map(middles))?))
            }
            Positions::Points(points) if header.is_scattered => {
                let numbers =
                    header.variables.iter().map(|v| v.components).max().unwrap_or(1).saturating_mul(header.series);
                let scattered = Scattered::new(points, points.len(), numbers)?;
                return Ok(Self::Scattered { scattered, places: vec![points.clone()] });
            }
            Positions::Points(points) => {
                let cells = if has_cells { Some(Resampling::of_cells(size, points)?) } else { None };
                (Resampling::of_points(size, points.clone())?, cells)
            }
        };
        Ok(Self::Grid(Box::new(OnGrid { points, cells })))
    }

    /// By places that are among the numbers.
    fn located(header: &Header, variable: &Variable, columns: &[Column<'_>]) -> Result<Self, String> {
        if variable.components > 3 {
            return Err(format!("`locations` have {} coordinates; 1 to 3 can be read", variable.components));
        }
        let mut places: Vec<Vec<DVec3>> = Vec::new();
        for column in columns {
            let points = column.places(variable.components);
            if places.first() != Some(&points) {
                places.push(points);
            }
        }
        if places.len() > 1 && places.len() != columns.len() {
            places = columns.iter().map(|column| column.places(variable.components)).collect();
        }
        if !header.is_scattered {
            let points = places.swap_remove(0);
            let size = header.size();
            let points = if header.is_first_fastest { points } else { header.turned(points) };
            let cells = Resampling::of_cells(size, &points).ok();
            return Ok(Self::Grid(Box::new(OnGrid { points: Resampling::of_points(size, points)?, cells })));
        }
        let numbers = header.variables.iter().map(|v| v.components).max().unwrap_or(1).saturating_mul(header.series);
        let scattered = Scattered::new(&places.concat(), header.count(false), numbers)?;
        Ok(Self::Scattered { scattered, places })
    }

    fn grid(&self, is_cells: bool) -> Grid {
        match self {
            Self::Scattered { scattered, .. } => scattered.grid,
            Self::Grid(grid) => grid.way(is_cells).grid,
        }
    }

    fn steps(
        &self,
        header: &Header,
        variable: &Variable,
        columns: &[Column<'_>],
        output: &mut Output,
    ) -> Result<Vec<Step>, String> {
        let note = match self {
            Self::Scattered { scattered, .. } => Some(&scattered.note),
            Self::Grid(grid) => grid.way(variable.is_cells).note.as_ref(),
        };
        if let Some(note) = note {
            output.warn(format!("\"{}\": {note}", variable.name));
        }
        let value_bytes = if note.is_none() && variable.kind == NumberKind::U8 { 1 } else { 4 };
        let missing = missing::stands_for_none(columns, variable.components);
        if let Some(number) = missing {
            let name = &variable.name;
            output.warn(format!("\"{name}\": {number} is far from all other values; it is taken for a missing one"));
        }
        let value_bytes = if missing.is_none() { value_bytes } else { 4 };
        let mut steps = Vec::new();
        for (step, column) in columns.iter().enumerate() {
            output.reserve(self.grid(variable.is_cells).size, variable.components, value_bytes)?;
            let values = column.values(header, variable, missing)?;
            let values = match self {
                Self::Grid(grid) => grid.way(variable.is_cells).values(values, variable.components),
                Self::Scattered { scattered, places } => {
                    let own = places.get(step).or(places.first()).map_or(&[][..], Vec::as_slice);
                    scattered.values(own, &values, variable.components)
                }
            };
            steps.push(Step { time: header.times.map(|[start, delta]| start + delta * step as f64), values });
        }
        Ok(steps)
    }
}

impl OnGrid {
    fn way(&self, is_cells: bool) -> &Resampling {
        self.cells.as_ref().filter(|_| is_cells).unwrap_or(&self.points)
    }
}

impl Header {
    /// Places in the order of grids, that were in that of C's arrays.
    fn turned(&self, points: Vec<DVec3>) -> Vec<DVec3> {
        let [nx, ny, nz] = self.size();
        let index = |i: usize| (i % nx * ny + i / nx % ny) * nz + i / nx / ny;
        (0..nx * ny * nz).map(|i| points.get(index(i)).copied().unwrap_or(DVec3::NAN)).collect()
    }
}

impl Column<'_> {
    /// The values in the order of grids.
    fn values(&self, header: &Header, variable: &Variable, missing: Option<f64>) -> Result<Values, String> {
        let size = if header.is_scattered { [header.count(false), 1, 1] } else { header.size() };
        let size = if variable.is_cells { cells_of(size) } else { size };
        let [nx, ny, nz] = size;
        let stride = self.stride;
        let strides = match header.is_first_fastest {
            true => [stride, stride.saturating_mul(nx), stride.saturating_mul(nx).saturating_mul(ny)],
            false => [stride.saturating_mul(nz).saturating_mul(ny), stride.saturating_mul(nz), stride],
        };
        let layout = Layout {
            size,
            components: variable.components,
            start: self.start,
            strides,
            component_stride: self.component_stride,
        };
        numbers::values(&self.numbers, &layout, &Meaning { missing, ..Meaning::PLAIN })
    }

    /// The places that the numbers are.
    fn places(&self, components: usize) -> Vec<DVec3> {
        let at = |i: usize, axis: usize| match axis < components {
            true => self.numbers.at_byte(self.start + i * self.stride + axis * self.component_stride),
            false => 0.0,
        };
        (0..self.count).map(|i| DVec3::new(at(i, 0), at(i, 1), at(i, 2))).collect()
    }
}

#[cfg(test)]
mod tests;
