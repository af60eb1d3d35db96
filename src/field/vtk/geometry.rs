//! Where the samples of a legacy VTK file are.

use std::rc::Rc;

use glam::DVec3;

use crate::field::{
    grid::{Grid, cells_of, checked_size},
    numbers::Numbers,
    resample::Resampling,
};

/// The kinds of data sets.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Kind {
    #[default]
    None,
    Points,
    Rectilinear,
    Curved,
}

/// The samples, as the file says it so far.
pub struct Geometry {
    kind: Kind,
    pub size: [usize; 3],
    /// The number of the first sample along each axis.
    pub first: DVec3,
    pub origin: DVec3,
    pub spacing: DVec3,
    /// The coordinates of a rectilinear grid.
    pub axes: [Vec<f64>; 3],
    points: Vec<DVec3>,
    /// The ways to a regular grid that were found, of points and of cells.
    ways: [Option<Rc<Resampling>>; 2],
}

impl Default for Geometry {
    fn default() -> Self {
        Self {
            kind: Kind::None,
            size: [0; 3],
            first: DVec3::ZERO,
            origin: DVec3::ZERO,
            spacing: DVec3::ONE,
            axes: [const { Vec::new() }; 3],
            points: Vec::new(),
            ways: [None, None],
        }
    }
}

impl Geometry {
    /// The beginning of a data set of this kind.
    pub fn new(kind: &str) -> Result<Self, String> {
        let kind = match kind {
            "STRUCTURED_POINTS" => Kind::Points,
            "RECTILINEAR_GRID" => Kind::Rectilinear,
            "STRUCTURED_GRID" => Kind::Curved,
            other => {
                return Err(format!(
                    "the data set is {other}; STRUCTURED_POINTS, RECTILINEAR_GRID and STRUCTURED_GRID can be read, so resample it"
                ));
            }
        };
        Ok(Self { kind, ..Self::default() })
    }

    /// Takes the places of a structured grid.
    pub fn set_points(&mut self, numbers: &Numbers<'_>) {
        let step = numbers.kind.bytes();
        let at = |i: usize| numbers.at_byte(i * step);
        self.points = (0..numbers.len() / 3).map(|i| DVec3::new(at(3 * i), at(3 * i + 1), at(3 * i + 2))).collect();
    }

    /// Samples along each axis, at points or in cells.
    pub fn sample_size(&self, is_cells: bool) -> [usize; 3] {
        if is_cells { cells_of(self.size) } else { self.size }
    }

    /// Says that something has changed.
    pub fn forget_ways(&mut self) {
        self.ways = [None, None];
    }

    /// The way to a regular grid.
    pub fn resampling(&mut self, is_cells: bool) -> Result<Rc<Resampling>, String> {
        if let Some(way) = &self.ways[usize::from(is_cells)] {
            return Ok(way.clone());
        }
        let way = Rc::new(self.found_resampling(is_cells)?);
        self.ways[usize::from(is_cells)] = Some(way.clone());
        Ok(way)
    }

    fn found_resampling(&self, is_cells: bool) -> Result<Resampling, String> {
        checked_size(self.size)?;
        match self.kind {
            Kind::None => Err("there is no DATASET before it".into()),
            Kind::Points => {
                let spacing = self.spacing;
                let steps = [DVec3::X * spacing.x, DVec3::Y * spacing.y, DVec3::Z * spacing.z];
                let grid = Grid::new(self.size, self.origin + self.first * spacing, steps)?;
                Ok(Resampling::regular(if is_cells { grid.cells() } else { grid }))
            }
            Kind::Rectilinear => {
                if self.axes.each_ref().map(Vec::len) != self.size {
                    return Err("the grid has not as many X_, Y_ and Z_COORDINATES as DIMENSIONS".into());
                }
                match is_cells {
                    false => Resampling::of_axes(self.axes.clone()),
                    true => Resampling::of_axes(self.axes.each_ref().map(|axis| middles(axis))),
                }
            }
            Kind::Curved => {
                if self.points.len() != self.size.iter().product::<usize>() {
                    return Err("the grid has not as many POINTS as DIMENSIONS".into());
                }
                match is_cells {
                    false => Resampling::of_points(self.size, self.points.clone()),
                    true => Resampling::of_cells(self.size, &self.points),
                }
            }
        }
    }
}

fn middles(axis: &[f64]) -> Vec<f64> {
    match axis {
        [_] => axis.to_vec(),
        _ => axis.windows(2).map(|ends| ends.iter().sum::<f64>() / 2.0).collect(),
    }
}
