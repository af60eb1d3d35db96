//! Thematic colour: an attribute, or what is measured, becomes a legend and a colour per object or face.
//!
//! Colours are the legend's, before light; [`relief`] says what light does to them.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    city::{CityModel, StringId, Strings, Value, shown::ShownObjects},
    lens::{
        breaks::{Classing, borders},
        color::{Srgb, parse_hex},
        effect_use::{EffectUse, Parameter},
        measures::{self, Measure},
        ramp::{MAX_CATEGORIES, RampColors, RampKind},
        relief,
        source::{Source, drawn, hint_for},
    },
    time::Moment,
};

/// Default colour of objects without a value: a grey no ramp holds.
const NO_DATA: Srgb = [168.0 / 255.0; 3];
/// Colour of categories beyond those that got one.
const OTHER: Srgb = [110.0 / 255.0; 3];
/// Default colour at or above the threshold: Okabe and Ito's vermillion.
const HIGHLIGHT: Srgb = [213.0 / 255.0, 94.0 / 255.0, 0.0];
/// Columns of a histogram.
const COLUMNS: usize = 26;

/// One line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// What it stands for: a category, `12 – 20`, `no data`.
    pub label: String,
    /// Its colour, sRGB 0..1.
    pub color: Srgb,
    /// Objects drawn in it; of what is measured of faces, faces.
    pub count: u64,
    /// What kind of line it is.
    pub kind: LegendKind,
}

/// Kinds of lines of a legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LegendKind {
    /// A class, a category, an end of a ramp.
    Value,
    /// All categories without a colour of their own.
    Other,
    /// Numbers at or above the threshold.
    Threshold,
    /// Objects without a value.
    NoData,
}

/// From a value to a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct ThematicScale {
    /// The attribute's name.
    pub attribute: String,
    /// What is measured, where no file has the attribute.
    pub measure: Option<&'static Measure>,
    /// How values become colours.
    pub rule: Rule,
    /// The lines of the legend: classes ascending or categories in order, then `no data` if there is any.
    /// A smooth ramp lists its two ends.
    pub legend: Vec<LegendEntry>,
    /// Colour of objects without a value.
    pub no_data: Srgb,
    /// Numbers at or above `.0` take the colour `.1`.
    pub threshold: Option<(f64, Srgb)>,
    /// How far light moves lightness to either side ([`relief`]).
    pub relief: f32,
    /// Whether the legend says how many objects its lines have.
    pub counts: bool,
    /// How many objects there are in columns of equal width along a smooth ramp; empty where nobody asked.
    pub histogram: Vec<u64>,
}

/// How values become colours.
#[derive(Clone, Debug, PartialEq)]
pub enum Rule {
    /// Numbers along a ramp.
    Ramp {
        /// Its colours, low to high.
        colors: RampColors,
        /// Value of its low end.
        min: f64,
        /// Value of its high end, ≥ min.
        max: f64,
    },
    /// Numbers in classes; class `i` holds `breaks[i-1] ≤ x < breaks[i]`.
    Classes {
        /// Inner borders, ascending.
        breaks: Vec<f64>,
        /// One colour per class: one more than borders.
        colors: Vec<Srgb>,
    },
    /// Texts and booleans.
    Categories {
        /// Colour of each category.
        colors: FxHashMap<String, Srgb>,
    },
}

/// Why there is no scale.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ThematicError {
    /// No object of the city has it.
    #[error("no object has the attribute \"{0}\"{1}")]
    UnknownAttribute(String, String),
}

/// Numbers that exporters write where there is no value.
const SENTINELS: [f64; 3] = [-9999.0, -99_999.0, -999_999.0];
/// From here on a number says that there is none: the largest f32s and f64s.
const SENTINEL: f64 = 1e38;

/// Whether a number stands for no value: −9999 and the like, ±3.4e38.
fn is_sentinel(number: f64) -> bool {
    number.abs() >= SENTINEL || SENTINELS.contains(&number)
}

/// The number a value stands for: itself, a text that is a number, or the year of an ISO date (`1931-05-01`). None for numbers by which
/// exporters say that there is no value.
pub fn number_of(value: Value, strings: &Strings) -> Option<f64> {
    written_number(value, strings).filter(|number| !is_sentinel(*number))
}

/// Numbers of drawn objects that stand for no value of an attribute: how many objects have each, those of most first.
pub fn sentinels(model: &CityModel, attribute: &str) -> Vec<(f64, u64)> {
    let Some(id) = model.strings.find(attribute) else { return Vec::new() };
    let numbers = drawn(model).filter_map(|object| written_number(model.attribute(object, id)?, &model.strings));
    let mut counts: FxHashMap<u64, u64> = FxHashMap::default();
    numbers.filter(|number| is_sentinel(*number)).for_each(|number| *counts.entry(number.to_bits()).or_default() += 1);
    let mut all: Vec<(f64, u64)> = counts.into_iter().map(|(bits, count)| (f64::from_bits(bits), count)).collect();
    all.sort_by(|(x, few), (y, many)| many.cmp(few).then(x.total_cmp(y)));
    all
}

fn written_number(value: Value, strings: &Strings) -> Option<f64> {
    match value {
        Value::Integer(i) => Some(i as f64),
        Value::Number(n) => Some(n).filter(|n| n.is_finite()),
        Value::String(id) => {
            let text = strings.get(id).trim();
            text.parse::<f64>().ok().filter(|n| n.is_finite()).or_else(|| year_of(text))
        }
        _ => None,
    }
}

