//! Attributes of an object in two states of a city.

use rustc_hash::FxHashMap;

use crate::city::model::{Attribute, CityModel, StringId, Value};

/// An attribute whose value differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeChange<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its value in the earlier state, with the strings of that city; null where there is none.
    pub before: Value,
    /// Its value in the later state, with the strings of that city; null where there is none.
    pub after: Value,
}

/// Two cities, and what strings of the later one are in the earlier one.
pub(super) struct Texts<'a> {
    before: &'a CityModel,
    after: &'a CityModel,
    in_before: Vec<Option<StringId>>,
}

impl<'a> Texts<'a> {
    /// Looks up every string of the later city once.
    pub fn new(before: &'a CityModel, after: &'a CityModel) -> Self {
        Self { before, after, in_before: after.strings.iter().map(|text| before.strings.find(text)).collect() }
    }

    /// Whether a string of each is the same text.
    pub fn are_same(&self, before: StringId, after: StringId) -> bool {
        self.in_before.get(after.0 as usize).copied().flatten() == Some(before)
    }

    /// Hands over each attribute of two objects that differs: first by the order of the earlier one, then what is new.
    pub fn each_change(&self, before: u32, after: u32, change: &mut dyn FnMut(AttributeChange<'a>)) {
        let olds = self.before.attributes_of(before);
        let news = self.after.attributes_of(after);
        // What became of objects is nothing that they are.
        let is_known = |name: StringId, model: &CityModel| !model.changes.contains(&name);
        let mut index = Index { texts: self, news, by_name: None };
        let mut is_met = vec![false; news.len()];
        let mut is_first = FirstOf::default();
        let olds = olds.iter().enumerate().filter(|(_, old)| is_known(old.name, self.before));
        for (number, old) in olds.filter(|(_, old)| is_first.meets(old.name)) {
            let at = index.find(old.name, number);
            at.iter().for_each(|at| is_met[*at] = true);
            let value = at.map_or(Value::Null, |at| news[at].value);
            if !self.are_equal(old.value, value) {
                change(AttributeChange { name: self.before.strings.get(old.name), before: old.value, after: value });
            }
        }
        if is_met.iter().all(|is_met| *is_met) {
            return;
        }
        let mut is_first = FirstOf::default();
        for (new, is_met) in news.iter().zip(is_met) {
            if is_first.meets(new.name) && !is_met && new.value != Value::Null && is_known(new.name, self.after) {
                let name = self.after.strings.get(new.name);
                change(AttributeChange { name, before: Value::Null, after: new.value });
            }
        }
    }

    /// Whether two values are the same: numbers by what they count, lists and tables by what they hold.
    fn are_equal(&self, before: Value, after: Value) -> bool {
        match (before, after) {
            (Value::Null, Value::Null) => true,
            (Value::Boolean(a), Value::Boolean(b)) => a == b,
            (Value::Integer(a), Value::Integer(b)) => a == b,
            (Value::Number(a), Value::Number(b)) => a == b,
            (Value::Integer(whole), Value::Number(number)) | (Value::Number(number), Value::Integer(whole)) => {
                is_whole(number, whole)
            }
            (Value::String(a), Value::String(b)) => self.are_same(a, b),
            (Value::Array(a), Value::Array(b)) | (Value::Object(a), Value::Object(b)) => {
                self.are_same(a, b) || are_equal_json(self.before.strings.get(a), self.after.strings.get(b))
            }
            _ => false,
        }
    }
}

/// Tells the first attribute of a name from those that repeat it.
#[derive(Default)]
struct FirstOf {
    few: Vec<StringId>,
    many: rustc_hash::FxHashSet<StringId>,
}

impl FirstOf {
    /// Whether the name is new. Up to some number looking through all is faster than a table.
    fn meets(&mut self, name: StringId) -> bool {
        const FEW: usize = 24;
        if self.few.contains(&name) {
            return false;
        }
        if self.few.len() < FEW {
            self.few.push(name);
            return true;
        }
        self.many.insert(name)
    }
}

/// Finds attributes of an object of the later city by names of the earlier one.
struct Index<'a, 'b> {
    texts: &'b Texts<'a>,
    news: &'a [Attribute],
    /// Made when one is not where it is in the other object.
    by_name: Option<FxHashMap<StringId, usize>>,
}

impl Index<'_, '_> {
    fn find(&mut self, name: StringId, guess: usize) -> Option<usize> {
        let Self { texts, news, by_name } = self;
        if by_name.is_none() && news.get(guess).is_some_and(|new| texts.are_same(name, new.name)) {
            return Some(guess);
        }
        let by_name = by_name.get_or_insert_with(|| {
            let known = |(at, new): (usize, &Attribute)| Some((texts.in_before[new.name.0 as usize]?, at));
            // Of equal names the first.
            news.iter().enumerate().rev().filter_map(known).collect()
        });
        by_name.get(&name).copied()
    }
}

/// Whether a number counts as much as a whole one, also beyond 2⁵³, where not every whole number is a double.
fn is_whole(number: f64, whole: i64) -> bool {
    number.fract() == 0.0 && number.abs() < 1e19 && number as i128 == i128::from(whole)
}

fn are_equal_json(a: &str, b: &str) -> bool {
    match (serde_json::from_str(a), serde_json::from_str(b)) {
        (Ok(a), Ok(b)) => are_same_json(&a, &b),
        _ => a == b,
    }
}

fn are_same_json(a: &serde_json::Value, b: &serde_json::Value) -> bool {
    use serde_json::Value::{Array, Number, Object};
    match (a, b) {
        (Number(a), Number(b)) => a == b || (a.is_f64() || b.is_f64()) && a.as_f64() == b.as_f64(),
        (Array(a), Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| are_same_json(a, b)),
        (Object(a), Object(b)) => {
            a.len() == b.len()
                && a.iter().all(|(name, value)| b.get(name).is_some_and(|other| are_same_json(value, other)))
        }
        _ => a == b,
    }
}
