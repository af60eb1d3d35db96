//! When city objects are there: from their attributes.
//!
//! An object is there from the first moment of what one attribute says up to the first moment of what another says, which is not of it:
//! `[from, until)`. What says a year says its first moment, so an object from 1890 until 1950 is there in 1890 and not in 1950. An object
//! without one of both is open at that end; without both it is undated, if it has no parent that is not.

use crate::{
    city::model::{CityModel, StringId, Value},
    time::{Granularity, Interval, Moment},
};

/// Attributes that say since when an object is there, the first first.
pub const FROM_NAMES: &[&str] = &[
    "yearOfConstruction",
    "dateOfConstruction",
    "oorspronkelijkbouwjaar",
    "b3_bouwjaar",
    "bouwjaar",
    "baujahr",
    "constructionYear",
    "construction_year",
    "year_built",
    "yearBuilt",
    "start_date",
    "DATE_APP",
    "validFrom",
    "creationDate",
];

/// Attributes that say until when, the first first.
pub const UNTIL_NAMES: &[&str] = &[
    "yearOfDemolition",
    "dateOfDemolition",
    "sloopjaar",
    "demolitionYear",
    "demolition_year",
    "end_date",
    "validTo",
    "terminationDate",
];

/// What becomes of objects that have no date; terrain, roads, water and land use without one are always there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Undated {
    /// They are always there.
    #[default]
    Show,
    /// They are never there.
    Hide,
    /// They are always there by halves.
    Ghost,
}

impl Undated {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 3] = [("show", Self::Show), ("hide", Self::Hide), ("ghost", Self::Ghost)];
}

/// Which attributes say when objects are there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dating {
    /// Since when; `None`: the first of [`FROM_NAMES`] that the city has.
    pub from: Option<String>,
    /// Until when; `None`: the first of [`UNTIL_NAMES`] that it has.
    pub until: Option<String>,
    /// What becomes of those without.
    pub undated: Undated,
}

/// When an object is there: from its first moment up to its last, which is not of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Lifetime {
    /// `None`: since ever.
    pub begin: Option<Moment>,
    /// `None`: for ever.
    pub end: Option<Moment>,
    /// What counts.
    pub rule: Existence,
}

/// What counts of when an object is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Existence {
    /// Its ends.
    Dated,
    /// It is never there.
    Never,
    /// It is always there by halves.
    Ghost,
}

impl Lifetime {
    /// Always there.
    pub const ALWAYS: Self = Self { begin: None, end: None, rule: Existence::Dated };
    /// Never there.
    pub const NEVER: Self = Self { begin: None, end: None, rule: Existence::Never };
    /// Always there by halves.
    pub const GHOST: Self = Self { begin: None, end: None, rule: Existence::Ghost };

    /// From a moment up to another; what ends when it begins, or before, is never there.
    pub fn of(begin: Option<Moment>, end: Option<Moment>) -> Self {
        let is_empty = begin.zip(end).is_some_and(|(begin, end)| end <= begin);
        Self { begin, end, rule: if is_empty { Existence::Never } else { Existence::Dated } }
    }

    /// Whether its ends count.
    pub fn is_dated(self) -> bool {
        self.rule == Existence::Dated
    }

    /// Whether it is always there by halves.
    pub fn is_ghost(self) -> bool {
        self.rule == Existence::Ghost
    }

    /// Whether it is there at a moment; at none it is.
    pub fn holds(self, at: Option<Moment>) -> bool {
        let Some(at) = at else { return true };
        self.rule != Existence::Never
            && self.begin.is_none_or(|begin| begin <= at)
            && self.end.is_none_or(|end| at < end)
    }

    /// As shaders have it: four words, its first moment and its last.
    pub fn words(self) -> [u32; 4] {
        const EARLIEST: [u32; 2] = [i32::MIN.cast_unsigned(), 0];
        const LATEST: [u32; 2] = [i32::MAX.cast_unsigned(), 0];
        // Nothing else begins in the middle of it.
        const GHOST: [u32; 2] = [i32::MIN.cast_unsigned(), 1];
        let [begin, end] = match self.rule {
            Existence::Never => [LATEST, EARLIEST],
            Existence::Ghost => [GHOST, LATEST],
            Existence::Dated => [self.begin.map_or(EARLIEST, Moment::words), self.end.map_or(LATEST, Moment::words)],
        };
        [begin[0], begin[1], end[0], end[1]]
    }
}

