//! Quantities that are measured of a variant: one list for columns, axes and the Pareto front.

use crate::measure::{
    ratio::Estimate,
    run::Row,
    topic::{Knob, Value},
};

/// A figure of a variant. All but knobs are better when smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A knob's value, by its place in the topic's list.
    Knob(usize),
    /// Wrong pixels, percent of the picture.
    WrongPixels,
    /// Pixels in the lens that should not be or the other way round, percent of the picture.
    WrongMask,
    /// Largest difference of a colour channel, 8-bit steps.
    MaxSteps,
    /// Mean difference of the colour channels, 8-bit steps.
    MeanSteps,
    /// Mean FLIP, 0..1.
    Flip,
    /// Largest error of a channel against f64, linear light.
    MaxError,
    /// Mean of it.
    MeanError,
    /// Root of the mean of its square.
    RmsError,
    /// Time against the plain frame.
    Ratio,
    /// Time, milliseconds.
    Ms,
    /// The time by which the first frame takes longer than a later one, milliseconds.
    StartMs,
    /// Graphics memory beside the city, MiB.
    Memory,
    /// Triangles of what is deformed.
    Triangles,
    /// The largest distance of its edges from where they should be, pixels.
    Chord,
    /// The same in the median of those that are bent.
    MedianChord,
}

impl Quantity {
    /// The title of an axis: name, then unit.
    pub fn title(self, knobs: &[Knob]) -> String {
        match self {
            Self::Knob(i) => match knobs.get(i) {
                Some(Knob { name, unit: "" }) => (*name).to_owned(),
                Some(Knob { name, unit }) => format!("{name} ({unit})"),
                None => String::new(),
            },
            Self::WrongPixels => "wrong pixels (% of the picture)".into(),
            Self::WrongMask => "pixels wrongly in or out of the lens (% of the picture)".into(),
            Self::MaxSteps => "largest colour difference (8-bit steps)".into(),
            Self::MeanSteps => "mean colour difference (8-bit steps)".into(),
            Self::Flip => "mean FLIP (0: looks the same)".into(),
            Self::MaxError => "largest error against f64 (linear light)".into(),
            Self::MeanError => "mean error against f64 (linear light)".into(),
            Self::RmsError => "root mean square error against f64 (linear light)".into(),
            Self::Ratio => "time (ratio to the plain frame)".into(),
            Self::Ms => "time (ms)".into(),
            Self::StartMs => "start-up (ms)".into(),
            Self::Memory => "graphics memory (MiB)".into(),
            Self::Triangles => "triangles of what is deformed".into(),
            Self::Chord => "largest chord error (px)".into(),
            Self::MedianChord => "median chord error (px)".into(),
        }
    }

    /// The figure; NaN where there is none.
    pub fn of(self, row: &Row) -> f64 {
        let share = |count: u64| 100.0 * count as f64 / row.difference.pixels.max(1) as f64;
        match self {
            Self::Knob(i) => match row.knobs.get(i) {
                Some(Value::Number(number)) => *number,
                _ => f64::NAN,
            },
            Self::WrongPixels => share(row.difference.wrong_pixels),
            Self::WrongMask => row.difference.wrong_mask_pixels.map_or(f64::NAN, share),
            Self::MaxSteps => f64::from(row.difference.max_steps),
            Self::MeanSteps => row.difference.mean_steps,
            Self::Flip => row.difference.flip,
            Self::MaxError => row.difference.against_f64.map_or(f64::NAN, |against| against.max),
            Self::MeanError => row.difference.against_f64.map_or(f64::NAN, |against| against.mean),
            Self::RmsError => row.difference.against_f64.map_or(f64::NAN, |against| against.rms),
            Self::Ratio | Self::Ms | Self::StartMs => self.estimate(row).map_or(f64::NAN, |e| e.median),
            Self::Memory => row.gpu_bytes as f64 / f64::from(1 << 20),
            Self::Triangles => row.refined.map_or(f64::NAN, |refined| refined.triangles as f64),
            Self::Chord => row.refined.map_or(f64::NAN, |refined| refined.chords_px[1]),
            Self::MedianChord => row.refined.map_or(f64::NAN, |refined| refined.chords_px[0]),
        }
    }

    /// Its interval, where it has one.
    pub fn estimate(self, row: &Row) -> Option<Estimate> {
        match self {
            Self::Ratio => Some(row.ratio),
            Self::Ms => Some(row.ms),
            Self::StartMs => row.start_ms,
            _ => None,
        }
    }
}
