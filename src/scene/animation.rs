//! What of a scene changes over time: the camera along a path, and numbers of its lenses, style, sun and points of interest.

use glam::DVec3;

use crate::{
    time::{Moment, Span},
    view::{
        Camera,
        path::{CameraKey, CameraPath, Curve, Path, PathError, Speed},
    },
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

/// How long an animation through moments takes where nothing else says it, seconds, and how many pictures it has in a second.
pub const MOMENTS_S: f64 = 10.0;
/// Pictures per second where none are given.
pub const FPS: f64 = 30.0;

impl Animation {
    /// How long it takes from the first frame to the last one, seconds.
    fn duration_s(&self) -> f64 {
        f64::from(self.frames.saturating_sub(1)) / self.fps
    }

    /// The moment of the calendar that shows at a second; `None`: the scene's.
    pub fn moment_of(&self, seconds: f64) -> Option<Moment> {
        let [first, last] = self.moments?;
        let gone = (last - first) as f64 * seconds / self.duration_s();
        gone.is_finite().then(|| first.shifted(Span::of_micros(gone.round() as i64)))
    }

    /// An animation with a camera key at a moment, in the place of one that is there; a new one goes through the moments of `span`. A moment before its
    /// first or after its last one makes it longer: it goes on at the pace that it has.
    ///
    /// # Errors
    /// It would be too long, or the key makes no path with the others: what is wrong.
    pub fn with_key(before: Option<&Self>, camera: &Camera, at: Moment, span: [Moment; 2]) -> Result<Self, String> {
        let mut made = before.cloned().unwrap_or(Self {
            frames: 0,
            fps: FPS,
            speed: Speed::Keys,
            camera: Vec::new(),
            changes: Vec::new(),
            moments: None,
        });
        if made.frames < 2 {
            made.frames = (MOMENTS_S * made.fps).round().max(1.0) as u32 + 1;
        }
        let [first, last] = made.moments.filter(|[first, last]| first < last).unwrap_or(span);
        let per_moment = made.duration_s() / (last - first).max(1) as f64;
        let [early, late] = [first - at, at - last].map(|by| by.max(0) as f64 * per_moment);
        let frames = ((made.duration_s() + early + late) * made.fps).round() + 1.0;
        if frames > f64::from(MOST_FRAMES) {
            return Err(format!(
                "The animation goes from {} to {}: up to {} it would have {frames} frames; at most {MOST_FRAMES} would be right.",
                first.written(),
                last.written(),
                at.written()
            ));
        }
        (made.frames, made.moments) = (frames as u32, Some([first.min(at), last.max(at)]));
        let times = made.camera.iter_mut().map(|key| &mut key.at);
        let of_changes = made.changes.iter_mut().flat_map(|change| &mut change.keys).map(|key| &mut key.at);
        times.chain(of_changes).for_each(|time| *time += early);
        let seconds = (at - first).max(0) as f64 * per_moment;
        let key = CameraKey {
            at: (seconds * 1e6).round() / 1e6,
            eye: camera.eye,
            target: camera.target,
            up: camera.up,
            projection: camera.projection,
        };
        // Two in one frame are one.
        made.camera.retain(|own| (own.at - key.at).abs() * made.fps >= 0.5);
        let place = made.camera.partition_point(|own| own.at < key.at);
        made.camera.insert(place, key);
        CameraPath::new(&made.camera, made.speed, None)
            .map_err(|error| format!("The view is no camera key: {error}"))?;
        Ok(made)
    }

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
    use crate::view::Projection;

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

    #[test]
    fn views_become_camera_keys_of_their_moments() {
        let year = |year: i64| Moment::of_year(year).unwrap();
        let camera = |x: f64| Camera::looking(DVec3::new(x, -50.0, 20.0), DVec3::ZERO, 0.8);
        let span = [year(1900), year(2000)];
        let first = Animation::with_key(None, &camera(0.0), year(1900), span).unwrap();
        assert_eq!((first.frames, first.fps, first.moments), (301, 30.0, Some(span)));
        let key = |animation: &Animation| animation.camera.iter().map(|key| key.at).collect::<Vec<_>>();
        assert_eq!(key(&first), [0.0]);
        // A century takes ten seconds; days of leap years are not quite even.
        let halfway = Animation::with_key(Some(&first), &camera(9.0), year(1950), span).unwrap();
        assert!((key(&halfway)[1] - 5.0).abs() < 1e-3);
        let day = |at: Option<Moment>, year: Moment| (at.unwrap() - year).abs() < crate::time::DAY;
        assert!(day(halfway.moment_of(key(&halfway)[1]), year(1950)));
        // Another view of that moment comes in its place.
        let again = Animation::with_key(Some(&halfway), &camera(30.0), year(1950), span).unwrap();
        assert_eq!((again.camera.len(), again.camera[1].eye.x), (2, 30.0));
        // Beyond its ends it goes on at the same pace.
        let longer = Animation::with_key(Some(&again), &camera(-9.0), year(1850), span).unwrap();
        assert_eq!((longer.frames, longer.moments), (451, Some([year(1850), year(2000)])));
        for (at, (own, then)) in key(&longer).into_iter().zip([(0.0, 1850), (5.0, 1900), (10.0, 1950)]) {
            assert!((at - own).abs() < 1e-2 && day(longer.moment_of(at), year(then)), "{at}");
        }
        let far = Animation::with_key(Some(&longer), &camera(1.0), year(2050), span).unwrap();
        assert_eq!((far.frames, far.moments), (601, Some([year(1850), year(2050)])));
        // What makes no animation is told.
        let hours = [year(1900), year(1900).shifted(Span::of_micros(crate::time::HOUR))];
        let short = Animation::with_key(None, &camera(0.0), hours[0], hours).unwrap();
        assert!(Animation::with_key(Some(&short), &camera(1.0), year(2000), hours).unwrap_err().contains("at most"));
        let flat = Camera { projection: Projection::Orthographic { height_m: 90.0 }, ..camera(3.0) };
        assert!(Animation::with_key(Some(&first), &flat, year(1950), span).unwrap_err().contains("projection"));
    }
}
