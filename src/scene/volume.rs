//! Volumes: fields on grids that stand in the city, and how they look.

use std::path::PathBuf;

use glam::{DQuat, DVec3};

use crate::{
    field::Component,
    lens::{
        color::{Srgb, linear_from_srgb, mixed},
        ramp::{RampColors, ramp},
    },
    time::Moment,
};

/// Volumes of a scene that are shown, at most: one picture takes so many.
pub const MOST_VOLUMES: usize = 4;
/// Entries of a ramp as pictures read it.
pub const RAMP_ENTRIES: usize = 256;

/// A field that stands in the city.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Its name, unique.
    pub name: String,
    /// Whether it is shown.
    pub visible: bool,
    /// Its file, or one that the program has: `builtin:plume`.
    pub file: PathBuf,
    /// The array of the file; `None`: its first.
    pub field: Option<String>,
    /// What legends call its values; `None`: the array's name.
    pub label: Option<String>,
    /// Their unit; `None`: what the file says.
    pub unit: Option<String>,
    /// What of vectors is shown.
    pub component: Component,
    /// Which step in time, from 0, where no moment says it.
    pub time_step: u32,
    /// When its first step in time is, and its last; the others are evenly between. With both, the moment that shows says which is seen.
    pub begins: Option<Moment>,
    /// See `begins`.
    pub ends: Option<Moment>,
    /// Whether its numbers are labels of things.
    pub labels: bool,
    /// Where its first sample is, metres; `None`: where the file says.
    pub origin: Option<DVec3>,
    /// How far its samples are apart along its axes, metres, > 0; `None`: as the file says.
    pub spacing: Option<DVec3>,
    /// How it is turned about its first sample.
    pub rotation: DQuat,
    /// Whether the second axis of the file's coordinates is up, not the third.
    pub y_up: bool,
    /// How values look.
    pub transfer: Transfer,
    /// What a ray makes of them.
    pub mode: VolumeMode,
    /// The value of its surface; `None`: the middle of the transfer's range.
    pub level: Option<f64>,
    /// Where it is cut.
    pub slice: Slice,
    /// Its light.
    pub light: VolumeLight,
    /// Whether lenses take nothing of it away: what hides, and what makes translucent, leaves it as it is.
    pub keeps: bool,
    /// Over how many metres the opacity of the transfer holds, > 0; `None`: over the smallest distance of samples.
    pub thickness: Option<f64>,
    /// Steps along rays, shares of the smallest distance of samples, > 0.
    pub step: f64,
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            name: String::new(),
            visible: true,
            file: PathBuf::new(),
            field: None,
            label: None,
            unit: None,
            component: Component::Magnitude,
            time_step: 0,
            begins: None,
            ends: None,
            labels: false,
            origin: None,
            spacing: None,
            rotation: DQuat::IDENTITY,
            y_up: false,
            transfer: Transfer::default(),
            mode: VolumeMode::Direct,
            level: None,
            slice: Slice::default(),
            light: VolumeLight::None,
            keeps: false,
            thickness: None,
            step: 1.0,
        }
    }
}

impl Volume {
    /// When a step of so many begins to be seen: steps are seen up to the next one, the first before it, too, the last after it. `None`: moments say
    /// nothing of it.
    pub fn step_begins(&self, step: usize, steps: usize) -> Option<Moment> {
        let (first, last) = (self.begins?.micros(), self.ends?.micros());
        let between = steps.max(2) as i64 - 1;
        // In 128 bits, as the calendar times the steps of a file would not fit in 64.
        let after = i128::from(last - first) * step as i128 / i128::from(between);
        Moment::from_micros(first + after as i64)
    }

    /// The step of so many that is seen at a moment; where there is none the first.
    pub fn step_at(&self, moment: Option<Moment>, steps: usize) -> u32 {
        if self.begins.and(self.ends).is_none() {
            return self.time_step;
        }
        let Some(moment) = moment else { return 0 };
        let is_there = |step: &usize| self.step_begins(*step, steps).is_some_and(|begins| begins <= moment);
        (0..steps).take_while(is_there).count().saturating_sub(1) as u32
    }

    /// From when up to when a step of so many is seen; without a bound for ever.
    pub fn seen_from_to(&self, step: usize, steps: usize) -> Option<[Option<Moment>; 2]> {
        self.begins.and(self.ends)?;
        let begins = (step > 0).then(|| self.step_begins(step, steps)).flatten();
        let ends = (step + 1 < steps).then(|| self.step_begins(step + 1, steps)).flatten();
        Some([begins, ends])
    }
}

