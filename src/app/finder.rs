//! The search among the objects of a city, and its results.

use std::cmp::Ordering;

use crate::{
    city::{CityModel, Value},
    lens::nearest::did_you_mean,
};

/// Finds at most so many.
const MOST_FOUND: usize = 200;

/// A search, and what it found last.
#[derive(Debug, Default)]
pub struct Finder {
    /// The text to search for: a part of an id, a type or a value, or an attribute, a relation and a value.
    pub text: String,
    found: Option<(String, Found)>,
    /// Whether the field is to be written into.
    pub wants_focus: bool,
}

/// The result of a search.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// The first 200 objects, each with the value by which it was found where one attribute was asked for.
    pub objects: Vec<(u32, Option<String>)>,
    /// The number of objects in all.
    pub count: usize,
    /// Why there are none.
    pub why_none: String,
}

impl Finder {
    /// Another city is there.
    pub fn forget(&mut self) {
        self.found = None;
    }

    /// Finds the objects that the text means in a city with these attributes; searches again only when the text is another.
    pub fn find(&mut self, model: &CityModel, attributes: &[String]) -> Found {
        match &self.found {
            Some((text, found)) if *text == self.text => found.clone(),
            _ => {
                let found = find(&self.text, model, attributes);
                self.found = Some((self.text.clone(), found.clone()));
                found
            }
        }
    }
}

/// The relation that a value is to have to the one that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Equal,
    Less,
    AtMost,
    More,
    AtLeast,
}

impl Relation {
    fn holds(self, order: Ordering) -> bool {
        match self {
            Relation::Equal => order.is_eq(),
            Relation::Less => order.is_lt(),
            Relation::AtMost => order.is_le(),
            Relation::More => order.is_gt(),
            Relation::AtLeast => order.is_ge(),
        }
    }
}

/// `name=value`, `name>value` and the like: the name, the relation and the value, without blanks around them.
fn parts(text: &str) -> Option<(&str, Relation, &str)> {
    let at = text.find(['=', '<', '>'])?;
    let (name, rest) = text.split_at(at);
    let (relation, length) = match rest.as_bytes() {
        [b'<', b'=', ..] => (Relation::AtMost, 2),
        [b'>', b'=', ..] => (Relation::AtLeast, 2),
        [b'<', ..] => (Relation::Less, 1),
        [b'>', ..] => (Relation::More, 1),
        _ => (Relation::Equal, 1),
    };
    let name = name.trim();
    (!name.is_empty()).then(|| (name, relation, rest[length..].trim()))
}

/// The order of two values: as numbers where the second is one (what is neither a number nor a day of some year
/// then stands in no order to it), else as texts, so that days have their order.
fn order(value: &str, wanted: &str) -> Option<Ordering> {
    let Ok(number) = wanted.parse::<f64>() else { return Some(value.cmp(wanted)) };
    match value.parse::<f64>() {
        Ok(value) => value.partial_cmp(&number),
        Err(_) => year_of(value)?.partial_cmp(&number),
    }
}

/// The year of a day that is written as `1899-03-01`.
fn year_of(day: &str) -> Option<f64> {
    let (year, _) = day.split_once('-')?;
    (year.len() == 4 && year.bytes().all(|b| b.is_ascii_digit())).then(|| year.parse().ok()).flatten()
}

fn find(text: &str, model: &CityModel, attributes: &[String]) -> Found {
    let typed = text.trim();
    let text = typed.to_lowercase();
    let all = 0..model.objects.len() as u32;
    if text.is_empty() {
        return Found::default();
    }
    let Some((name, relation, wanted)) = parts(&text) else {
        let objects: Vec<_> = all.filter(|&object| has(model, object, &text)).map(|object| (object, None)).collect();
        let named = attributes.iter().find(|name| name.to_lowercase().contains(&text));
        let why_none = named.map_or_else(
            || "Nothing found.".to_owned(),
            |name| format!("\"{name}\" is an attribute: {name}> finds all that have it, {name}>5 and {name}=5 some."),
        );
        return Found::of(objects, why_none);
    };
    let value_of = |object: u32| {
        let attributes = model.attributes_of(object);
        let own = attributes.iter().find(|own| model.strings.get(own.name).to_lowercase() == name)?;
        (own.value != Value::Null).then(|| text_of(own.value, model))
    };
    let fits =
        |value: &str| wanted.is_empty() || order(&value.to_lowercase(), wanted).is_some_and(|o| relation.holds(o));
    let mut objects: Vec<(u32, String)> =
        all.filter_map(|object| Some((object, value_of(object).filter(|value| fits(value))?))).collect();
    // The extreme ones first, numbers before texts; equal ones as they come.
    let towards = |order: Ordering| match relation {
        Relation::Equal => Ordering::Equal,
        Relation::Less | Relation::AtMost => order,
        Relation::More | Relation::AtLeast => order.reverse(),
    };
    objects.sort_by(|(_, a), (_, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => towards(a.total_cmp(&b)),
        (Ok(_), Err(_)) if relation != Relation::Equal => Ordering::Less,
        (Err(_), Ok(_)) if relation != Relation::Equal => Ordering::Greater,
        _ => towards(a.cmp(b)),
    });
    let is_known = attributes.iter().any(|own| own.to_lowercase() == name);
    let why_none = match is_known {
        true => "Nothing found.".to_owned(),
        false => {
            let meant = did_you_mean(name, attributes.iter().map(String::as_str));
            // As it was typed.
            let name = parts(typed).map_or(name, |(name, ..)| name);
            format!("No object has an attribute \"{name}\"{meant}{}", if meant.is_empty() { "." } else { "" })
        }
    };
    Found::of(objects.into_iter().map(|(object, value)| (object, Some(value))).collect(), why_none)
}

