//! What of a scene changes over time: the camera along a path, and numbers of its lenses, style, sun and points of interest.

use glam::DVec3;

use crate::{
    time::{Moment, Span},
    view::path::{CameraKey, CameraPath, Curve, Path, PathError, Speed},
};

/// Frames of one animation at most.
pub const MOST_FRAMES: u32 = 1_000_000;

/// An animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// How many pictures, 1..=[`MOST_FRAMES`].
    pub frames: u32,
    /// Pictures per second, > 0: frame i is at i / fps seconds.
    pub fps: f64,
    /// How the camera's keys are followed.
    pub speed: Speed,
    /// Where the camera is when; empty: it stays the scene's.
    pub camera: Vec<CameraKey>,
    /// What else changes.
    pub changes: Vec<Change>,
    /// The moments of the calendar that the first frame and the last one show, and evenly those between; `None`: the scene's.
    pub moments: Option<[Moment; 2]>,
}

/// A value of the scene over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The way to it, as `--set` has it: `lens.a.shape.center`.
    pub path: String,
    /// How its keys are followed, where it is a place.
    pub speed: Speed,
    /// Whether it is a place, which goes along a curve; else each of its numbers goes from key to key by itself.
    pub is_place: bool,
    /// What it is when; of one form.
    pub keys: Vec<ChangeKey>,
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangeKey {
    /// Seconds.
    pub at: f64,
    /// What it is.
    pub value: Numbers,
}

/// A number, or a list of such.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// One.
    One(f64),
    /// Several, `[x, y, z]`, or lists of such.
    List(Vec<Numbers>),
}

impl Animation {
    /// The moment of the calendar that a frame shows, in whole microseconds; `None`: the scene's.
    pub fn moment(&self, frame: u32) -> Option<Moment> {
        let [first, last] = self.moments?;
        let steps = i128::from(self.frames.max(2) - 1);
        let gone = i128::from(last - first) * i128::from(frame) / steps;
        Some(first.shifted(Span::of_micros(gone as i64)))
    }
}

impl Numbers {
    /// All of them, in order.
    pub fn all(&self) -> Vec<f64> {
        match self {
            Self::One(number) => vec![*number],
            Self::List(list) => list.iter().flat_map(Self::all).collect(),
        }
    }

    /// Whether the other has as many, in the same lists.
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::One(_), Self::One(_)) => true,
            (Self::List(a), Self::List(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_like(b)),
            _ => false,
        }
    }

    /// In this form, other numbers; 0 where they end.
    pub fn with(&self, numbers: &mut dyn Iterator<Item = f64>) -> Self {
        match self {
            Self::One(_) => Self::One(numbers.next().unwrap_or(0.0)),
            Self::List(list) => Self::List(list.iter().map(|own| own.with(numbers)).collect()),
        }
    }
}

impl std::fmt::Display for Numbers {
    /// As TOML, read back to the bit.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::One(number) => write!(f, "{number:?}"),
            Self::List(list) => {
                let texts: Vec<String> = list.iter().map(Self::to_string).collect();
                write!(f, "[{}]", texts.join(", "))
            }
        }
    }
}

/// A [`Change`], ready to be asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    form: Numbers,
    along: Along,
}

#[derive(Clone, Debug, PartialEq)]
enum Along {
    Place(Path),
    Numbers(Vec<Curve>),
}

impl Track {
    /// Through the keys of `change`; `None` where there is none, or they are of several forms.
    pub fn new(change: &Change) -> Option<Self> {
        let form = change.keys.first()?.value.clone();
        if change.keys.iter().any(|key| !key.value.is_like(&form)) {
            return None;
        }
        let times: Vec<f64> = change.keys.iter().map(|key| key.at).collect();
        let values: Vec<Vec<f64>> = change.keys.iter().map(|key| key.value.all()).collect();
        let place = |values: &Vec<f64>| <[f64; 3]>::try_from(&values[..]).map(DVec3::from).ok();
        let places: Option<Vec<DVec3>> = values.iter().map(place).collect();
        let along = match places.filter(|_| change.is_place) {
            Some(places) => Along::Place(Path::with_speed(change.speed, &times, &places)),
            None => {
                let curve = |i: usize| Curve::new(&times, &values.iter().map(|v| v[i]).collect::<Vec<_>>());
                Along::Numbers((0..values[0].len()).map(curve).collect())
            }
        };
        Some(Self { form, along })
    }

    /// The value at a time, seconds.
    pub fn at(&self, time: f64) -> Numbers {
        let numbers = match &self.along {
            Along::Place(path) => path.at(time).to_array().to_vec(),
            Along::Numbers(curves) => curves.iter().map(|curve| curve.at(time)).collect(),
        };
        self.form.with(&mut numbers.into_iter())
    }
}

impl Animation {
    /// When a frame is, seconds.
    pub fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / self.fps
    }

    /// The camera's path, if it has one; `near_m`: the near plane, `None` for the default of each moment.
    pub fn camera_path(&self, near_m: Option<f64>) -> Option<Result<CameraPath, PathError>> {
        (!self.camera.is_empty()).then(|| CameraPath::new(&self.camera, self.speed, near_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(numbers: &[f64]) -> Numbers {
        Numbers::List(numbers.iter().map(|n| Numbers::One(*n)).collect())
    }

    fn change(is_place: bool, values: &[Numbers]) -> Change {
        let keys = values.iter().enumerate().map(|(i, value)| ChangeKey { at: i as f64, value: value.clone() });
        Change { path: "lens.0.shape.center".into(), speed: Speed::Keys, is_place, keys: keys.collect() }
    }

    #[test]
    fn values_go_from_key_to_key_in_their_form() {
        let corridor = Numbers::List(vec![list(&[0.0, 1.0, 2.0]), list(&[3.0, 4.0, 5.0])]);
        let moved = Numbers::List(vec![list(&[0.0, 3.0, 2.0]), list(&[3.0, 4.0, 7.0])]);
        let track = Track::new(&change(false, &[corridor.clone(), moved.clone()])).unwrap();
        assert_eq!(track.at(0.0), corridor);
        assert_eq!(track.at(1.0), moved);
        assert_eq!(track.at(0.5).to_string(), "[[0.0, 2.0, 2.0], [3.0, 4.0, 6.0]]");
        let radius = Track::new(&change(false, &[Numbers::One(10.0), Numbers::One(30.0)])).unwrap();
        assert_eq!([-1.0, 0.25, 9.0].map(|t| radius.at(t)), [10.0, 15.0, 30.0].map(Numbers::One));
        assert_eq!(Track::new(&change(false, &[Numbers::One(1.0), list(&[1.0])])), None);
        assert_eq!(Track::new(&change(false, &[])), None);
    }

    #[test]
    fn places_go_along_a_curve_and_numbers_do_not() {
        let corner = [list(&[0.0, 0.0, 0.0]), list(&[10.0, 0.0, 0.0]), list(&[10.0, 10.0, 0.0])];
        let out = |is_place| Track::new(&change(is_place, &corner)).unwrap().at(1.5).all()[0];
        assert_eq!(out(false), 10.0);
        assert!(out(true) > 10.1, "a curve swings out: {}", out(true));
    }
}
