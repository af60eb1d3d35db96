//! Volumes of a scene: their fields as rays meet them, and where they stand.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{DMat3, DVec2, DVec3};

use crate::{
    field::{self, Component, FieldFile, Grid, Values},
    geom::Aabb,
    render::{
        epochs::{Epochs, Met},
        eye::PictureTile,
        layout,
        placed_region::Leaf,
        stats,
    },
    scene::volume::{MOST_VOLUMES, RAMP_ENTRIES, Volume, VolumeLight, VolumeMode},
    time::Moment,
    view::View,
    visibility::Viewer,
};

/// Samples along an edge of the bricks that tell where nothing is seen (`lib/fields.wgsl`).
pub(super) const BRICK: usize = 8;
/// How much of the light on the way to a point of interest a field takes, at least, that hides it.
const HIDES: f64 = 0.5;
/// Steps along the longest way through a field, at most: software adapters end the loops of a shader after 65535 rounds in all.
const MOST_STEPS: f64 = 8192.0;

/// Values of a field, one of each sample.
#[derive(Debug)]
pub(super) struct FieldData {
    pub size: [usize; 3],
    pub values: Values,
    /// The smallest and the largest.
    pub range: [f32; 2],
    /// Bricks along each axis, and the smallest and largest value of each, those of its border included; none where all are missing.
    pub bricks: [usize; 3],
    pub brick_ranges: Vec<Option<[f32; 2]>>,
    /// The largest difference of neighbours along each axis.
    steepest: [f32; 3],
}

impl FieldData {
    fn new(grid: &Grid, values: Values, range: [f32; 2]) -> Self {
        let size = grid.size;
        let bricks = size.map(|n| (n - 1).max(1).div_ceil(BRICK));
        let at = |[x, y, z]: [usize; 3]| values.get((z * size[1] + y) * size[0] + x);
        let mut brick_ranges = Vec::with_capacity(bricks.iter().product());
        for brick in places(bricks) {
            let ends = [0, 1, 2].map(|i| ((brick[i] + 1) * BRICK).min(size[i] - 1));
            let spans = [0, 1, 2].map(|i| ends[i] + 1 - brick[i] * BRICK);
            let own = places(spans).map(|own| at([0, 1, 2].map(|i| brick[i] * BRICK + own[i])));
            let known = own.filter(|value| value.is_finite());
            let ends = known.fold(None, |ends: Option<[f32; 2]>, value| {
                let [low, high] = ends.unwrap_or([value; 2]);
                Some([low.min(value), high.max(value)])
            });
            brick_ranges.push(ends);
        }
        let steepest = [0, 1, 2].map(|axis| {
            let difference = |place: [usize; 3]| {
                let mut next = place;
                next[axis] += 1;
                let difference = (at(next) - at(place)).abs();
                if difference.is_finite() { difference } else { 0.0 }
            };
            let mut all = size;
            all[axis] -= 1;
            places(all).map(difference).fold(0.0, f32::max)
        });
        Self { size, values, range, bricks, brick_ranges, steepest }
    }
}

impl FieldData {
    /// How many values there are in each of so many columns between two.
    fn histogram(&self, [low, high]: [f64; 2]) -> Vec<u64> {
        let mut columns = vec![0; COLUMNS];
        let per_value = if high > low { COLUMNS as f64 / (high - low) } else { 0.0 };
        for i in 0..self.values.len() {
            let at = (f64::from(self.values.get(i)) - low) * per_value;
            if at >= 0.0 && at <= COLUMNS as f64 {
                columns[(at as usize).min(COLUMNS - 1)] += 1;
            }
        }
        columns
    }
}

/// In place of labels, whole numbers 0 to 255, their places among those that are seen, from 1; 0 for the others. `None`: some are no labels.
fn seen_labels(values: &Values, seen: &[u8]) -> Option<Vec<u8>> {
    let mut places = [0_u8; 256];
    (1..).zip(seen).for_each(|(place, label)| places[usize::from(*label)] = place);
    match values {
        Values::U8(values) => Some(values.iter().map(|label| places[usize::from(*label)]).collect()),
        Values::F32(values) => {
            let place = |value: &f32| match *value {
                v if (0.0..=255.0).contains(&v) && v.fract() == 0.0 => Some(places[v as usize]),
                // Where nothing is known there is nothing.
                v if v.is_nan() => Some(0),
                _ => None,
            };
            values.iter().map(place).collect()
        }
    }
}

/// All places of a box, x fastest.
fn places(size: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [w, h, d] = size;
    (0..d).flat_map(move |z| (0..h).flat_map(move |y| (0..w).map(move |x| [x, y, z])))
}

/// What of a file is shown.
#[derive(Clone, Debug, PartialEq)]
struct Shown {
    file: PathBuf,
    field: Option<String>,
    component: Component,
    time_step: u32,
    /// Of labels those that are seen; their places in it stand in place of them, from 1.
    labels: Vec<u8>,
}