/// What a ray makes of the values that it meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VolumeMode {
    /// Each gives light and takes some away.
    Direct,
    /// The same, where values change.
    Gradient,
    /// The largest before what is opaque.
    Maximum,
    /// The smallest.
    Minimum,
    /// Their mean.
    Average,
    /// Light is taken away.
    XRay,
    /// The surface of a value.
    Isosurface,
    /// The plane through one place.
    Slice,
}

impl VolumeMode {
    /// All of them, with the words that scene files have for them.
    pub const WORDS: [(&'static str, Self); 8] = [
        ("direct", Self::Direct),
        ("gradient", Self::Gradient),
        ("maximum", Self::Maximum),
        ("minimum", Self::Minimum),
        ("average", Self::Average),
        ("x-ray", Self::XRay),
        ("isosurface", Self::Isosurface),
        ("slice", Self::Slice),
    ];
}

/// A plane through a field, at right angles to one of its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// 0, 1 or 2: the first, second or third axis of the grid.
    pub axis: u32,
    /// Where, a share of the way from the first sample to the last, 0 to 1.
    pub at: f64,
}

impl Default for Slice {
    fn default() -> Self {
        Self { axis: 2, at: 0.5 }
    }
}

/// The light of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VolumeLight {
    /// It shows its colours as they are.
    None,
    /// Sun and sky light it as a surface where its values change.
    Lit,
    /// The same, and the city casts its shadows on it.
    Shadowed,
}

impl VolumeLight {
    /// All of them, with the words that scene files have for them.
    pub const WORDS: [(&'static str, Self); 3] =
        [("none", Self::None), ("lit", Self::Lit), ("shadowed", Self::Shadowed)];
}

/// A transfer function: colour and opacity by the value.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// Name of a colour ramp, where there are no `colors`.
    pub ramp: String,
    /// Colours, sRGB, at `values`; empty: those of the ramp.
    pub colors: Vec<Srgb>,
    /// Opacities over the thickness of the volume, 0 to 1, at `values`.
    pub opacity: Vec<f32>,
    /// Values, ascending; empty: at equal steps over the range.
    pub values: Vec<f64>,
    /// What legends call labels, one name for each of `values`; empty: their numbers.
    pub names: Vec<String>,
    /// The values at its ends; `None`: the first and last of `values`, or those of the field.
    pub range: Option<[f64; 2]>,
}

impl Default for Transfer {
    fn default() -> Self {
        Self {
            ramp: "viridis".to_owned(),
            colors: Vec::new(),
            opacity: vec![0.0, 0.2],
            values: Vec::new(),
            names: Vec::new(),
            range: None,
        }
    }
}

/// The share of a list that a place at `t` of equal steps is between: two places, and how far it is to the second.
fn between(count: usize, t: f64) -> (usize, usize, f32) {
    let at = t.clamp(0.0, 1.0) * count.saturating_sub(1) as f64;
    let low = at.floor() as usize;
    (low, (low + 1).min(count.saturating_sub(1)), (at - low as f64) as f32)
}

impl Transfer {
    /// The values at its ends, of a field with these.
    pub fn ends(&self, of_field: [f64; 2]) -> [f64; 2] {
        let own = self.values.first().zip(self.values.last()).map(|(low, high)| [*low, *high]);
        self.range.or(own).unwrap_or(of_field)
    }