/// When the objects of a city are there, and what was found on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lifetimes {
    /// Of each object.
    pub of: Vec<Lifetime>,
    /// The attributes that say so.
    pub from: Option<String>,
    /// See `from`.
    pub until: Option<String>,
    /// Objects with one date or two, of their own or a parent's.
    pub dated: u64,
    /// Objects without.
    pub undated: u64,
    /// Objects that end when they begin, or before: they are never there.
    pub empty: u64,
    /// Values that are no times: how many, and the first with what would be right.
    pub unreadable: Option<Unreadable>,
    /// How finely the dates say it: as most of them do.
    pub granularity: Option<Granularity>,
    /// The first and the last moment at which something comes or goes.
    pub span: Option<[Moment; 2]>,
}

/// Values that are no times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// How many.
    pub count: u64,
    /// The id of the first object that has one.
    pub object: String,
    /// What is wrong with it.
    pub message: String,
}

/// What registers write for *unknown*.
const UNKNOWN: &[&str] =
    &["unknown", "onbekend", "unbekannt", "inconnu", "n/a", "na", "none", "null", "-", "?", "xxxx"];

/// A time as an attribute has it; `Ok(None)`: it says none.
fn time_of(model: &CityModel, value: Value) -> Result<Option<Interval>, String> {
    match value {
        Value::Null => Ok(None),
        Value::Integer(number) => Interval::of_number(number).map(Some),
        Value::Number(number) if number.fract() == 0.0 && number.abs() < 9.0e18 => {
            Interval::of_number(number as i64).map(Some)
        }
        Value::String(text) => {
            let text = model.strings.get(text).trim();
            if text.is_empty() || UNKNOWN.iter().any(|word| text.eq_ignore_ascii_case(word)) {
                return Ok(None);
            }
            Interval::parse(text).map(Some)
        }
        Value::Boolean(_) | Value::Number(_) | Value::Array(_) | Value::Object(_) => {
            Err("a list, a table, a part of a year or a truth is no time; a year or a date would be right".to_owned())
        }
    }
}

/// What one attribute says of the objects that have it.
struct Dates<'m> {
    model: &'m CityModel,
    name: Option<StringId>,
    unreadable: Option<Unreadable>,
    /// How many dates are as fine, by granularity.
    granularities: [u64; 6],
}

impl<'m> Dates<'m> {
    fn of(model: &'m CityModel, name: Option<StringId>) -> Self {
        Self { model, name, unreadable: None, granularities: [0; 6] }
    }

    /// What it says of each object, of its own or of its nearest parent that says something.
    fn of_objects(&mut self) -> Vec<Option<Interval>> {
        let own: Vec<Option<Interval>> =
            (0..self.model.objects.len() as u32).map(|object| self.of_object(object)).collect();
        let above = |object: usize| {
            let mut at = object;
            // As many steps as there are objects: what is its own parent ends, too.
            for _ in 0..=own.len() {
                match (own[at], self.model.objects[at].parents.first()) {
                    (Some(found), _) => return Some(found),
                    (None, Some(&parent)) => at = parent as usize,
                    (None, None) => return None,
                }
            }
            None
        };
        (0..own.len()).map(above).collect()
    }

    fn of_object(&mut self, object: u32) -> Option<Interval> {
        let name = self.name?;
        let found = self.model.attributes_of(object).iter().find(|attribute| attribute.name == name)?;
        match time_of(self.model, found.value) {
            Ok(found) => {
                self.granularities[found?.granularity as usize] += 1;
                found
            }
            Err(message) => {
                let object = &self.model.objects[object as usize].id;
                let first = || Unreadable { count: 0, object: object.to_string(), message };
                self.unreadable.get_or_insert_with(first).count += 1;
                None
            }
        }
    }
}