/// The year of `YYYY-MM-DD`, also with a time after it.
fn year_of(text: &str) -> Option<f64> {
    let date = text.get(..10)?.as_bytes();
    let shaped = date.iter().enumerate().all(|(i, b)| if i == 4 || i == 7 { *b == b'-' } else { b.is_ascii_digit() });
    let ends = text.len() == 10 || !text.as_bytes()[10].is_ascii_digit();
    if shaped && ends { text.get(..4)?.parse().ok() } else { None }
}

/// The category a value belongs to; `None` for no value.
pub fn category_of(value: Value, strings: &Strings) -> Option<String> {
    let text = match value {
        Value::Null => return None,
        Value::Boolean(b) => b.to_string(),
        Value::Integer(i) => i.to_string(),
        Value::Number(n) => n.to_string(),
        Value::String(id) | Value::Array(id) | Value::Object(id) => strings.get(id).to_owned(),
    };
    Some(text).filter(|t| !t.is_empty())
}

impl ThematicScale {
    /// The scale of a `thematic` effect for the objects of `model` that are drawn by default.
    ///
    /// # Errors
    /// No object has the attribute, and no measure is called so.
    pub fn new(model: &CityModel, used: &EffectUse) -> Result<Self, ThematicError> {
        let name = used.text("attribute").unwrap_or_default();
        let unknown = || ThematicError::UnknownAttribute(name.to_owned(), hint_for(model, name));
        let source = Source::find(model, name).ok_or_else(unknown)?;
        let values = source.values(model);
        if matches!(source, Source::Attribute(_)) && values.iter().all(Option::is_none) {
            return Err(unknown());
        }
        let threshold = used.number("threshold").map(|at| (at, used.color("highlight").unwrap_or(HIGHLIGHT)));
        let is_given = |v: &Value| *v != Value::Null && !written_number(*v, &model.strings).is_some_and(is_sentinel);
        let given: Vec<Value> = values.iter().flatten().copied().filter(is_given).collect();
        let mut numbers: Vec<f64> = given.iter().filter_map(|v| number_of(*v, &model.strings)).collect();
        numbers.sort_unstable_by(f64::total_cmp);
        // A few texts like "unknown" among numbers are missing data, not categories.
        let is_numeric = !numbers.is_empty() && numbers.len() * 10 >= given.len() * 9;
        let wanted = match used.parameters.get("categories") {
            Some(Parameter::Texts(list)) => Some(list.as_slice()),
            _ => None,
        };
        let asks_for_numbers = ["scale", "breaks", "min", "max", "threshold"];
        let are_codes =
            are_codes(&given, &model.strings) && !asks_for_numbers.iter().any(|key| used.parameters.contains_key(*key));
        let measure = match source {
            Source::Measure(measure) => Some(measure),
            _ => None,
        };
        let is_direction = measure.is_some_and(|measure| measure.what.is_direction());
        let rule = if is_numeric && wanted.is_none() && !are_codes {
            number_rule(&numbers, used, is_direction)
        } else {
            category_rule(&given, &model.strings, wanted, used)
        };
        let no_data = used.color("no_data").unwrap_or(NO_DATA);
        let mut scale = Self {
            attribute: name.to_owned(),
            measure,
            rule,
            legend: Vec::new(),
            no_data,
            threshold,
            relief: 0.0,
            counts: used.boolean("counts").unwrap_or(false),
            histogram: Vec::new(),
        };
        scale.legend = scale.counted(&values, &model.strings, wanted);
        if used.boolean("histogram") == Some(true) {
            scale.histogram = scale.columns(&numbers);
        }
        let relief = relief::of(&scale.told_apart()) * used.number("relief").unwrap_or(1.0) as f32;
        scale.relief = relief.clamp(0.0, MOST_RELIEF);
        Ok(scale)
    }

    /// The colours that must not be taken for each other: the legend's, and of a smooth ramp a few along it.
    fn told_apart(&self) -> Vec<Srgb> {
        let entries = self.legend.iter().map(|entry| entry.color);
        match &self.rule {
            Rule::Ramp { colors, .. } => {
                let others =
                    self.legend.iter().filter(|entry| entry.kind != LegendKind::Value).map(|entry| entry.color);
                others.chain(colors.classes(relief::STEPS_OF_SMOOTH)).collect()
            }
            _ => entries.collect(),
        }
    }

    /// How many numbers there are in each column along a smooth ramp.
    fn columns(&self, numbers: &[f64]) -> Vec<u64> {
        let Rule::Ramp { min, max, .. } = self.rule else { return Vec::new() };
        let mut columns = vec![0; COLUMNS];
        for n in numbers {
            let share = ((n - min) / (max - min)).clamp(0.0, 1.0);
            if share.is_finite() {
                columns[((share * COLUMNS as f64) as usize).min(COLUMNS - 1)] += 1;
            }
        }
        columns
    }

    /// Whether its values are directions: 0 and 360 are one.
    pub fn is_direction(&self) -> bool {
        self.measure.is_some_and(|measure| measure.what.is_direction())
    }

    /// The colour of a value, sRGB 0..1.
    pub fn color_of(&self, value: Option<Value>, strings: &Strings) -> Srgb {
        let Some(value) = value.filter(|v| *v != Value::Null) else { return self.no_data };
        match &self.rule {
            Rule::Categories { colors } => match category_of(value, strings) {
                Some(text) => colors.get(&text).copied().unwrap_or(OTHER),
                None => self.no_data,
            },
            _ => number_of(value, strings).map_or(self.no_data, |n| self.color_of_number(n)),
        }
    }