/// What a volume shows, for legends and for those who choose colours.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownVolume {
    /// Its place among the volumes of the scene.
    pub index: usize,
    /// What its values are called, and their unit.
    pub title: String,
    /// See `title`.
    pub unit: Option<String>,
    /// The values at the ends of its transfer function.
    pub ends: [f64; 2],
    /// The smallest and the largest value.
    pub range: [f64; 2],
    /// How many samples are in each of [`COLUMNS`] columns of equal width from one end of the transfer function to the other.
    pub histogram: Vec<u64>,
    /// How many samples there are along each axis.
    pub size: [usize; 3],
    /// Steps in time.
    pub steps: usize,
    /// The arrays of its file.
    pub arrays: Vec<String>,
}

/// Columns of a histogram.
pub const COLUMNS: usize = 128;

/// Fields that were loaded, kept from picture to picture.
#[derive(Debug, Default)]
pub(super) struct KnownFields {
    files: Vec<(PathBuf, Arc<FieldFile>)>,
    data: Vec<(Shown, Arc<FieldData>)>,
    /// The smallest and the largest value of all steps in time.
    ranges: Vec<(Shown, Option<[f32; 2]>)>,
    /// Counted between the ends of transfer functions.
    histograms: Vec<(Arc<FieldData>, [f64; 2], Vec<u64>)>,
    /// Those of the last pictures.
    placed: Vec<Arc<PlacedField>>,
}

/// A volume where it stands.
#[derive(Clone, Debug)]
pub(super) struct PlacedField {
    pub data: Arc<FieldData>,
    /// In the city.
    grid: Grid,
    entries: Vec<[f32; 4]>,
    /// 1 for each of its bricks of which something is seen.
    pub seen: Vec<u8>,
    /// The values at the ends of its ramp.
    ends: [f64; 2],
    volume: Volume,
    /// From when up to when it is seen; `None`: whatever moment shows.
    there: Option<[Option<Moment>; 2]>,
    /// Metres.
    thickness: f64,
    step: f64,
}

/// What there is among the fields of a picture, for its programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FieldKinds {
    /// Some are no surfaces, and not one layer.
    pub walked: bool,
    /// Some are surfaces.
    pub surfaces: bool,
    /// Some are one layer.
    pub projected: bool,
    /// Light acts on some.
    pub lit: bool,
    /// And shadows do.
    pub shadowed: bool,
    /// Some are labels.
    pub labels: bool,
    /// Some are none.
    pub numbers: bool,
    /// Some are seen where they change.
    pub steep: bool,
}

/// The volumes of a scene that are shown.
#[derive(Clone, Debug, Default)]
pub struct PlacedFields {
    /// Each of them.
    pub(super) all: Vec<Arc<PlacedField>>,
    /// The number of the first among objects, for lenses that mean objects: behind those of all cities.
    pub(super) first_object: u32,
}

impl KnownFields {
    /// The volumes of a scene, those that are shown.
    ///
    /// # Errors
    /// A file that is none, or has not what is asked for; too many.
    pub fn of_scene(&mut self, volumes: &[Volume], epochs: &Epochs) -> Result<PlacedFields, String> {
        let shown: Vec<&Volume> = volumes.iter().filter(|volume| volume.visible).collect();
        if shown.len() > MOST_VOLUMES {
            return Err(format!("{} volumes are shown; one picture takes {MOST_VOLUMES}", shown.len()));
        }
        self.forget_others(volumes);
        let mut all = Vec::new();
        for volume in shown {
            let steps = self.steps_that_show(volume, epochs)?;
            all.extend(steps.into_iter().map(|time_step| Volume { time_step, ..volume.clone() }));
        }
        if all.len() > MOST_VOLUMES {
            let message = "lenses show steps in time of volumes";
            return Err(format!(
                "{message}, {} with those that show outside; one picture takes {MOST_VOLUMES}",
                all.len()
            ));
        }
        all.iter()
            .map(|volume| self.placed(volume))
            .collect::<Result<_, _>>()
            .map(|all| PlacedFields { all, first_object: 0 })
    }

    /// The steps in time of a volume that moments of a scene show, ascending.
    fn steps_that_show(&mut self, volume: &Volume, epochs: &Epochs) -> Result<BTreeSet<u32>, String> {
        if volume.begins.is_none() || volume.ends.is_none() {
            return Ok([volume.time_step].into());
        }
        let words = epochs.lenses().len().div_ceil(32);
        let (may, surely) = (vec![u32::MAX; words], vec![0; words]);
        let moments = epochs.moments_of(Met { may: &may, surely: &surely });
        let too_many = || format!("volume \"{}\": begins: lenses show too many moments", volume.name);
        let steps = self.steps_of(volume)?;
        Ok(moments.ok_or_else(too_many)?.into_iter().map(|moment| volume.step_at(moment, steps)).collect())
    }

