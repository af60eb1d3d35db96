//! What is read: named arrays over grids, in steps of time.

use std::path::PathBuf;

use crate::field::grid::Grid;

/// Samples, x fastest, then y, then z; the components of a sample are together.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Whole numbers of a byte, as the file has them.
    U8(Vec<u8>),
    /// All else; NaN where a value is missing, never infinite.
    F32(Vec<f32>),
}

/// One step in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its time, as the file counts it.
    pub time: Option<f64>,
    /// One sample of `components` numbers for each sample of the grid.
    pub values: Values,
}

/// One named array of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name in the file, or the file's without extension; no two of a file are the same.
    pub name: String,
    /// Where its samples are.
    pub grid: Grid,
    /// Numbers of a sample, 1 or more.
    pub components: usize,
    /// Whether all steps are whole numbers: they may be labels.
    pub is_integer: bool,
    /// The unit of the values, where the file says it.
    pub unit: Option<String>,
    /// The steps in time, one or more.
    pub steps: Vec<Step>,
}

/// What is in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldFile {
    /// The name of the format, for people.
    pub format: &'static str,
    /// The arrays, in the order of the file; one or more.
    pub fields: Vec<Field>,
    /// What was done to make the file readable, one line each.
    pub warnings: Vec<String>,
    /// Files beside it that were read, too.
    pub beside: Vec<PathBuf>,
}

/// What of a vector is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// The length of the vector; of one component the value itself, with its sign.
    Magnitude,
    /// The component of this number, from 0; missing where there are fewer.
    Index(usize),
}

/// One number for each sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalars {
    /// The numbers, in the order of the grid.
    pub values: Values,
    /// The least and the greatest finite number; none where all are missing.
    pub range: Option<[f32; 2]>,
    /// How many are missing.
    pub missing: usize,
}

impl Values {
    /// How many numbers there are.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number by its index; NaN past the end.
    pub fn get(&self, index: usize) -> f32 {
        match self {
            Self::U8(values) => values.get(index).map_or(f32::NAN, |value| f32::from(*value)),
            Self::F32(values) => values.get(index).copied().unwrap_or(f32::NAN),
        }
    }

    /// Whether there are finite numbers, and all of them are whole.
    pub(super) fn is_whole(&self) -> bool {
        match self {
            Self::U8(_) => true,
            Self::F32(values) => {
                let mut finite = values.iter().filter(|value| value.is_finite()).peekable();
                finite.peek().is_some() && finite.all(|value| value.fract() == 0.0)
            }
        }
    }

    /// All as F32.
    pub(super) fn into_f32(self) -> Vec<f32> {
        match self {
            Self::U8(values) => values.into_iter().map(f32::from).collect(),
            Self::F32(values) => values,
        }
    }
}

impl Field {
    /// One number for each sample of a step; none at all for a step that is not there.
    pub fn scalar(&self, step: usize, component: Component) -> Scalars {
        let Some(step) = self.steps.get(step) else {
            return Scalars { values: Values::F32(Vec::new()), range: None, missing: 0 };
        };
        let components = self.components.max(1);
        let values = match (&step.values, component) {
            (values, Component::Magnitude | Component::Index(0)) if components == 1 => values.clone(),
            (Values::U8(all), Component::Index(c)) if c < components => {
                Values::U8(all.chunks_exact(components).filter_map(|sample| sample.get(c)).copied().collect())
            }
            (Values::U8(all), Component::Magnitude) => {
                Values::F32(all.chunks_exact(components).map(|s| length(s.iter().map(|v| f64::from(*v)))).collect())
            }
            (Values::F32(all), Component::Magnitude) => {
                Values::F32(all.chunks_exact(components).map(|s| length(s.iter().map(|v| f64::from(*v)))).collect())
            }
            (Values::F32(all), Component::Index(c)) => {
                let one = |sample: &[f32]| sample.get(c).copied().unwrap_or(f32::NAN);
                Values::F32(all.chunks_exact(components).map(one).collect())
            }
            (Values::U8(all), Component::Index(_)) => Values::F32(vec![f32::NAN; all.len() / components]),
        };
        let (range, missing) = match &values {
            Values::U8(values) => {
                let ends = values.iter().min().zip(values.iter().max());
                (ends.map(|(min, max)| [f32::from(*min), f32::from(*max)]), 0)
            }
            Values::F32(values) => range_of(values),
        };
        Scalars { values, range, missing }
    }
}

/// The length of a vector; NaN where a component is missing, and where it is too long for F32.
fn length(vector: impl Iterator<Item = f64>) -> f32 {
    let length = vector.map(|v| v * v).sum::<f64>().sqrt() as f32;
    if length.is_finite() { length } else { f32::NAN }
}

fn range_of(values: &[f32]) -> (Option<[f32; 2]>, usize) {
    let (mut min, mut max, mut missing) = (f32::INFINITY, f32::NEG_INFINITY, 0);
    for value in values {
        if value.is_finite() {
            (min, max) = (min.min(*value), max.max(*value));
        } else {
            missing += 1;
        }
    }
    ((missing < values.len()).then_some([min, max]), missing)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn field(components: usize, values: Values) -> Field {
        let size = [values.len() / components, 1, 1];
        Field {
            name: "f".into(),
            grid: Grid::new(size, DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]).unwrap(),
            components,
            is_integer: false,
            unit: None,
            steps: vec![Step { time: None, values }],
        }
    }

    #[test]
    fn vectors_have_components_and_a_length() {
        let vectors = field(2, Values::F32(vec![3.0, 4.0, -1.0, f32::NAN]));
        let lengths = vectors.scalar(0, Component::Magnitude);
        assert_eq!((lengths.values.get(0), lengths.range, lengths.missing), (5.0, Some([5.0, 5.0]), 1));
        let second = vectors.scalar(0, Component::Index(1));
        assert_eq!((second.values.get(0), second.missing), (4.0, 1));
        assert_eq!(vectors.scalar(0, Component::Index(2)).missing, 2, "none there");
        assert!(vectors.scalar(1, Component::Magnitude).values.is_empty(), "no such step");
        let bytes = field(2, Values::U8(vec![3, 4, 6, 8]));
        assert_eq!(bytes.scalar(0, Component::Index(1)).values, Values::U8(vec![4, 8]));
        assert_eq!(bytes.scalar(0, Component::Magnitude).values, Values::F32(vec![5.0, 10.0]));
        assert_eq!(bytes.scalar(0, Component::Index(2)).range, None);
    }

    #[test]
    fn a_scalar_keeps_its_sign_and_its_kind() {
        let scalars = field(1, Values::F32(vec![-3.0, 4.5])).scalar(0, Component::Magnitude);
        assert_eq!((scalars.values.get(0), scalars.range), (-3.0, Some([-3.0, 4.5])));
        let bytes = field(1, Values::U8(vec![7, 2])).scalar(0, Component::Magnitude);
        assert_eq!((bytes.values, bytes.range), (Values::U8(vec![7, 2]), Some([2.0, 7.0])));
    }

    #[test]
    fn whole_numbers_may_be_labels() {
        assert!(Values::F32(vec![1.0, f32::NAN, -2.0]).is_whole());
        assert!(!Values::F32(vec![1.0, 0.5]).is_whole());
        assert!(!Values::F32(vec![f32::NAN]).is_whole(), "nothing is there");
    }
}