    /// The colour of a number, sRGB 0..1; categories have none.
    pub fn color_of_number(&self, n: f64) -> Srgb {
        match (&self.rule, self.threshold) {
            (Rule::Ramp { .. } | Rule::Classes { .. }, Some((at, highlight))) if n >= at => highlight,
            (Rule::Ramp { colors, min, max }, _) => {
                colors.at(if max > min { ((n - min) / (max - min)).clamp(0.0, 1.0) } else { 0.5 })
            }
            (Rule::Classes { breaks, colors }, _) => colors[breaks.partition_point(|b| *b <= n)],
            (Rule::Categories { .. }, _) => self.no_data,
        }
    }

    /// The colour of every object of the city, by index, sRGB 0..1.
    pub fn object_colors(&self, model: &CityModel) -> Vec<Srgb> {
        let source = Source::find(model, &self.attribute).filter(|source| !source.is_of_faces());
        match source {
            Some(source) => source.all_values(model).into_iter().map(|v| self.color_of(v, &model.strings)).collect(),
            None => vec![self.no_data; model.objects.len()],
        }
    }

    /// The colour of every direction in which each object of a city has faces: its packed normal, and the colour of most of their area.
    fn face_colors(&self, model: &CityModel) -> Vec<Vec<(u32, Srgb)>> {
        let mut found = vec![Vec::new(); model.objects.len()];
        let Some(source) = Source::find(model, &self.attribute).filter(Source::is_of_faces) else { return found };
        let colors: Vec<Srgb> =
            source.all_values(model).into_iter().map(|v| self.color_of(v, &model.strings)).collect();
        let mut at = 0;
        for way in model.measured_faces().chunk_by(|a, b| (a.object, a.normal) == (b.object, b.normal)) {
            let widest = (0..way.len()).rev().max_by(|i, j| way[*i].area.total_cmp(&way[*j].area)).unwrap_or(0);
            found[way[0].object as usize].push((way[0].normal, colors[at + widest]));
            at += way.len();
        }
        found
    }

    /// What `shaders/effect/thematic.wgsl` reads: the relief, what is coloured, and colours, sRGB bytes: of all objects of the cities one after
    /// the other, or of steps of what follows from where faces look, or a table of faces: the colour of none, of every object where its faces begin,
    /// and at last where all end, then of each its normal, ascending, and its colour.
    pub fn for_shader(&self, models: &[&CityModel]) -> Vec<u32> {
        let bytes = |color: Srgb| {
            let [r, g, b] = color.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
            u32::from_le_bytes([r, g, b, 255])
        };
        let relief = self.relief.to_bits();
        let steps = self.measure.filter(|measure| measure.what.is_in_steps());
        if let Some(measure) = steps {
            let colors = measure.what.steps(|n| self.color_of_number(n), self.no_data);
            return [relief, measure.what.word()].into_iter().chain(colors.into_iter().map(bytes)).collect();
        }
        let is_of_faces = |model: &&CityModel| Source::find(model, &self.attribute).is_some_and(|s| s.is_of_faces());
        if !models.iter().any(is_of_faces) {
            let colors = models.iter().flat_map(|model| self.object_colors(model));
            let mut words: Vec<u32> = [relief, 0].into_iter().chain(colors.map(bytes)).collect();
            self.put_histories(models, &mut words, bytes);
            return words;
        }
        let faces: Vec<Vec<(u32, Srgb)>> = models.iter().flat_map(|model| self.face_colors(model)).collect();
        let mut words = vec![relief, measures::OF_FACES, bytes(self.no_data)];
        let mut begin = 0;
        for own in &faces {
            words.push(begin);
            begin += own.len() as u32;
        }
        words.push(begin);
        let at = words.len() as u32 - 2;
        words.insert(2, at + 1);
        words.extend(faces.into_iter().flatten().flat_map(|(normal, color)| [normal, bytes(color)]));
        words
    }

    /// Has the colours of objects whose attribute changes over time lead to lists behind all (`lib/varying.wgsl`).
    fn put_histories(&self, models: &[&CityModel], words: &mut Vec<u32>, bytes: impl Fn(Srgb) -> u32) {
        let mut first = 2;
        for model in models {
            let name = model.strings.find(&self.attribute).filter(|name| model.histories.contains_key(name));
            for object in 0..model.objects.len() as u32 {
                let Some(own) = name.and_then(|name| model.history_of(object, name)) else { continue };
                // A byte less than 2^32 is left: of more there is the last value alone.
                let place = words.len();
                if place >= 1 << 24 {
                    return;
                }
                words[first + object as usize] = place as u32;
                // Before the first it has none.
                let before = own.first().filter(|(begin, _)| begin.is_some()).map(|_| (None, None));
                let all: Vec<_> = before.into_iter().chain(own.iter().copied()).collect();
                words.push(all.len() as u32);
                for (begin, value) in all {
                    words.extend(begin.map_or(Moment::TIMELESS, Moment::words));
                    words.push(bytes(self.color_of(value, &model.strings)));
                }
            }
            first += model.objects.len();
        }
    }

    /// Counts objects of another data set, too, which are shown beside the city.
    pub fn count_beside(&mut self, shown: &ShownObjects) {
        let ShownObjects { model, objects } = shown;
        if Source::find(model, &self.attribute).is_some_and(|source| source.is_of_faces()) {
            return;
        }
        let colors = self.object_colors(model);
        objects.iter().for_each(|&object| self.count(colors[object as usize]));
    }