    /// How many steps in time a volume has.
    fn steps_of(&mut self, volume: &Volume) -> Result<usize, String> {
        let file = self.file(&volume.file).map_err(|error| format!("volume \"{}\": {error}", volume.name))?;
        Ok(array_of(volume, &file).map_or(1, |own| own.steps.len()))
    }

    /// Forgets what volumes had that are no more.
    fn forget_others(&mut self, volumes: &[Volume]) {
        if !volumes.is_empty() {
            self.files.retain(|(file, _)| volumes.iter().any(|volume| volume.file == *file));
            self.data.retain(|(of, _)| volumes.iter().any(|volume| volume.file == of.file));
            self.placed.retain(|field| volumes.iter().any(|volume| volume.file == field.volume.file));
            let data = &self.data;
            self.histograms.retain(|(of, ..)| data.iter().any(|(_, own)| Arc::ptr_eq(of, own)));
        }
    }

    /// What the volumes of a scene show at a moment.
    ///
    /// # Errors
    /// Those of [`Self::of_scene`].
    pub fn shown(&mut self, volumes: &[Volume], at: Option<Moment>) -> Result<Vec<ShownVolume>, String> {
        self.forget_others(volumes);
        let mut placed = Vec::new();
        for volume in volumes.iter().filter(|volume| volume.visible).take(MOST_VOLUMES) {
            let time_step = volume.step_at(at, self.steps_of(volume)?);
            placed.push(self.placed(&Volume { time_step, ..volume.clone() })?);
        }
        let indices = (0..volumes.len()).filter(|i| volumes[*i].visible);
        let shown = |(index, field): (usize, Arc<PlacedField>)| {
            let volume = &volumes[index];
            let file = self.file(&volume.file)?;
            let own = array_of(volume, &file).map(|own| (own.name.clone(), own.unit.clone(), own.steps.len()));
            let (name, unit, steps) = own.unwrap_or_default();
            Ok(ShownVolume {
                index,
                title: match &volume.label {
                    Some(label) => label.clone(),
                    // The name that somebody gave it.
                    None if volume.name != format!("volume-{index}") => volume.name.clone(),
                    None => name,
                },
                unit: volume.unit.clone().or(unit),
                ends: field.ends,
                range: field.data.range.map(f64::from),
                histogram: self.histogram(&field),
                size: field.data.size,
                steps,
                arrays: file.fields.iter().map(|field| field.name.clone()).collect(),
            })
        };
        indices.zip(placed).map(shown).collect()
    }

    /// How many samples are where between the ends of a transfer function: counted once.
    fn histogram(&mut self, field: &PlacedField) -> Vec<u64> {
        let is_it = |(data, ends, _): &&(Arc<FieldData>, [f64; 2], Vec<u64>)| {
            Arc::ptr_eq(data, &field.data) && *ends == field.ends
        };
        if let Some((_, _, columns)) = self.histograms.iter().find(is_it) {
            return columns.clone();
        }
        let columns = field.data.histogram(field.ends);
        self.histograms.truncate(2 * MOST_VOLUMES - 1);
        self.histograms.insert(0, (field.data.clone(), field.ends, columns.clone()));
        columns
    }

    /// The files that volumes are read from, those beside headers, too.
    ///
    /// # Errors
    /// One that is none.
    pub fn files_of(&mut self, volumes: &[Volume]) -> Result<Vec<PathBuf>, String> {
        let mut files = Vec::new();
        for volume in volumes.iter().filter(|volume| volume.visible) {
            let file = self.file(&volume.file).map_err(|error| format!("volume \"{}\": {error}", volume.name))?;
            files.push(volume.file.clone());
            files.extend(file.beside.iter().cloned());
        }
        Ok(files)
    }

    /// Loads a file, where it is not there yet.
    fn file(&mut self, file: &Path) -> Result<Arc<FieldFile>, String> {
        if let Some((_, known)) = self.files.iter().find(|(of, _)| of == file) {
            return Ok(known.clone());
        }
        let loaded = field::load(file).map_err(|error| error.to_string())?;
        loaded.warnings.iter().for_each(|warning| log::warn!("{}: {warning}", file.display()));
        let loaded = Arc::new(loaded);
        self.files.push((file.to_owned(), loaded.clone()));
        Ok(loaded)
    }

    /// A volume where it stands: made once.
    fn placed(&mut self, volume: &Volume) -> Result<Arc<PlacedField>, String> {
        if let Some(known) = self.placed.iter().find(|field| field.volume == *volume) {
            return Ok(known.clone());
        }
        let field = Arc::new(self.place(volume)?);
        self.placed.truncate(2 * MOST_VOLUMES - 1);
        self.placed.insert(0, field.clone());
        Ok(field)
    }