impl Found {
    fn of(mut objects: Vec<(u32, Option<String>)>, why_none: String) -> Self {
        let count = objects.len();
        objects.truncate(MOST_FOUND);
        Self { objects, count, why_none: if count == 0 { why_none } else { String::new() } }
    }
}

/// Whether an object's id, type or one of its values has a text in it.
fn has(model: &CityModel, object: u32, wanted: &str) -> bool {
    let own = &model.objects[object as usize];
    own.id.to_lowercase().contains(wanted)
        || model.strings.get(own.kind).to_lowercase().contains(wanted)
        || model.attributes_of(object).iter().any(|own| text_of(own.value, model).to_lowercase().contains(wanted))
}

/// A value as people read it.
pub fn text_of(value: Value, model: &CityModel) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Boolean(is) => is.to_string(),
        Value::Integer(n) => n.to_string(),
        Value::Number(n) => n.to_string(),
        Value::String(s) | Value::Array(s) | Value::Object(s) => model.strings.get(s).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{Attribute, CityObject, ObjectClass};

    /// Six objects: heights 3, 12.5, null, 7, 12.5 and "tall"; two of them with a day when they were built.
    fn city() -> (CityModel, Vec<String>) {
        let mut model = CityModel::default();
        let names = ["height", "function", "built"];
        let [height, function, built] = names.map(|name| model.strings.intern(name));
        let mut text = |text: &str| Value::String(model.strings.intern(text));
        let objects = [
            vec![(height, Value::Integer(3)), (function, text("Church"))],
            vec![(height, Value::Number(12.5))],
            vec![(height, Value::Null)],
            vec![(height, Value::Integer(7)), (built, text("1899-03-01"))],
            vec![(height, Value::Number(12.5)), (built, text("1954-10-20"))],
            vec![(height, text("tall"))],
        ];
        let kind = model.strings.intern("Building");
        for (i, attributes) in objects.into_iter().enumerate() {
            let start = model.attributes.len() as u32;
            model.attributes.extend(attributes.into_iter().map(|(name, value)| Attribute { name, value }));
            model.objects.push(CityObject {
                id: format!("house-{i}").into(),
                kind,
                class: ObjectClass::Building,
                parents: vec![],
                children: vec![],
                attributes: start..model.attributes.len() as u32,
                geometries: 0..0,
            });
        }
        (model, names.map(str::to_owned).to_vec())
    }

    fn ids(text: &str) -> Vec<u32> {
        let (model, attributes) = city();
        let number = |object: u32| model.objects[object as usize].id.trim_start_matches("house-").parse().unwrap();
        find(text, &model, &attributes).objects.iter().map(|(object, _)| number(*object)).collect()
    }

    #[test]
    fn relations_choose_and_sort() {
        for (text, expected) in [
            ("height > 5", vec![1, 4, 3]),
            ("Height>=12.5", vec![1, 4]),
            ("height<12.5", vec![0, 3]),
            ("height <= 7.0", vec![0, 3]),
            ("height=12.50", vec![1, 4]),
            ("height=TALL", vec![5]),
            // As it is being typed: all that have it, the largest first; what is no number last.
            ("height>", vec![1, 4, 3, 0, 5]),
            ("height<", vec![0, 3, 1, 4, 5]),
            ("built<1900", vec![3]),
            ("built=1954", vec![4]),
            ("built>1954", vec![]),
            ("built<1900-01-01", vec![3]),
            ("built>1900-01-01", vec![4]),
            ("function=church", vec![0]),
        ] {
            assert_eq!(ids(text), expected, "{text}");
        }
    }

    #[test]
    fn words_are_found_in_ids_types_and_values() {
        assert_eq!(ids("churc"), [0]);
        assert_eq!(ids("HOUSE-3"), [3]);
        assert_eq!(ids("building").len(), 6);
        assert_eq!(ids("  "), [0; 0]);
    }

    #[test]
    fn values_are_told_and_so_is_why_nothing_is_found() {
        let (model, attributes) = city();
        let mut finder = Finder { text: "height>12".to_owned(), ..Finder::default() };
        let found = finder.find(&model, &attributes);
        assert_eq!((found.count, found.objects[0].1.as_deref()), (2, Some("12.5")));
        assert_eq!(finder.find(&model, &attributes), found, "the same again");
        for (text, why) in [
            ("hieght>3", "No object has an attribute \"hieght\"; did you mean \"height\"?"),
            ("zzz=3", "No object has an attribute \"zzz\"."),
            ("height>99", "Nothing found."),
            ("nowhere", "Nothing found."),
            ("HEIG", "\"height\" is an attribute: height> finds all that have it, height>5 and height=5 some."),
            ("", ""),
        ] {
            finder.text = text.to_owned();
            assert_eq!(
                finder.find(&model, &attributes),
                Found { why_none: why.to_owned(), ..Found::default() },
                "{text}"
            );
        }
    }
}