    /// Counts the objects of the city by the values that they have now.
    pub fn count_now(&mut self, now: &CityModel) {
        let Some(source) = Source::find(now, &self.attribute).filter(|source| !source.is_of_faces()) else { return };
        self.legend.iter_mut().for_each(|entry| entry.count = 0);
        for value in source.values(now) {
            self.count(self.color_of(value, &now.strings));
        }
    }

    /// Counts one more of a colour.
    fn count(&mut self, color: Srgb) {
        if let Some(entry) = self.legend.iter_mut().find(|entry| entry.color == color) {
            entry.count += 1;
            return;
        }
        let others = [(OTHER, "other", LegendKind::Other), (self.no_data, "no data", LegendKind::NoData)];
        if let Some((_, label, kind)) = others.into_iter().find(|(own, ..)| *own == color) {
            self.legend.push(LegendEntry { label: label.into(), color, count: 1, kind });
        }
    }

    fn counted(&self, values: &[Option<Value>], strings: &Strings, wanted: Option<&[String]>) -> Vec<LegendEntry> {
        let mut legend = match &self.rule {
            Rule::Ramp { min, max, .. } => {
                [*min, *max].map(|n| (short(n), self.color_of_number(n), LegendKind::Value)).to_vec()
            }
            Rule::Classes { breaks, colors } => {
                let label = |i: usize| match (i.checked_sub(1).map(|j| breaks[j]), breaks.get(i)) {
                    (None, Some(b)) => format!("< {}", written(*b)),
                    (Some(a), Some(b)) => format!("{} – {}", written(a), written(*b)),
                    (Some(a), None) => format!("≥ {}", written(a)),
                    (None, None) => "all".into(),
                };
                colors.iter().enumerate().map(|(i, c)| (label(i), *c, LegendKind::Value)).collect()
            }
            Rule::Categories { colors } => {
                let mut counts: FxHashMap<String, u64> = FxHashMap::default();
                values
                    .iter()
                    .flatten()
                    .filter_map(|v| category_of(*v, strings))
                    .for_each(|c| *counts.entry(c).or_default() += 1);
                let mut list: Vec<(String, Srgb, LegendKind)> =
                    colors.iter().map(|(k, c)| (k.clone(), *c, LegendKind::Value)).collect();
                let place = |k: &str| wanted.and_then(|w| w.iter().position(|x| x == k)).unwrap_or(usize::MAX);
                list.sort_by(|a, b| {
                    let count = |k: &str| counts.get(k).copied().unwrap_or(0);
                    place(&a.0).cmp(&place(&b.0)).then(count(&b.0).cmp(&count(&a.0))).then(a.0.cmp(&b.0))
                });
                if counts.keys().any(|k| !colors.contains_key(k)) {
                    list.push(("other".into(), OTHER, LegendKind::Other));
                }
                list
            }
        };
        if let (Some((at, color)), false) = (self.threshold, matches!(self.rule, Rule::Categories { .. })) {
            legend.push((format!("≥ {} (threshold)", written(at)), color, LegendKind::Threshold));
        }
        if values.iter().any(|v| self.color_of(*v, strings) == self.no_data) {
            legend.push(("no data".into(), self.no_data, LegendKind::NoData));
        }
        let mut by_color: FxHashMap<[u32; 3], u64> = FxHashMap::default();
        for value in values {
            *by_color.entry(self.color_of(*value, strings).map(f32::to_bits)).or_default() += 1;
        }
        let count = |c: Srgb| by_color.get(&c.map(f32::to_bits)).copied().unwrap_or(0);
        legend.into_iter().map(|(label, color, kind)| LegendEntry { count: count(color), label, color, kind }).collect()
    }
}

/// The most that a person may ask light to move lightness, to either side.
const MOST_RELIEF: f32 = 0.4;

/// Names of all attributes of objects, each once.
pub fn attribute_names(model: &CityModel) -> Vec<&str> {
    let mut ids: Vec<_> =
        (0..model.objects.len() as u32).flat_map(|o| model.attributes_of(o)).map(|a| a.name).collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter().map(|id| model.strings.get(id)).collect()
}

/// Whether values are codes and no amounts: texts of digits, few different ones, each several times.
fn are_codes(given: &[Value], strings: &Strings) -> bool {
    let code = |value: &Value| match value {
        Value::String(id) => Some(*id).filter(|id| {
            let text = strings.get(*id);
            !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
        }),
        _ => None,
    };
    let codes: Option<FxHashSet<StringId>> = given.iter().map(code).collect();
    codes.is_some_and(|codes| codes.len() <= MAX_CATEGORIES && given.len() >= 4 * codes.len())
}

/// The colours of a scale: a user's, those of a ramp, or the default of what is coloured.
fn ramp_colors(used: &EffectUse, default: &str) -> RampColors {
    let colors = match used.parameters.get("colors") {
        Some(Parameter::Texts(list)) => {
            let kind = if default == CATEGORIES { RampKind::Categorical } else { RampKind::Sequential };
            RampColors::own(kind, list.iter().filter_map(|text| parse_hex(text)).collect())
        }
        _ => RampColors::named(used.text("ramp").unwrap_or(default)),
    };
    if used.boolean("reverse") == Some(true) { colors.reversed() } else { colors }
}