    fn place(&mut self, volume: &Volume) -> Result<PlacedField, String> {
        let wrong = |key: &str, message: String| format!("volume \"{}\": {key}: {message}", volume.name);
        let file = self.file(&volume.file).map_err(|error| format!("volume \"{}\": {error}", volume.name))?;
        let names = || file.fields.iter().map(|field| format!("\"{}\"", field.name)).collect::<Vec<_>>().join(", ");
        let own = array_of(volume, &file)
            .ok_or_else(|| wrong("field", format!("the file has no such array; it has {}", names())))?;
        let steps = own.steps.len();
        if volume.time_step as usize >= steps {
            let has = if steps == 1 {
                "one step in time, 0".to_owned()
            } else {
                format!("{steps} steps in time, 0 to {}", steps - 1)
            };
            return Err(wrong("time_step", format!("the file has {has}")));
        }
        let data = self.data(volume, own)?;
        let grid = placed_grid(volume, &own.grid);
        let smallest =
            (0..3).filter(|i| data.size[*i] > 1).map(|i| grid.steps[i].length()).fold(f64::INFINITY, f64::min);
        let smallest = if smallest.is_finite() { smallest } else { 1.0 };
        let thickness = volume.thickness.unwrap_or(smallest);
        let ends = match volume.labels {
            true => [0.0, (RAMP_ENTRIES - 1) as f64],
            false => volume.transfer.ends(data.range.map(f64::from)),
        };
        let entries = match volume.labels {
            true => volume.transfer.label_entries(thickness),
            false => volume.transfer.entries(ends, thickness),
        };
        let [low, high] = grid.bounds();
        let step = (volume.step * smallest).max(low.distance(high) / MOST_STEPS);
        let seen = Vec::new();
        let there = volume.seen_from_to(volume.time_step as usize, steps);
        let field = PlacedField { data, grid, entries, seen, ends, volume: volume.clone(), there, thickness, step };
        Ok(PlacedField { seen: field.seen_bricks(), ..field })
    }

    /// The smallest and the largest value of all steps in time, so that these can be compared.
    fn range(&mut self, shown: &Shown, own: &field::Field) -> Option<[f32; 2]> {
        let of = Shown { time_step: 0, labels: Vec::new(), ..shown.clone() };
        if let Some((_, range)) = self.ranges.iter().find(|(known, _)| *known == of) {
            return *range;
        }
        let ranges = (0..own.steps.len()).filter_map(|step| own.scalar(step, shown.component).range);
        let range = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        self.ranges.truncate(2 * MOST_VOLUMES - 1);
        self.ranges.insert(0, (of, range));
        range
    }

    /// The values that are shown.
    fn data(&mut self, volume: &Volume, own: &field::Field) -> Result<Arc<FieldData>, String> {
        let shown = Shown {
            file: volume.file.clone(),
            field: volume.field.clone(),
            component: volume.component,
            time_step: volume.time_step,
            labels: if volume.labels {
                volume.transfer.values.iter().map(|label| *label as u8).collect()
            } else {
                Vec::new()
            },
        };
        if let Some((_, known)) = self.data.iter().find(|(of, _)| *of == shown) {
            return Ok(known.clone());
        }
        let scalars = own.scalar(volume.time_step as usize, volume.component);
        let range = scalars.range.and_then(|own_range| Some(self.range(&shown, own)?).or(Some(own_range)));
        let range = range.ok_or_else(|| {
            let (key, count) = match volume.component {
                Component::Index(i) if i >= own.components => ("component", own.components),
                _ => {
                    return format!(
                        "volume \"{}\": field: none of the values of \"{}\" is known",
                        volume.name, own.name
                    );
                }
            };
            let numbers = if count == 1 { "one component".to_owned() } else { format!("{count} components") };
            format!("volume \"{}\": {key}: \"{}\" has {numbers}", volume.name, own.name)
        })?;
        let data = match volume.labels {
            false => FieldData::new(&own.grid, scalars.values, range),
            true => {
                let places = seen_labels(&scalars.values, &shown.labels).ok_or_else(|| {
                    format!(
                        "volume \"{}\": labels: not all values are whole numbers 0 to 255; false would be right",
                        volume.name
                    )
                })?;
                FieldData::new(&own.grid, Values::U8(places), [0.0, shown.labels.len() as f32])
            }
        };
        let data = Arc::new(data);
        // Those of other labels, and other steps in time, may come again.
        self.data.truncate(2 * MOST_VOLUMES - 1);
        self.data.insert(0, (shown, data.clone()));
        Ok(data)
    }
}

/// The array of a file that a volume shows.
fn array_of<'f>(volume: &Volume, file: &'f FieldFile) -> Option<&'f field::Field> {
    match &volume.field {
        None => file.fields.first(),
        Some(name) => file.fields.iter().find(|field| field.name == *name),
    }
}