impl Lifetimes {
    /// Of all objects of a city.
    ///
    /// # Errors
    /// An attribute that is asked for is not there: what would be right.
    pub fn new(model: &CityModel, dating: &Dating) -> Result<Self, String> {
        let is_there = attributes_of_objects(model);
        let named = |asked: &Option<String>, key: &str, names: &[&str]| match asked {
            Some(name) => match model.strings.find(name).filter(|id| is_there.contains(id)) {
                Some(id) => Ok(Some(id)),
                None => Err(format!("city.{key}: no object has an attribute \"{name}\"")),
            },
            None => {
                let known = names.iter().filter_map(|name| model.strings.find(name));
                Ok(known.into_iter().find(|id| is_there.contains(id)))
            }
        };
        let names = [named(&dating.from, "from", FROM_NAMES)?, named(&dating.until, "until", UNTIL_NAMES)?];
        let mut dates = names.map(|name| Dates::of(model, name));
        let [begins, ends] = dates.each_mut().map(Dates::of_objects);
        let mut out = Self::default();
        [out.from, out.until] = names.map(|name| name.map(|id| model.strings.get(id).to_owned()));
        for ((object, begin), end) in model.objects.iter().zip(begins).zip(ends) {
            let lifetime = match (begin, end) {
                (None, None) => {
                    out.undated += 1;
                    match dating.undated {
                        Undated::Hide if !object.class.is_ground() => Lifetime::NEVER,
                        Undated::Ghost if !object.class.is_ground() => Lifetime::GHOST,
                        _ => Lifetime::ALWAYS,
                    }
                }
                _ => {
                    out.dated += 1;
                    let [begin, end] = [begin, end].map(|interval| interval.and_then(|interval| interval.begin));
                    let lifetime = Lifetime::of(begin, end);
                    out.empty += u64::from(!lifetime.is_dated());
                    lifetime
                }
            };
            for moment in [lifetime.begin, lifetime.end].into_iter().flatten() {
                let [first, last] = out.span.unwrap_or([moment; 2]);
                out.span = Some([first.min(moment), last.max(moment)]);
            }
            out.of.push(lifetime);
        }
        let [from, until] = dates;
        out.unreadable = match (from.unreadable, until.unreadable) {
            (Some(one), Some(other)) => Some(Unreadable { count: one.count + other.count, ..one }),
            (one, other) => one.or(other),
        };
        let counts = from.granularities.iter().zip(until.granularities).map(|(a, b)| a + b);
        let all = [
            Granularity::Year,
            Granularity::Month,
            Granularity::Day,
            Granularity::Minute,
            Granularity::Second,
            Granularity::Micro,
        ];
        let most = all.into_iter().zip(counts).filter(|(_, count)| *count > 0).max_by_key(|(_, count)| *count);
        out.granularity = most.map(|(granularity, _)| granularity);
        Ok(out)
    }

    /// Of a city whose objects are all always there.
    pub fn undated(model: &CityModel) -> Self {
        let count = model.objects.len();
        Self { of: vec![Lifetime::ALWAYS; count], undated: count as u64, ..Self::default() }
    }

    /// Whether some object comes or goes.
    pub fn has_any(&self) -> bool {
        self.of.iter().any(|lifetime| *lifetime != Lifetime::ALWAYS)
    }
}