    /// Where a value stands among its `values`, as a share of the way along them, 0..1.
    fn along(&self, value: f64, ends: [f64; 2]) -> f64 {
        let [low, high] = ends;
        let Some(last) = self.values.len().checked_sub(1).filter(|last| *last > 0) else {
            return if high > low { (value - low) / (high - low) } else { 0.5 };
        };
        let after = self.values.partition_point(|own| *own <= value).clamp(1, last);
        let [a, b] = [self.values[after - 1], self.values[after]];
        let share = if b > a { ((value - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
        ((after - 1) as f64 + share) / last as f64
    }

    /// The colour of a value, sRGB, and its opacity, where the ramp goes over `ends`.
    pub fn look(&self, value: f64, ends: [f64; 2]) -> (Srgb, f32) {
        let t = self.along(value, ends);
        let color = match self.colors[..] {
            [] => ramp(&self.ramp, t),
            ref colors => {
                let (low, high, share) = between(colors.len(), t);
                mixed(colors[low], colors[high], share)
            }
        };
        let (low, high, share) = between(self.opacity.len(), t);
        let of = |i: usize| self.opacity.get(i).copied().unwrap_or(0.0);
        (color, of(low) * (1.0 - share) + of(high) * share)
    }

    /// The ramp as pictures read it: linear colour and extinction, 1 / metres, of opacities that hold over a thickness in metres; at equal steps over
    /// `ends`.
    pub fn entries(&self, ends: [f64; 2], thickness: f64) -> Vec<[f32; 4]> {
        let [low, high] = ends;
        let entry = |i: usize| {
            let value = low + (high - low) * i as f64 / (RAMP_ENTRIES - 1) as f64;
            let (color, opacity) = self.look(value, ends);
            entry(color, opacity, thickness)
        };
        (0..RAMP_ENTRIES).map(entry).collect()
    }

    /// The colour of one of the labels, sRGB.
    pub fn label_color(&self, index: usize) -> Srgb {
        let of_ramp = || RampColors::named(&self.ramp).classes(self.values.len()).get(index).copied();
        self.colors.get(index).copied().or_else(of_ramp).unwrap_or_default()
    }

    /// The same of labels: the first of `values` has entry 1, the next 2, and so on; entry 0 is that of all others, and nothing.
    pub fn label_entries(&self, thickness: f64) -> Vec<[f32; 4]> {
        let mut entries = vec![[0.0; 4]; RAMP_ENTRIES];
        for (i, slot) in entries.iter_mut().skip(1).take(self.values.len()).enumerate() {
            let color = self.label_color(i);
            // Of one opacity all have it.
            let opacity = self.opacity.get(i).or(self.opacity.last()).copied().unwrap_or(0.0);
            *slot = self::entry(color, opacity, thickness);
        }
        entries
    }
}

/// The largest opacity that extinctions stand for: less light than 2^-24 is not seen.
const MOST_OPAQUE: f64 = 1.0 - 5.960_464_477_539_063e-8;

fn entry(color: Srgb, opacity: f32, thickness: f64) -> [f32; 4] {
    let [r, g, b] = linear_from_srgb(color);
    let extinction = -(-f64::from(opacity).clamp(0.0, MOST_OPAQUE)).ln_1p() / thickness;
    [r, g, b, extinction as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacities_hold_over_the_thickness() {
        let transfer = Transfer { opacity: vec![0.0, 0.5, 1.0], ..Transfer::default() };
        let entries = transfer.entries([10.0, 20.0], 3.0);
        assert_eq!((entries.len(), entries[0][3]), (RAMP_ENTRIES, 0.0));
        let opacity = |extinction: f32| 1.0 - (-3.0 * f64::from(extinction)).exp();
        assert!((opacity(entries[255][3]) - 1.0).abs() < 1e-6);
        let (_, quarter) = transfer.look(12.5, [10.0, 20.0]);
        assert_eq!(quarter, 0.25);
        assert!((opacity(entries[51][3]) - 0.2).abs() < 1e-6, "a fifth of the way");
    }

    #[test]
    fn values_say_where_colours_stand() {
        let transfer = Transfer {
            values: vec![0.0, 1.0, 10.0],
            colors: vec![[0.0; 3], [0.5; 3], [1.0; 3]],
            opacity: vec![0.0, 1.0, 0.5],
            ..Transfer::default()
        };
        let ends = transfer.ends([-5.0, 5.0]);
        assert_eq!(ends, [0.0, 10.0]);
        assert_eq!(transfer.look(1.0, ends), ([0.5; 3], 1.0));
        assert_eq!(transfer.look(5.5, ends).1, 0.75);
        assert_eq!(transfer.look(99.0, ends).1, 0.5, "as at its end");
        assert_eq!(transfer.look(-1.0, ends).1, 0.0);
        assert_eq!(Transfer { range: Some([2.0, 3.0]), ..transfer }.ends([-5.0, 5.0]), [2.0, 3.0]);
    }

    #[test]
    fn labels_have_entries_of_their_own() {
        let transfer = Transfer {
            values: vec![3.0, 7.0],
            colors: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            opacity: vec![0.5],
            ..Transfer::default()
        };
        let entries = transfer.label_entries(1.0);
        let seen: Vec<usize> = (0..RAMP_ENTRIES).filter(|i| entries[*i][3] > 0.0).collect();
        assert_eq!(seen, [1, 2]);
        assert_eq!(entries[2][..3], [0.0, 1.0, 0.0]);
    }
}