/// The grid of a field where a volume has it in the city.
fn placed_grid(volume: &Volume, own: &Grid) -> Grid {
    // Turned so that what is up in the file is up.
    let turned = |v: DVec3| if volume.y_up { DVec3::new(v.x, -v.z, v.y) } else { v };
    let steps = own.steps.map(turned);
    let steps = match volume.spacing {
        None => steps,
        Some(spacing) => [0, 1, 2].map(|i| steps[i].normalize_or(DVec3::AXES[i]) * spacing[i]),
    };
    let steps = steps.map(|step| volume.rotation * step);
    Grid { size: own.size, origin: volume.origin.unwrap_or(turned(own.origin)), steps }
}

impl PlacedField {
    /// The box around it, metres.
    pub fn bounds(&self) -> Aabb {
        self.corners().into_iter().fold(Aabb::EMPTY, |all, corner| all.union(Aabb { min: corner, max: corner }))
    }

    /// From where to where it goes, in samples.
    fn span(&self, axis: usize) -> [f64; 2] {
        let is_cut = self.volume.mode == VolumeMode::Slice && self.volume.slice.axis as usize == axis;
        match self.data.size[axis] {
            // A slice may be at its very end.
            n if is_cut => [-0.5, n as f64 - 0.5],
            1 => [-0.5, 0.5],
            n => [0.0, (n - 1) as f64],
        }
    }

    fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let place = DVec3::from_array([0, 1, 2].map(|axis| self.span(axis)[i >> axis & 1]));
            self.grid.position(place)
        })
    }

    /// From a value to its place on the ramp: times the first, plus the second.
    fn on_ramp(&self) -> [f64; 2] {
        let [low, high] = self.ends;
        if high == low { [0.0, 0.5] } else { [1.0 / (high - low), -low / (high - low)] }
    }

    /// The bricks of which something is seen.
    fn seen_bricks(&self) -> Vec<u8> {
        let [scale, shift] = self.on_ramp();
        let level = self.level();
        let volume = &self.volume;
        let is_seen = |ends: &Option<[f32; 2]>| {
            let Some(ends) = ends else { return false };
            let [a, b] =
                ends.map(|value| (f64::from(value) * scale + shift).clamp(0.0, 1.0) * (RAMP_ENTRIES - 1) as f64);
            let (low, high) = (a.min(b).floor() as usize, a.max(b).ceil() as usize);
            match volume.mode {
                // Of labels those between are others.
                VolumeMode::Isosurface if !volume.labels => {
                    let margin = 1e-5;
                    let [a, b] = ends.map(|value| f64::from(value) * scale + shift);
                    a.min(b) - margin <= level && level <= a.max(b) + margin
                }
                VolumeMode::Slice => true,
                _ => self.entries[low..=high.min(RAMP_ENTRIES - 1)].iter().any(|entry| entry[3] > 0.0),
            }
        };
        self.data.brick_ranges.iter().map(|ends| u8::from(is_seen(ends))).collect()
    }

    /// Why nothing of it is seen in a city; `None`: something may be.
    fn unseen(&self, city: &Aabb) -> Option<String> {
        let bounds = self.bounds();
        let apart = (bounds.min - city.max).max(city.min - bounds.max).max(DVec3::ZERO).length();
        if !city.is_empty() && apart > city.size().length() + bounds.size().length() {
            return Some(format!("stands {apart:.0} m from the city; another origin would be right"));
        }
        if self.seen.contains(&1) {
            return None;
        }
        let [low, high] = self.data.range;
        Some(match (self.volume.mode, self.volume.labels) {
            (_, true) => "has none of the labels that are seen".to_owned(),
            (VolumeMode::Isosurface, _) => {
                let level = self.volume.level.unwrap_or(0.5 * (self.ends[0] + self.ends[1]));
                format!("has no surface of {level}: its values are {low} to {high}")
            }
            _ => format!("nothing is seen of its values, {low} to {high}: its transfer function gives them no opacity"),
        })
    }

    /// Where its surface, or its slice, is.
    fn level(&self) -> f64 {
        let [scale, shift] = self.on_ramp();
        match self.volume.mode {
            VolumeMode::Slice => (self.data.size[self.volume.slice.axis as usize] - 1) as f64 * self.volume.slice.at,
            _ if self.volume.labels => 0.5,
            _ => self.volume.level.map_or(0.5, |level| level * scale + shift),
        }
    }

    /// As shaders read it; `first`: its first slices in the textures of values and of bricks, and its first entry of the ramps. `texels`: from texels to
    /// values.
    fn row(&self, view: &View, first: [u32; 3], texels: [f64; 2]) -> layout::Field {
        // Samples from places in view space: positions are relative to the eye there.
        let to_world = view.basis.view_from_world().transpose();
        let from_index = DMat3::from_cols(self.grid.steps[0], self.grid.steps[1], self.grid.steps[2]);
        let to_index = from_index.inverse();
        let of_view = (to_index * to_world).transpose();
        let eye = to_index * (view.camera.eye - self.grid.origin);
        let axis = |i: usize| of_view.col(i).extend(eye[i]).as_vec4().to_array();
        let [scale, shift] = self.on_ramp();
        let volume = &self.volume;
        let mode = match volume.mode {
            VolumeMode::Direct | VolumeMode::Gradient => layout::FIELD_DIRECT,
            VolumeMode::XRay => layout::FIELD_ABSORBS,
            VolumeMode::Isosurface | VolumeMode::Slice => layout::FIELD_SURFACE,
            VolumeMode::Maximum => layout::FIELD_MAXIMUM,
            VolumeMode::Minimum => layout::FIELD_MINIMUM,
            VolumeMode::Average => layout::FIELD_MEAN,
        };
        let flags = [
            (volume.light != VolumeLight::None, layout::FIELD_LIT),
            (volume.light == VolumeLight::Shadowed, layout::FIELD_SHADOWED),
            (volume.labels, layout::FIELD_LABELS),
            (volume.keeps, layout::FIELD_KEPT),
            (volume.mode == VolumeMode::Gradient, layout::FIELD_STEEP),
            (volume.mode == VolumeMode::Slice, layout::FIELD_SLICE << volume.slice.axis),
        ];
        let steepest =
            (0..3).map(|i| f64::from(self.data.steepest[i]) / self.grid.steps[i].length()).fold(0.0, f64::max);
        let [begin, end] = self.there.unwrap_or([None; 2]);
        let begin = begin.unwrap_or(Moment::FIRST).words();
        let end = end.map_or([i32::MAX.cast_unsigned(), 0], Moment::words);
        layout::Field {
            to_x: axis(0),
            to_y: axis(1),
            to_z: axis(2),
            low: [0, 1, 2].map(|i| self.span(i)[0] as f32),
            mode,
            high: [0, 1, 2].map(|i| self.span(i)[1] as f32),
            flags: flags.iter().filter(|(is_on, _)| *is_on).map(|(_, flag)| flag).sum(),
            last: self.data.size.map(|n| (n - 1) as f32),
            first_slice: first[0],
            scale: (texels[0] * scale) as f32,
            shift: (texels[1] * scale + shift) as f32,
            level: self.level() as f32,
            steepest: (steepest * scale.abs()).max(1e-30) as f32,
            thickness: self.thickness as f32,
            first_brick: first[1],
            ramp: first[2],
            object: 0,
            begin_hour: begin[0].cast_signed(),
            begin_micro: begin[1],
            end_hour: end[0].cast_signed(),
            end_micro: end[1],
        }
    }

    /// How much of the light on the way from one place to another it takes, 0 to 1: by steps as rays have them, what stands alone by its surface.
    fn hides(&self, from: DVec3, to: DVec3) -> f64 {
        let from_index = DMat3::from_cols(self.grid.steps[0], self.grid.steps[1], self.grid.steps[2]);
        let to_index = from_index.inverse();
        let [start, end] = [from, to].map(|place| to_index * (place - self.grid.origin));
        let (along, metres) = (end - start, from.distance(to));
        let mut span = [0.0_f64, 1.0];
        for axis in 0..3 {
            let [low, high] = self.span(axis);
            if along[axis] == 0.0 {
                if start[axis] < low || start[axis] > high {
                    return 0.0;
                }
                continue;
            }
            let ends = [low, high].map(|end| (end - start[axis]) / along[axis]);
            span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
        }
        let length = (span[1] - span[0]) * metres;
        if length.is_nan() || length <= 0.0 {
            return 0.0;
        }
        let steps = (length / self.step).ceil().clamp(1.0, MOST_STEPS) as usize;
        let value = |i: usize| {
            let share = (i as f64 + 0.5) / steps as f64;
            self.value(start + along * (span[0] + share * (span[1] - span[0])))
        };
        let extinction = |value: Option<f64>| value.map_or(0.0, |at| self.extinction(at));
        let values = (0..steps).map(value);
        let absorbed = match self.volume.mode {
            VolumeMode::Direct | VolumeMode::Gradient | VolumeMode::XRay => {
                values.map(extinction).sum::<f64>() * length / steps as f64
            }
            // Each crossing of its surface is a layer.
            VolumeMode::Isosurface => {
                let level = self.level();
                let sides: Vec<bool> = values.map(|value| value.is_some_and(|value| value >= level)).collect();
                let crossings = sides.windows(2).filter(|pair| pair[0] != pair[1]).count();
                crossings as f64 * self.extinction(level) * self.thickness
            }
            VolumeMode::Slice => {
                let axis = self.volume.slice.axis as usize;
                let at = (self.level() - start[axis]) / along[axis];
                let is_met = at >= span[0] && at <= span[1];
                if is_met { extinction(self.value(start + along * at)) * self.thickness } else { 0.0 }
            }
            VolumeMode::Maximum | VolumeMode::Minimum | VolumeMode::Average => {
                let known: Vec<f64> = values.flatten().collect();
                let found = match self.volume.mode {
                    VolumeMode::Maximum => known.iter().copied().reduce(f64::max),
                    VolumeMode::Minimum => known.iter().copied().reduce(f64::min),
                    _ => (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64),
                };
                extinction(found) * self.thickness
            }
        };
        1.0 - (-absorbed).exp()
    }

    /// The place on its ramp at a place among its samples, between them linearly; of labels the nearest. `None`: it is not known.
    fn value(&self, place: DVec3) -> Option<f64> {
        let size = self.data.size;
        let last = DVec3::from_array(size.map(|n| (n - 1) as f64));
        let at = place.clamp(DVec3::ZERO, last);
        let sample = |[x, y, z]: [usize; 3]| {
            let value = self.data.values.get((z * size[1] + y) * size[0] + x);
            value.is_finite().then(|| f64::from(value))
        };
        let [scale, shift] = self.on_ramp();
        if self.volume.labels {
            return sample(at.round().to_array().map(|c| c as usize)).map(|value| value * scale + shift);
        }
        let low = at.floor().min((last - 1.0).max(DVec3::ZERO));
        let share = at - low;
        let mut sum = 0.0;
        for corner in 0..8_usize {
            let is_high = [0, 1, 2].map(|axis| corner >> axis & 1 == 1);
            let weight: f64 = (0..3).map(|i| if is_high[i] { share[i] } else { 1.0 - share[i] }).product();
            let place = [0, 1, 2].map(|i| ((low[i] as usize) + usize::from(is_high[i])).min(size[i] - 1));
            sum += weight * sample(place)?;
        }
        Some(sum * scale + shift)
    }

    /// What a metre of a value, a place on the ramp, takes of light.
    fn extinction(&self, at: f64) -> f64 {
        let at = at.clamp(0.0, 1.0) * (RAMP_ENTRIES - 1) as f64;
        let low = (at as usize).min(RAMP_ENTRIES - 2);
        let [a, b] = [self.entries[low][3], self.entries[low + 1][3]].map(f64::from);
        a + (at - low as f64) * (b - a)
    }

    /// The rectangle of the picture in which it may be seen; `None`: it is behind the eye.
    fn rectangle(&self, view: &View) -> Option<[DVec2; 2]> {
        let size = DVec2::new(view.size[0].into(), view.size[1].into());
        let half = view.half_extent();
        let places = self.corners().map(|corner| view.basis.view_from_world() * (corner - view.camera.eye));
        let near = view.camera.near_m;
        let is_flat = view.is_orthographic();
        if !is_flat && places.iter().all(|place| -place.z < near) {
            return None;
        }
        if !is_flat && places.iter().any(|place| -place.z < near) {
            return Some([DVec2::ZERO, size]);
        }
        let across = places.map(|p| if is_flat { p.truncate() } else { p.truncate() / -p.z });
        let pixels = across.map(|a| DVec2::new(0.5 + 0.5 * a.x / half.x, 0.5 - 0.5 * a.y / half.y) * size);
        let (low, high) = pixels.iter().fold((size, DVec2::ZERO), |(low, high), p| (low.min(*p), high.max(*p)));
        Some([low - 1.5, high + 1.5])
    }
}

