//! Thematic colour: an attribute becomes a legend and a colour per object.
//!
//! Colours are the legend's, before light. The renderer lets light change lightness alone and leaves hue and chroma
//! (architecture, decision 13).

use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, Strings, Value},
    lens::{
        color::Srgb,
        effect_use::{EffectUse, Parameter},
        nearest::did_you_mean,
        ramp::{MAX_CATEGORIES, category, ramp},
    },
};

/// Default colour of objects without a value: a grey no ramp holds.
const NO_DATA: Srgb = [168.0 / 255.0; 3];
/// Colour of categories beyond those that got one.
const OTHER: Srgb = [110.0 / 255.0; 3];
/// Default colour at or above the threshold: Okabe and Ito's vermillion.
const HIGHLIGHT: Srgb = [213.0 / 255.0, 94.0 / 255.0, 0.0];

/// One line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// What it stands for: a category, `12 – 20`, `no data`.
    pub label: String,
    /// Its colour, sRGB 0..1.
    pub color: Srgb,
    /// Objects drawn in it.
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
    /// How values become colours.
    pub rule: Rule,
    /// The lines of the legend: classes ascending or categories in order, then `no data` if there is any.
    /// A smooth ramp lists its two ends.
    pub legend: Vec<LegendEntry>,
    /// Colour of objects without a value.
    pub no_data: Srgb,
    /// Numbers at or above `.0` take the colour `.1`.
    pub threshold: Option<(f64, Srgb)>,
}