/// Names of attributes that objects have.
fn attributes_of_objects(model: &CityModel) -> rustc_hash::FxHashSet<StringId> {
    let ranges = model.objects.iter().map(|object| object.attributes.start as usize..object.attributes.end as usize);
    ranges.flat_map(|range| &model.attributes[range]).map(|attribute| attribute.name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{Attribute, CityObject, ObjectClass};

    /// The number of its parent, and its attributes.
    type Bare<'a> = (Option<u32>, &'a [(&'a str, serde_json::Value)]);

    fn city(objects: &[Bare]) -> CityModel {
        let mut model = CityModel::default();
        for (i, (parent, attributes)) in objects.iter().enumerate() {
            let first = model.attributes.len() as u32;
            for (name, value) in *attributes {
                let value = match value {
                    serde_json::Value::Null => Value::Null,
                    serde_json::Value::Number(n) if n.is_i64() => Value::Integer(n.as_i64().expect("whole")),
                    serde_json::Value::Number(n) => Value::Number(n.as_f64().expect("a number")),
                    serde_json::Value::String(text) => Value::String(model.strings.intern(text)),
                    _ => Value::Boolean(true),
                };
                let name = model.strings.intern(name);
                model.attributes.push(Attribute { name, value });
            }
            model.objects.push(CityObject {
                id: format!("o{i}").into(),
                kind: model.strings.intern("Building"),
                class: ObjectClass::Building,
                parents: parent.iter().copied().collect(),
                children: vec![],
                attributes: first..model.attributes.len() as u32,
                geometries: 0..0,
            });
        }
        model
    }

    fn year(year: i64) -> Option<Moment> {
        Moment::of_year(year)
    }

    #[test]
    fn lifetimes_are_half_open_and_inherited() {
        use serde_json::json;
        let model = city(&[
            (None, &[("yearOfConstruction", json!(1890)), ("yearOfDemolition", json!("1950"))]),
            (Some(0), &[]),
            (Some(0), &[("yearOfConstruction", json!(1900))]),
            (None, &[("yearOfConstruction", json!("unknown"))]),
            (None, &[("yearOfDemolition", json!(1700.0))]),
            (None, &[("yearOfConstruction", json!(1890)), ("yearOfDemolition", json!(1890))]),
            (None, &[("yearOfConstruction", json!("189x")), ("yearOfDemolition", json!(null))]),
            (None, &[("yearOfConstruction", json!("soon"))]),
            (None, &[("yearOfConstruction", json!(true))]),
        ]);
        let found = Lifetimes::new(&model, &Dating::default()).expect("lifetimes");
        let there = |y: i64| found.of.iter().map(|lifetime| u8::from(lifetime.holds(year(y)))).collect::<Vec<_>>();
        assert_eq!(there(1699), [0, 0, 0, 1, 1, 0, 0, 1, 1]);
        assert_eq!(there(1700), [0, 0, 0, 1, 0, 0, 0, 1, 1]);
        assert_eq!(there(1890), [1, 1, 0, 1, 0, 0, 1, 1, 1]);
        assert_eq!(there(1949), [1, 1, 1, 1, 0, 0, 1, 1, 1]);
        assert_eq!(there(1950), [0, 0, 0, 1, 0, 0, 1, 1, 1]);
        assert!(found.of.iter().all(|lifetime| lifetime.holds(None)), "at no moment all is there");
        assert_eq!((found.dated, found.undated, found.empty), (6, 3, 1));
        assert_eq!(
            (found.span, found.granularity),
            (year(1700).zip(year(1950)).map(|(a, b)| [a, b]), Some(Granularity::Year))
        );
        let unreadable = found.unreadable.expect("two are no times");
        assert_eq!((unreadable.count, unreadable.object.as_str()), (2, "o7"));
        let hidden = Dating { undated: Undated::Hide, ..Dating::default() };
        let hidden = Lifetimes::new(&model, &hidden).expect("lifetimes");
        assert!(!hidden.of[3].holds(year(1800)) && hidden.of[3].holds(None));
        let other = Dating { from: Some("yearOfDemolition".into()), ..Dating::default() };
        assert_eq!(Lifetimes::new(&model, &other).expect("lifetimes").of[0].begin, year(1950));
        let missing = Dating { until: Some("closed".into()), ..Dating::default() };
        let message = Lifetimes::new(&model, &missing).expect_err("there is none");
        assert_eq!(message, "city.until: no object has an attribute \"closed\"");
    }

    #[test]
    fn shaders_see_the_same_ends() {
        let exact = Lifetime::of(year(1890), None);
        assert_eq!(exact.words()[..2], year(1890).expect("a year").words());
        assert_eq!(exact.words()[2..], [i32::MAX.cast_unsigned(), 0]);
        assert_eq!(Lifetime::NEVER.words(), [i32::MAX.cast_unsigned(), 0, i32::MIN.cast_unsigned(), 0]);
    }
}