impl PlacedFields {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Which of them hide some of these places from a viewer: they take half of the light on the way, or more.
    pub fn that_hide(&self, places: &[DVec3], viewer: Viewer) -> [bool; MOST_VOLUMES] {
        let from =
            |place: DVec3| viewer.along.map_or(viewer.eye, |along| place - (place - viewer.eye).dot(along) * along);
        let hides = |field: &PlacedField| places.iter().any(|place| field.hides(from(*place), *place) >= HIDES);
        let mut found = [false; MOST_VOLUMES];
        found.iter_mut().zip(&self.all).for_each(|(is, field)| *is = hides(field));
        found
    }

    /// Those that some leaves of a lens have as members, as statistics have occluders.
    pub fn told<'a>(&self, leaves: impl Iterator<Item = &'a Leaf>, eye: DVec3) -> Vec<stats::Occluder> {
        let mut held = [false; MOST_VOLUMES];
        for leaf in leaves {
            if let Leaf::Members(members) = leaf {
                held.iter_mut().zip(members.fields).for_each(|(is, own)| *is |= own);
            }
        }
        let told = |field: &PlacedField| stats::Occluder {
            id: field.volume.name.clone(),
            why: vec!["volume".to_owned()],
            coverage: None,
            distance: field.bounds().distance_to(eye),
            case: None,
            weight: None,
        };
        let mut all: Vec<stats::Occluder> =
            self.all.iter().zip(held).filter(|(_, is)| *is).map(|(field, _)| told(field)).collect();
        // Steps in time of one volume follow each other.
        all.dedup_by(|a, b| a.id == b.id);
        all
    }

    /// The box around some of them, metres.
    pub fn bounds_of(&self, some: &[bool]) -> Aabb {
        self.boxes().zip(some).filter(|(_, is)| **is).fold(Aabb::EMPTY, |all, (own, _)| all.union(own))
    }

    /// What is to be said of those of which nothing is seen in the city, which is in this box: nothing of their values, or they stand elsewhere.
    pub fn unseen(&self, city: &Aabb) -> Vec<String> {
        self.all
            .iter()
            .filter_map(|field| Some(format!("volume \"{}\": {}", field.volume.name, field.unseen(city)?)))
            .collect()
    }

    /// Whether what is seen of them goes by the moment that shows: some are steps in time of one volume.
    pub fn vary(&self) -> bool {
        let name = |field: &Arc<PlacedField>| field.there.is_some().then(|| field.volume.name.clone());
        let timed: Vec<String> = self.all.iter().filter_map(name).collect();
        timed.windows(2).any(|pair| pair[0] == pair[1])
    }

    /// What there is among them.
    pub fn kinds(&self) -> FieldKinds {
        let any = |is: &dyn Fn(&Volume) -> bool| self.all.iter().any(|field| is(&field.volume));
        let is_surface = |mode: VolumeMode| matches!(mode, VolumeMode::Isosurface | VolumeMode::Slice);
        let is_layer =
            |mode: VolumeMode| matches!(mode, VolumeMode::Maximum | VolumeMode::Minimum | VolumeMode::Average);
        FieldKinds {
            walked: any(&|volume| !is_surface(volume.mode) && !is_layer(volume.mode)),
            surfaces: any(&|volume| is_surface(volume.mode)),
            projected: any(&|volume| is_layer(volume.mode)),
            lit: any(&|volume| volume.light != VolumeLight::None),
            shadowed: any(&|volume| volume.light == VolumeLight::Shadowed),
            labels: any(&|volume| volume.labels),
            numbers: any(&|volume| !volume.labels),
            steep: any(&|volume| volume.mode == VolumeMode::Gradient),
        }
    }

    /// The boxes around them, metres.
    pub fn boxes(&self) -> impl Iterator<Item = Aabb> {
        self.all.iter().map(|field| field.bounds())
    }

    /// The box around all, metres.
    pub fn bounds(&self) -> Aabb {
        self.boxes().fold(Aabb::EMPTY, |all, own| all.union(own))
    }

    /// The part of a tile in which some may be seen; none where there is no pixel. `bent`: rays may go anywhere.
    pub fn part(&self, view: &View, tile: PictureTile, bent: bool) -> Option<PictureTile> {
        let whole = PictureTile::whole(tile.size);
        if bent && !self.is_empty() {
            return Some(whole);
        }
        let of_field = |field: &Arc<PlacedField>| {
            let [low, high] = field.rectangle(view)?;
            let origin = DVec2::new(tile.origin[0].into(), tile.origin[1].into());
            let size = DVec2::new(tile.size[0].into(), tile.size[1].into());
            let [low, high] =
                [(low - origin).clamp(DVec2::ZERO, size).floor(), (high - origin).clamp(DVec2::ZERO, size).ceil()];
            let part = PictureTile {
                origin: [low.x as u32, low.y as u32],
                size: [(high.x - low.x) as u32, (high.y - low.y) as u32],
            };
            (!part.is_empty()).then_some(part)
        };
        self.all.iter().filter_map(of_field).reduce(PictureTile::around)
    }

    /// As shaders read them; `firsts` of each, and `texels` of all, as [`PlacedField::row`] has them.
    pub fn uniform(&self, view: &View, firsts: &[[u32; 2]], texels: [f64; 2], jittered: bool) -> layout::FieldTable {
        let mut made: layout::FieldTable = bytemuck::Zeroable::zeroed();
        made.count = self.all.len().min(MOST_VOLUMES) as u32;
        made.is_jittered = u32::from(jittered);
        made.step = self.all.iter().map(|field| field.step).fold(f64::INFINITY, f64::min) as f32;
        for (i, (field, first)) in self.all.iter().zip(firsts).take(MOST_VOLUMES).enumerate() {
            let ramp = i * RAMP_ENTRIES;
            made.each[i] = field.row(view, [first[0], first[1], ramp as u32], texels);
            made.each[i].object = self.first_object + i as u32;
            made.ramps[ramp..ramp + RAMP_ENTRIES].copy_from_slice(&field.entries);
        }
        made
    }
}
