//! What the axes of an NRRD file are: space, components of a sample, or time.

use glam::DVec3;

use crate::field::{
    grid::Grid,
    nrrd::header::{Axis, Header},
    numbers::{Layout, NumberKind},
};

/// Kinds of axes in space.
const SPACE: &[&str] = &["domain", "space"];
/// Kinds of axes that number what belongs to a sample begin so, or have this in them.
const COMPONENTS: &[&str] =
    &["list", "point", "vector", "covariant", "normal", "stub", "scalar", "complex", "quaternion"];
const IN_COMPONENTS: &[&str] = &["-vector", "-color", "-normal", "-gradient", "matrix"];
/// The most components of an axis of which the file says nothing.
const MOST_UNSAID: usize = 4;

/// The axes of a file, each with its place in the header and the numbers between its samples.
pub struct Axes {
    /// Where the samples are.
    pub grid: Grid,
    /// What was taken for granted.
    pub notes: Vec<String>,
    space: Vec<Strided>,
    components: Option<Strided>,
    time: Option<Strided>,
    /// The first time and the time between steps.
    first_time: Option<[f64; 2]>,
}

#[derive(Clone, Copy)]
struct Strided {
    size: usize,
    stride: usize,
}

/// What an axis is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Space,
    Components,
    Time,
}

impl Axes {
    /// The axes of a header. The error says why they cannot be read.
    pub fn new(header: &Header) -> Result<Self, String> {
        let mut notes = Vec::new();
        let roles = roles(&header.axes, &mut notes)?;
        let mut stride = 1_usize;
        let (mut space, mut components, mut time, mut first_time) = (Vec::new(), None, None, None);
        let mut in_space = Vec::new();
        for (axis, role) in header.axes.iter().zip(roles) {
            let strided = Strided { size: axis.size, stride };
            stride = stride.saturating_mul(axis.size);
            match role {
                Role::Space => {
                    space.push(strided);
                    in_space.push(axis);
                }
                Role::Components => components = Some(strided),
                Role::Time => {
                    time = Some(strided);
                    first_time = axis.spacing.map(|spacing| [axis.min.unwrap_or(0.0), spacing]);
                }
            }
        }
        let units: Vec<&str> = in_space.iter().map(|axis| axis.unit.as_str()).filter(|u| !u.is_empty()).collect();
        let units = if header.space_units.is_empty() { units.join(", ") } else { header.space_units.clone() };
        if !units.is_empty() {
            notes.push(format!("lengths are in {}", units.replace('"', "")));
        }
        let grid = grid(header, &in_space)?;
        Ok(Self { grid, notes, space, components, time, first_time })
    }

    /// Samples along each axis of space.
    pub fn size(&self) -> [usize; 3] {
        self.grid.size
    }

    /// Numbers of a sample.
    pub fn components(&self) -> usize {
        self.components.map_or(1, |axis| axis.size)
    }

    /// Steps in time.
    pub fn steps(&self) -> usize {
        self.time.map_or(1, |axis| axis.size)
    }

    /// The time of a step.
    pub fn time(&self, step: usize) -> Option<f64> {
        self.first_time.map(|[first, spacing]| first + spacing * step as f64)
    }

    /// Where the numbers of a step are.
    pub fn layout(&self, kind: NumberKind, step: usize) -> Layout {
        let bytes = |stride: usize| stride.saturating_mul(kind.bytes());
        let stride = |axis: usize| self.space.get(axis).map_or(0, |axis| bytes(axis.stride));
        Layout {
            size: self.grid.size,
            components: self.components(),
            start: self.time.map_or(0, |axis| bytes(axis.stride).saturating_mul(step)),
            strides: [stride(0), stride(1), stride(2)],
            component_stride: self.components.map_or(0, |axis| bytes(axis.stride)),
        }
    }
}

/// What each axis is: by what the file says, else by how many there are.
fn roles(axes: &[Axis], notes: &mut Vec<String>) -> Result<Vec<Role>, String> {
    let said = |axis: &Axis| {
        let kind = axis.kind.as_str();
        let is_components =
            IN_COMPONENTS.iter().any(|k| kind.contains(k)) || COMPONENTS.iter().any(|k| kind.starts_with(k));
        match kind {
            "time" => Some(Role::Time),
            _ if SPACE.contains(&kind) => Some(Role::Space),
            _ if is_components => Some(Role::Components),
            _ if axis.direction.is_some() => Some(Role::Space),
            _ => None,
        }
    };
    let mut roles: Vec<Option<Role>> = axes.iter().map(said).collect();
    let count = |roles: &[Option<Role>], role| roles.iter().filter(|r| **r == Some(role)).count();
    // Outside of space, and no word on what it is: short and first are components, else time.
    for (i, axis) in axes.iter().enumerate() {
        if roles[i].is_none() && axis.is_outside {
            let is_short = axis.size <= MOST_UNSAID && i == 0 && count(&roles, Role::Components) == 0;
            roles[i] = Some(if is_short { Role::Components } else { Role::Time });
        }
    }
    let mut open: Vec<usize> = (0..axes.len()).filter(|i| roles[*i].is_none()).collect();
    while open.len() + count(&roles, Role::Space) > 3 {
        let is_short = |i: usize| i == 0 && axes[0].size <= MOST_UNSAID && count(&roles, Role::Components) == 0;
        let (at, role) = match open.first() {
            Some(0) if is_short(0) => (0, Role::Components),
            Some(_) if count(&roles, Role::Time) == 0 => (open.len() - 1, Role::Time),
            _ => return Err("there are more than three axes in space, and no `kinds` that say what they are".into()),
        };
        let axis = open.remove(at);
        roles[axis] = Some(role);
        let what = if role == Role::Time { "time" } else { "components" };
        notes.push(format!("axis {axis} of {} is taken for {what}; `kinds` would say what it is", axes.len()));
    }
    let roles: Vec<Role> = roles.into_iter().map(|role| role.unwrap_or(Role::Space)).collect();
    let count = |role| roles.iter().filter(|r| **r == role).count();
    match (count(Role::Space), count(Role::Components), count(Role::Time)) {
        (1..=3, 0..=1, 0..=1) => Ok(roles),
        (space, components, time) => Err(format!(
            "there are {space} axes in space, {components} of components and {time} of time; 1 to 3, at most 1 and at most 1 can be read"
        )),
    }
}

fn grid(header: &Header, axes: &[&Axis]) -> Result<Grid, String> {
    let mut size = [1; 3];
    let mut steps = [DVec3::ZERO; 3];
    let mut origin = DVec3::ZERO;
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    for (i, axis) in axes.iter().enumerate().take(3) {
        size[i] = axis.size;
        let intervals = if axis.is_cell { axis.size } else { axis.size.saturating_sub(1) };
        let spread = axis.min.zip(axis.max).map(|(min, max)| (max - min) / intervals.max(1) as f64);
        let spacing = axis.spacing.or(spread).unwrap_or(1.0);
        steps[i] = axis.direction.as_ref().map_or(units[i] * spacing, |direction| in_space(direction));
        if header.origin.is_none() {
            let half = if axis.is_cell { 0.5 * spacing } else { 0.0 };
            origin[i] = axis.min.map_or(0.0, |min| min + half);
        }
    }
    if let Some(own) = &header.origin {
        origin = in_space(own);
    }
    Grid::new(size, origin, steps)
}

/// Up to three coordinates.
fn in_space(numbers: &[f64]) -> DVec3 {
    let at = |axis: usize| numbers.get(axis).copied().unwrap_or(0.0);
    DVec3::new(at(0), at(1), at(2))
}