/// How values become colours.
#[derive(Clone, Debug, PartialEq)]
pub enum Rule {
    /// Numbers along a ramp.
    Ramp {
        /// The ramp's name ([`crate::lens::ramp::NAMES`]).
        ramp: String,
        /// Whether it runs from high to low.
        reverse: bool,
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
    /// The scale of a `thematic` effect for the objects of `model` that are drawn (have a geometry).
    pub fn new(model: &CityModel, used: &EffectUse) -> Result<Self, ThematicError> {
        let name = used.text("attribute").unwrap_or_default();
        let values: Vec<Option<Value>> = match model.strings.find(name) {
            Some(id) => drawn(model).map(|object| model.attribute(object, id)).collect(),
            None => Vec::new(),
        };
        if values.iter().all(Option::is_none) {
            return Err(ThematicError::UnknownAttribute(name.to_owned(), did_you_mean(name, attribute_names(model))));
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
        let rule = if is_numeric && wanted.is_none() {
            number_rule(&numbers, used)
        } else {
            category_rule(&given, &model.strings, wanted)
        };
        let no_data = used.color("no_data").unwrap_or(NO_DATA);
        let mut scale = Self { attribute: name.to_owned(), rule, legend: Vec::new(), no_data, threshold };
        scale.legend = scale.counted(&values, &model.strings, wanted);
        Ok(scale)
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
            (Rule::Ramp { ramp: name, reverse, min, max }, _) => {
                let t = if max > min { ((n - min) / (max - min)).clamp(0.0, 1.0) } else { 0.5 };
                ramp(name, if *reverse { 1.0 - t } else { t })
            }
            (Rule::Classes { breaks, colors }, _) => colors[breaks.partition_point(|b| *b <= n)],
            (Rule::Categories { .. }, _) => self.no_data,
        }
    }

    /// The colour of every object of the city, by index, sRGB 0..1.
    pub fn object_colors(&self, model: &CityModel) -> Vec<Srgb> {
        let id = model.strings.find(&self.attribute);
        let value = |object| id.and_then(|id| model.attribute(object, id));
        (0..model.objects.len() as u32).map(|object| self.color_of(value(object), &model.strings)).collect()
    }

    fn counted(&self, values: &[Option<Value>], strings: &Strings, wanted: Option<&[String]>) -> Vec<LegendEntry> {
        let mut legend = match &self.rule {
            Rule::Ramp { min, max, .. } => {
                [*min, *max].map(|n| (short(n), self.color_of_number(n), LegendKind::Value)).to_vec()
            }
            Rule::Classes { breaks, colors } => {
                let label = |i: usize| match (i.checked_sub(1).map(|j| breaks[j]), breaks.get(i)) {
                    (None, Some(b)) => format!("< {}", short(*b)),
                    (Some(a), Some(b)) => format!("{} – {}", short(a), short(*b)),
                    (Some(a), None) => format!("≥ {}", short(a)),
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
            legend.push((format!("≥ {} (threshold)", short(at)), color, LegendKind::Threshold));
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

/// Objects with a geometry, or all where none has any.
fn drawn(model: &CityModel) -> impl Iterator<Item = u32> + '_ {
    let any = !model.geometries.is_empty();
    let shown = move |(_, o): &(usize, &crate::city::CityObject)| !any || !o.geometries.is_empty();
    model.objects.iter().enumerate().filter(shown).map(|(i, _)| i as u32)
}

/// Names of all attributes of objects, each once.
pub fn attribute_names(model: &CityModel) -> Vec<&str> {
    let mut ids: Vec<_> =
        (0..model.objects.len() as u32).flat_map(|o| model.attributes_of(o)).map(|a| a.name).collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter().map(|id| model.strings.get(id)).collect()
}

fn number_rule(sorted: &[f64], used: &EffectUse) -> Rule {
    let ramp_name = used.text("ramp").unwrap_or("viridis").to_owned();
    let reverse = used.boolean("reverse").unwrap_or(false);
    let low = used.number("min").unwrap_or(sorted[0]);
    let high = used.number("max").unwrap_or(sorted[sorted.len() - 1]).max(low);
    let classes = used.number("classes").unwrap_or(5.0).clamp(2.0, 12.0) as usize;
    let mut breaks: Vec<f64> = match (used.parameters.get("breaks"), used.text("scale")) {
        (Some(Parameter::Numbers(breaks)), _) => breaks.clone(),
        (_, Some("equal")) => (1..classes).map(|i| low + (high - low) * i as f64 / classes as f64).collect(),
        (_, Some("quantile")) => {
            let start = sorted.partition_point(|n| *n < low);
            let inside = &sorted[start..sorted.partition_point(|n| *n <= high).max(start)];
            (1..classes).filter_map(|i| inside.get(i * inside.len() / classes).copied()).collect()
        }
        _ => return Rule::Ramp { ramp: ramp_name, reverse, min: low, max: high },
    };
    breaks.dedup();
    let last = breaks.len().max(1) as f64;
    let colors = (0..=breaks.len())
        .map(|i| i as f64 / last)
        .map(|t| ramp(&ramp_name, if reverse { 1.0 - t } else { t }))
        .collect();
    Rule::Classes { breaks, colors }
}

fn category_rule(given: &[Value], strings: &Strings, wanted: Option<&[String]>) -> Rule {
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
    Rule::Categories {
        colors: names.into_iter().take(MAX_CATEGORIES).enumerate().map(|(i, n)| (n, category(i))).collect(),
    }
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
    use crate::city::{Attribute, CityObject, ObjectClass};

    /// A city of objects without geometry, each with the attribute `a` (or without).
    fn city(values: &[Option<&str>], read: fn(&str, &mut Strings) -> Value) -> CityModel {
        let mut model = CityModel::default();
        let (kind, name) = (model.strings.intern("Building"), model.strings.intern("a"));
        for (i, text) in values.iter().enumerate() {
            let start = model.attributes.len() as u32;
            if let Some(text) = text {
                let value = read(text, &mut model.strings);
                model.attributes.push(Attribute { name, value });
            }
            model.objects.push(CityObject {
                id: format!("o{i}").into(),
                kind,
                class: ObjectClass::Building,
                parents: vec![],
                children: vec![],
                attributes: start..model.attributes.len() as u32,
                geometries: 0..0,
            });
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
    fn numbers_are_short_in_legends() {
        for (n, text) in [(0.0, "0"), (12.34, "12.3"), (1931.0, "1931"), (0.125, "0.125"), (100.0, "100"), (20.0, "20")]
        {
            assert_eq!(short(n), text);
        }
    }
}