/// Default ramps of numbers, directions and texts.
const NUMBERS: &str = "viridis";
const DIRECTIONS: &str = "roma-o";
const CATEGORIES: &str = "okabe-ito";

fn number_rule(sorted: &[f64], used: &EffectUse, is_direction: bool) -> Rule {
    let colors = ramp_colors(used, if is_direction { DIRECTIONS } else { NUMBERS });
    let (low, high) = match is_direction {
        true => (0.0, 360.0),
        false => (sorted[0], sorted[sorted.len() - 1]),
    };
    let min = used.number("min").unwrap_or(low);
    let max = used.number("max").unwrap_or(high).max(min);
    if let Some(Parameter::Numbers(breaks)) = used.parameters.get("breaks") {
        return Rule::Classes { colors: colors.classes(breaks.len() + 1), breaks: breaks.clone() };
    }
    let own = match used.parameters.get("colors") {
        Some(Parameter::Texts(list)) => Some(list.len().clamp(2, MOST_CLASSES) as f64),
        _ => None,
    };
    let classes = used.number("classes").or(own).unwrap_or(DEFAULT_CLASSES) as usize;
    let how = match used.text("scale") {
        Some("equal") => Classing::Equal,
        Some("quantile") => Classing::Quantile,
        Some("natural") => Classing::Natural,
        Some("deviation") => Classing::Deviation,
        _ => return Rule::Ramp { colors, min, max },
    };
    let within = sorted.partition_point(|n| *n < min)..sorted.partition_point(|n| *n <= max);
    let within = sorted.get(within).unwrap_or_default();
    let breaks = match how {
        // Of the whole range, whatever is in it.
        Classing::Equal => equal(within, [min, max], classes),
        how => borders(within, how, classes),
    };
    Rule::Classes { colors: colors.classes(breaks.len() + 1), breaks }
}

/// The number of classes of an effect that says none, and the most.
const DEFAULT_CLASSES: f64 = 5.0;
const MOST_CLASSES: usize = 12;

/// Borders of classes of equal width of a range whose ends count as numbers.
fn equal(within: &[f64], [min, max]: [f64; 2], classes: usize) -> Vec<f64> {
    let first = within.first().is_none_or(|n| *n > min).then_some(min);
    let last = within.last().is_none_or(|n| *n < max).then_some(max);
    let numbers: Vec<f64> = first.into_iter().chain(within.iter().copied()).chain(last).collect();
    borders(&numbers, Classing::Equal, classes)
}

fn category_rule(given: &[Value], strings: &Strings, wanted: Option<&[String]>, used: &EffectUse) -> Rule {
    let names: Vec<String> = match wanted {
        Some(list) => list.to_vec(),
        None => {
            let mut counts: FxHashMap<String, u64> = FxHashMap::default();
            given.iter().filter_map(|v| category_of(*v, strings)).for_each(|c| *counts.entry(c).or_default() += 1);
            let mut list: Vec<(String, u64)> = counts.into_iter().collect();
            list.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
            list.into_iter().map(|(name, _)| name).collect()
        }
    };
    let names: Vec<String> = names.into_iter().take(MAX_CATEGORIES).collect();
    let colors = ramp_colors(used, CATEGORIES).classes(names.len());
    Rule::Categories { colors: names.into_iter().zip(colors).collect() }
}

