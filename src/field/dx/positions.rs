//! Where the samples of a field of OpenDX are.

use glam::DVec3;

use crate::field::{
    dx::objects::{Class, Object, Objects, Regular},
    error::FieldError,
    grid::{Grid, checked_size},
    input::Input,
    resample::Resampling,
};

/// Places of samples.
pub enum Positions {
    /// On a grid, or made to be: its samples along each axis in the file, and the way to a regular one.
    Grid { size: [usize; 3], way: Box<Resampling> },
    /// Anywhere.
    Scattered(Vec<DVec3>),
}

/// The places that an object has, for samples at them or, `is_cells`, in the cells between; `counts`: how the cells go through them.
pub fn positions(
    input: &Input<'_>,
    objects: &Objects,
    object: &Object,
    counts: Option<&[usize]>,
    is_cells: bool,
) -> Result<Positions, FieldError> {
    let at = |message: String| input.at(object.at, message);
    if let Class::GridPositions(regular) | Class::RegularArray(regular) = &object.class {
        let grid = regular.grid().map_err(at)?;
        let grid = if is_cells { grid.cells() } else { grid };
        return Ok(Positions::Grid { size: grid.size, way: Box::new(Resampling::regular(grid)) });
    }
    let (points, own_counts) = match &object.class {
        Class::ProductArray(terms) => product(input, objects, object, terms)?,
        _ => (explicit(input, objects, object)?, None),
    };
    let Some(counts) = own_counts
        .as_deref()
        .or(counts)
        .filter(|counts| counts.iter().fold(1_usize, |all, n| all.saturating_mul(*n)) == points.len())
    else {
        return match is_cells {
            true => Err(at("the values are in cells between scattered places; values at places can be read".into())),
            false => Ok(Positions::Scattered(points)),
        };
    };
    let size = size(counts).map_err(at)?;
    let points = turned(size, &points);
    let way = if is_cells { Resampling::of_cells(size, &points) } else { Resampling::of_points(size, points) };
    let size = if is_cells { crate::field::grid::cells_of(size) } else { size };
    Ok(Positions::Grid { size, way: Box::new(way.map_err(at)?) })
}

/// Samples along up to three axes.
fn size(counts: &[usize]) -> Result<[usize; 3], String> {
    let at = |axis: usize| counts.get(axis).copied().unwrap_or(1);
    if counts.is_empty() || counts.len() > 3 {
        return Err(format!("the grid has {} axes; 1 to 3 can be read", counts.len()));
    }
    let size = [at(0), at(1), at(2)];
    checked_size(size)?;
    Ok(size)
}

/// Places, the first axis fastest, that were so with the last.
fn turned(size: [usize; 3], points: &[DVec3]) -> Vec<DVec3> {
    let [nx, ny, nz] = size;
    let index = |i: usize| (i % nx * ny + i / nx % ny) * nz + i / nx / ny;
    (0..nx * ny * nz).map(|i| points.get(index(i)).copied().unwrap_or(DVec3::NAN)).collect()
}

impl Regular {
    fn grid(&self) -> Result<Grid, String> {
        let size = size(&self.counts)?;
        let mut steps = [DVec3::ZERO; 3];
        for (step, delta) in steps.iter_mut().zip(&self.deltas) {
            *step = place(delta);
        }
        let axes = self.counts.len();
        if self.deltas.len() != axes || self.origin.len() > 3 || self.deltas.iter().any(|delta| delta.len() > 3) {
            return Err(format!(
                "the grid has {axes} axes and {} deltas; an origin and as many deltas, each of up to 3 numbers, belong there",
                self.deltas.len()
            ));
        }
        Grid::new(size, place(&self.origin), steps)
    }
}

/// Up to three coordinates.
fn place(numbers: &[f64]) -> DVec3 {
    let at = |axis: usize| numbers.get(axis).copied().unwrap_or(0.0);
    DVec3::new(at(0), at(1), at(2))
}

/// The places of an array, in the order of the file.
fn explicit(input: &Input<'_>, objects: &Objects, object: &Object) -> Result<Vec<DVec3>, FieldError> {
    match &object.class {
        Class::Array(array) if array.components <= 3 => {
            let numbers = objects.numbers(input, object, array)?;
            let step = numbers.kind.bytes();
            let at = |item: usize, axis: usize| match axis < array.components {
                true => numbers.at_byte((item * array.components + axis) * step),
                false => 0.0,
            };
            Ok((0..array.items).map(|i| DVec3::new(at(i, 0), at(i, 1), at(i, 2))).collect())
        }
        Class::RegularArray(Regular { counts, origin, deltas }) => {
            let count = counts.first().copied().unwrap_or(0);
            checked_size([count, 1, 1]).map_err(|message| input.at(object.at, message))?;
            let step = place(deltas.first().map_or(&[], Vec::as_slice));
            Ok((0..count).map(|i| place(origin) + step * i as f64).collect())
        }
        _ => Err(input.at(object.at, "these are no places of 1 to 3 coordinates; an array of such belongs here")),
    }
}

/// The sums of places, and how many places each array has.
fn product(
    input: &Input<'_>,
    objects: &Objects,
    object: &Object,
    terms: &[String],
) -> Result<(Vec<DVec3>, Option<Vec<usize>>), FieldError> {
    let mut sums = vec![DVec3::ZERO];
    let mut counts = Vec::new();
    for key in terms {
        let term = objects.get(key).ok_or_else(|| input.at(object.at, format!("there is no object \"{key}\"")))?;
        let places = explicit(input, objects, term)?;
        counts.push(places.len());
        size(&counts).map_err(|message| input.at(object.at, message))?;
        sums = sums.iter().flat_map(|sum| places.iter().map(|place| *sum + *place)).collect();
    }
    Ok((sums, Some(counts)))
}