/// A border of classes as legends write it: as it is, in as many digits as say it; where that are many, in few. From five digits on with thin
/// spaces between groups of three.
fn written(n: f64) -> String {
    let whole = n.to_string();
    let text = if whole.len() <= 9 { whole } else { short(n) };
    let digits = text.trim_start_matches('-');
    let (before, after) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let mut out = if n < 0.0 { "−".to_owned() } else { String::new() };
    for (i, digit) in before.chars().enumerate() {
        if i > 0 && before.len() > 4 && (before.len() - i).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out + after
}

/// A number in few digits for a legend: at most three behind the point, none for large ones.
fn short(n: f64) -> String {
    let digits = if n.abs() >= 1000.0 {
        0
    } else if n.abs() >= 10.0 {
        1
    } else {
        3
    };
    let text = format!("{n:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::{
            decode_normal,
            load::{LoadOptions, Quiet, load},
            measured::{OfObject, azimuth_deg, slope_deg},
            test_city::add_building,
        },
        lens::{color::difference, ramp::ramp},
    };

    /// A city of objects without geometry, each with the attribute `a` (or without).
    fn city(values: &[Option<&str>], read: fn(&str, &mut Strings) -> Value) -> CityModel {
        let mut model = CityModel::default();
        let name = model.strings.intern("a");
        for (i, text) in values.iter().enumerate() {
            let value = text.map(|text| read(text, &mut model.strings));
            add_building(&mut model, format!("o{i}"), value.map(|value| (name, value)));
        }
        model
    }

    fn number(text: &str, _: &mut Strings) -> Value {
        Value::Number(text.parse().unwrap())
    }

    fn string(text: &str, strings: &mut Strings) -> Value {
        Value::String(strings.intern(text))
    }

    fn used(parameters: &[(&str, Parameter)]) -> EffectUse {
        let mut all: std::collections::BTreeMap<_, _> =
            parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
        all.entry("attribute".into()).or_insert_with(|| Parameter::Text("a".into()));
        EffectUse { effect: "thematic".into(), class: Default::default(), blend: None, weight: None, parameters: all }
    }

    #[test]
    fn a_ramp_runs_from_smallest_to_largest() {
        let model = city(&[Some("10"), Some("20"), None, Some("30")], number);
        let scale = ThematicScale::new(&model, &used(&[])).unwrap();
        let colors = scale.object_colors(&model);
        assert_eq!(colors, [ramp("viridis", 0.0), ramp("viridis", 0.5), NO_DATA, ramp("viridis", 1.0)]);
        let labels: Vec<&str> = scale.legend.iter().map(|e| e.label.as_str()).collect();
        assert_eq!(labels, ["10", "30", "no data"]);
    }

    #[test]
    fn breaks_quantiles_and_equal_classes() {
        let model = city(&[Some("1"), Some("2"), Some("3"), Some("100")], number);
        let breaks = |p: &[(&str, Parameter)]| match ThematicScale::new(&model, &used(p)).unwrap().rule {
            Rule::Classes { breaks, colors } => {
                assert_eq!(colors.len(), breaks.len() + 1);
                breaks
            }
            other => panic!("{other:?}"),
        };
        let word = |w: &str| Parameter::Text(w.into());
        assert_eq!(breaks(&[("breaks", Parameter::Numbers(vec![2.0, 50.0]))]), [2.0, 50.0]);
        assert_eq!(breaks(&[("scale", word("quantile")), ("classes", Parameter::Number(2.0))]), [3.0]);
        assert_eq!(breaks(&[("scale", word("equal")), ("classes", Parameter::Number(3.0))]), [34.0, 67.0]);
        let scale = ThematicScale::new(&model, &used(&[("breaks", Parameter::Numbers(vec![2.0, 50.0]))])).unwrap();
        let counts: Vec<u64> = scale.legend.iter().map(|e| e.count).collect();
        assert_eq!(counts, [1, 2, 1], "a value on a border belongs to the upper class");
    }

    #[test]
    fn quantiles_of_counts_that_do_not_divide_and_values_at_a_border() {
        let model = city(&[Some("7"), Some("1"), Some("5"), Some("3"), Some("2"), Some("6"), Some("4")], number);
        let word = |w: &str| Parameter::Text(w.into());
        let parts = |classes: f64, more: &[(&str, Parameter)]| {
            let own = [&[("scale", word("quantile")), ("classes", Parameter::Number(classes))], more].concat();
            let scale = ThematicScale::new(&model, &used(&own)).unwrap();
            let Rule::Classes { breaks, .. } = &scale.rule else { panic!("classes") };
            (breaks.clone(), scale.legend.iter().map(|entry| entry.count).collect::<Vec<u64>>())
        };
        // Of seven: two, two and three; one, two, two and two.
        assert_eq!(parts(3.0, &[]), (vec![3.0, 5.0], vec![2, 2, 3]));
        assert_eq!(parts(4.0, &[]), (vec![2.0, 4.0, 6.0], vec![1, 2, 2, 2]));
        // Those of 2 to 6 alone, both ends among them: five are two and three. What is beyond is in the end classes.
        let [low, high] = [("min", Parameter::Number(2.0)), ("max", Parameter::Number(6.0))];
        assert_eq!(parts(2.0, &[low, high]), (vec![4.0], vec![3, 4]));
    }

    #[test]
    fn texts_are_categories_most_frequent_first() {
        let model = city(&[Some("shop"), Some("home"), Some("home"), None], string);
        let scale = ThematicScale::new(&model, &used(&[])).unwrap();
        let legend: Vec<(&str, u64)> = scale.legend.iter().map(|e| (e.label.as_str(), e.count)).collect();
        assert_eq!(legend, [("home", 2), ("shop", 1), ("no data", 1)]);
        let category = crate::lens::ramp::category;
        assert_eq!(scale.object_colors(&model)[1], category(0));
        let chosen = used(&[("categories", Parameter::Texts(vec!["shop".into()]))]);
        let scale = ThematicScale::new(&model, &chosen).unwrap();
        assert_eq!(scale.object_colors(&model)[..2], [category(0), OTHER]);
        // As frequent: by the alphabet, in whatever order they come.
        let model = city(&[Some("mill"), Some("barn"), Some("shop"), Some("shop"), Some("kiosk")], string);
        let scale = ThematicScale::new(&model, &used(&[])).unwrap();
        let labels: Vec<&str> = scale.legend.iter().map(|e| e.label.as_str()).collect();
        assert_eq!(labels, ["shop", "barn", "kiosk", "mill"]);
        assert_eq!(scale.object_colors(&model), [3, 1, 0, 0, 2].map(category));
    }

    #[test]
    fn dates_and_numbers_in_texts_are_numbers() {
        let model = city(&[Some("1931-05-01"), Some("1951-01-01T00:00:00Z"), Some("1941")], string);
        let scale = ThematicScale::new(&model, &used(&[])).unwrap();
        assert_eq!(scale.object_colors(&model), [0.0, 1.0, 0.5].map(|t| ramp("viridis", t)));
        assert_eq!(year_of("1931-05-011"), None);
        assert_eq!(year_of("no-date-no"), None);
    }

    #[test]
    fn thresholds_highlight_and_unknown_names_are_guessed() {
        let model = city(&[Some("1"), Some("9")], number);
        let scale = ThematicScale::new(&model, &used(&[("threshold", Parameter::Number(5.0))])).unwrap();
        assert_eq!(scale.object_colors(&model)[1], HIGHLIGHT);
        let wrong = used(&[("attribute", Parameter::Text("A".into()))]);
        let message = ThematicScale::new(&model, &wrong).unwrap_err().to_string();
        assert_eq!(message, "no object has the attribute \"A\"; did you mean \"a\"?");
    }

    #[test]
    fn numbers_that_say_that_there_is_none_are_no_data() {
        let values = ["5", "25", "-9999", "3.4e38", "-3.402823e38", "-99999.0", "15", "-9999"];
        let model = city(&values.map(Some), |text, _| Value::Number(text.parse().expect("a number")));
        let scale = ThematicScale::new(&model, &used(&[])).expect("a scale");
        assert!(matches!(scale.rule, Rule::Ramp { min: 5.0, max: 25.0, .. }), "{:?}", scale.rule);
        let no_data = scale.legend.iter().find(|entry| entry.kind == LegendKind::NoData).expect("some have none");
        assert_eq!(no_data.count, 5);
        assert_eq!(scale.color_of(Some(Value::Integer(-9999)), &model.strings), NO_DATA);
        let found = sentinels(&model, "a");
        assert_eq!((found[0], found.len()), ((-9999.0, 2), 4));
        assert_eq!(sentinels(&model, "b"), []);
        // Numbers beside them are numbers.
        for number in [-9998.0, 9999.0, -999.0, 1e30] {
            assert_eq!(number_of(Value::Number(number), &model.strings), Some(number));
        }
    }

    #[test]
    fn own_colours_are_classes_or_a_ramp() {
        let model = city(&["0", "1", "2", "3", "4"].map(Some), number);
        let word = |w: &str| Parameter::Text(w.into());
        let colors = ("colors", Parameter::Texts(["#ff0000", "#00ff00", "#0000ff"].map(String::from).to_vec()));
        let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let of = |more: &[(&str, Parameter)]| {
            let all = [std::slice::from_ref(&colors), more].concat();
            ThematicScale::new(&model, &used(&all)).unwrap().object_colors(&model)
        };
        let smooth = of(&[]);
        assert_eq!([smooth[0], smooth[2], smooth[4]], [red, green, blue]);
        assert_eq!(of(&[("scale", word("equal"))]), [red, red, green, blue, blue], "as many classes as colours");
        let two = of(&[("scale", word("equal")), ("classes", Parameter::Number(2.0))]);
        assert_eq!(two, [red, red, blue, blue, blue]);
        assert_eq!(of(&[("breaks", Parameter::Numbers(vec![1.0, 2.0]))]), [red, green, blue, blue, blue]);
        let turned = of(&[("reverse", Parameter::Boolean(true)), ("scale", word("equal"))]);
        assert_eq!(turned, [blue, blue, green, red, red]);
        let texts = city(&["a", "b", "c", "a"].map(Some), string);
        let scale = ThematicScale::new(&texts, &used(&[colors])).unwrap();
        assert_eq!(scale.object_colors(&texts), [red, green, blue, red]);
    }

    #[test]
    fn codes_in_texts_are_categories_unless_numbers_are_asked_for() {
        let codes: Vec<Option<&str>> = ["1000", "1030", "1000", "3100"].repeat(6).into_iter().map(Some).collect();
        let model = city(&codes, string);
        let scale = ThematicScale::new(&model, &used(&[])).unwrap();
        let labels: Vec<&str> = scale.legend.iter().map(|e| e.label.as_str()).collect();
        assert_eq!(labels, ["1000", "1030", "3100"]);
        let asked = used(&[("scale", Parameter::Text("continuous".into()))]);
        assert!(matches!(
            ThematicScale::new(&model, &asked).unwrap().rule,
            Rule::Ramp { min: 1000.0, max: 3100.0, .. }
        ));
        // Amounts, and numbers that differ from object to object, are none.
        let years: Vec<String> = (1900..1960).map(|year| year.to_string()).collect();
        let model = city(&years.iter().map(|y| Some(y.as_str())).collect::<Vec<_>>(), string);
        assert!(matches!(ThematicScale::new(&model, &used(&[])).unwrap().rule, Rule::Ramp { .. }));
    }

    #[test]
    fn what_is_measured_has_colours_unless_the_file_has_such_an_attribute() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        let of = |name: &str| ThematicScale::new(&model, &used(&[("attribute", Parameter::Text(name.into()))]));
        let heights = model.measured_of_objects(OfObject::Height);
        let scale = of("geometry:height").unwrap();
        for (object, color) in scale.object_colors(&model).into_iter().enumerate() {
            let n = heights[object];
            assert_eq!(color, if n.is_finite() { scale.color_of_number(n) } else { NO_DATA }, "{n}");
        }
        // Directions go round: their ends are alike, whatever values there are.
        let direction = of("geometry:azimuth").unwrap();
        assert!(direction.is_direction() && matches!(direction.rule, Rule::Ramp { min: 0.0, max: 360.0, .. }));
        assert!(difference(direction.color_of_number(0.0), direction.color_of_number(360.0)) < 0.02);
        let message = of("geometry:hieght").unwrap_err().to_string();
        assert_eq!(message, "no object has the attribute \"geometry:hieght\"; did you mean \"geometry:height\"?");
        let mut own = city(&[Some("7")], number);
        own.attributes[0].name = own.strings.intern("geometry:height");
        let used = used(&[("attribute", Parameter::Text("geometry:height".into()))]);
        assert_eq!(ThematicScale::new(&own, &used).unwrap().measure, None);
    }

    #[test]
    fn the_steps_of_faces_are_their_slopes_and_directions() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        for name in ["surface:slope", "surface:azimuth"] {
            let scale = ThematicScale::new(&model, &used(&[("attribute", Parameter::Text(name.into()))])).unwrap();
            let words = scale.for_shader(&[&model]);
            assert_eq!(words.len(), 2 + measures::STEPS + 1);
            assert_eq!((f32::from_bits(words[0]), words[1] > 0), (scale.relief, true));
            let counted: u64 = scale.legend.iter().filter(|e| e.kind == LegendKind::NoData).map(|e| e.count).sum();
            let level =
                model.measured_faces().iter().filter(|f| azimuth_deg(decode_normal(f.normal)).is_none()).count();
            assert_eq!(counted, if name == "surface:azimuth" { level as u64 } else { 0 });
            for face in model.measured_faces() {
                let normal = decode_normal(face.normal);
                let share = match name {
                    "surface:slope" => Some(slope_deg(normal) / 90.0),
                    _ => azimuth_deg(normal).map(|deg| deg / 360.0),
                };
                let step = share.map_or(measures::STEPS, |share| ((share * 1440.0) as usize).min(1439));
                let color = words[2 + step].to_le_bytes();
                let exact = scale.color_of(
                    share.map(|s| Value::Number(s * if name == "surface:slope" { 90.0 } else { 360.0 })),
                    &model.strings,
                );
                let close = (0..3).all(|k| (f32::from(color[k]) / 255.0 - exact[k]).abs() < 0.02);
                assert!(close, "{name} {share:?}: {color:?} {exact:?}");
            }
        }
    }

    #[test]
    fn attributes_of_surfaces_are_those_of_faces_or_of_the_largest() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/citydata/semantics.city.json");
        let model = load(&[path.into()], &LoadOptions::default(), &Quiet).unwrap();
        let of = |name: &str| ThematicScale::new(&model, &used(&[("attribute", Parameter::Text(name.into()))]));
        // Walls, and the window that is part of one, are white; a roof and a floor are not.
        let scale = of("surface:colour").unwrap();
        let white = model.measured_faces().iter().filter(|face| face.detail != crate::city::NONE).count();
        let labels: Vec<(&str, bool)> = scale.legend.iter().map(|e| (e.label.as_str(), e.count > 0)).collect();
        assert_eq!(labels, [("white", true), ("no data", true)]);
        assert_eq!(scale.legend.iter().map(|e| e.count).sum::<u64>(), model.measured_faces().len() as u64);
        assert!(white > 4 && scale.legend[0].count == 5, "{:?}", scale.legend);
        let words = scale.for_shader(&[&model]);
        let grey = u32::from_le_bytes([168, 168, 168, 255]);
        let (at, count) = (2 + words[2] as usize, model.objects.len());
        assert_eq!((words[1], at, words[3]), (measures::OF_FACES, 5 + count, grey));
        let ways = words[4 + count] as usize;
        assert_eq!(words.len(), at + 2 * ways);
        let normals: Vec<u32> = (0..ways).map(|i| words[at + 2 * i]).collect();
        assert!(normals.is_sorted() && normals.len() == 6);
        for (i, normal) in normals.iter().enumerate() {
            let is_upright = decode_normal(*normal).z.abs() < 0.1;
            assert_eq!(words[at + 2 * i + 1] != grey, is_upright, "{}", decode_normal(*normal));
        }
        // Of the object it is that of most area, and no object has it itself.
        let scale = of("colour").unwrap();
        let house = model.find_object("house").unwrap() as usize;
        assert_eq!(scale.object_colors(&model)[house], scale.legend[0].color);
        assert_eq!(scale.for_shader(&[&model])[1], 0);
        let message = of("surface:color").unwrap_err().to_string();
        assert!(message.ends_with("did you mean \"surface:colour\"?"), "{message}");
        // All faces of one way are one area.
        let area = of("surface:area").unwrap();
        assert!(area.legend.iter().all(|e| e.label != "no data"), "{:?}", area.legend);
        assert_eq!(area.for_shader(&[&model]).len(), words.len());
    }

    #[test]
    fn relief_is_less_where_colours_are_more_alike_and_as_a_person_says() {
        let model = city(&["0", "1", "2", "3", "4", "5", "6", "7", "8"].map(Some), number);
        let relief = |more: &[(&str, Parameter)]| {
            let scale = [("scale", Parameter::Text("equal".into()))];
            ThematicScale::new(&model, &used(&[&scale[..], more].concat())).unwrap().relief
        };
        let classes = |n: f64| ("classes", Parameter::Number(n));
        assert!(relief(&[classes(9.0)]) < relief(&[classes(5.0)]) && relief(&[classes(9.0)]) > 0.02);
        assert_eq!(relief(&[classes(5.0), ("relief", Parameter::Number(0.0))]), 0.0);
        let half = relief(&[classes(5.0), ("relief", Parameter::Number(0.5))]);
        assert!((half - 0.5 * relief(&[classes(5.0)])).abs() < 1e-6);
    }

    #[test]
    fn numbers_are_short_in_legends() {
        for (n, text) in [(0.0, "0"), (12.34, "12.3"), (1931.0, "1931"), (0.125, "0.125"), (100.0, "100"), (20.0, "20")]
        {
            assert_eq!(short(n), text);
        }
        for (n, text) in [
            (0.1, "0.1"),
            (1965.0, "1965"),
            (-2.5, "−2.5"),
            (0.123_456_789_01, "0.123"),
            (-12_500.5, "−12\u{2009}500.5"),
            (1e6, "1\u{2009}000\u{2009}000"),
        ] {
            assert_eq!(written(n), text);
        }
    }
}
