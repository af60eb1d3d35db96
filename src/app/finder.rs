//! The search among the objects of a city, and its results.

use std::cmp::Ordering;

use crate::{
    city::{CityModel, Value},
    lens::nearest::did_you_mean,
    query::{self, Bound, Expression, Name, Relation},
};

/// Finds at most so many.
const MOST_FOUND: usize = 200;

/// A search, and what it found last.
#[derive(Debug, Default)]
pub struct Finder {
    /// The text to search for: a part of an id, a type or a value, or an expression ([`crate::query`]).
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

/// `name=`, `name>` and the like, as it is being typed: the name and the relation.
fn unfinished(text: &str) -> Option<(&str, Relation)> {
    let name = text.trim_end_matches(['=', '<', '>', '!', ' ']);
    let relation = match text[name.len()..].trim() {
        "<=" => Relation::AtMost,
        ">=" => Relation::AtLeast,
        "<" => Relation::Less,
        ">" => Relation::More,
        "=" => Relation::Equal,
        _ => return None,
    };
    let is_name = !name.is_empty() && !name.contains(['=', '<', '>', '(', ')', '"', '\'']);
    is_name.then_some((name, relation))
}

fn find(text: &str, model: &CityModel, attributes: &[String]) -> Found {
    let typed = text.trim();
    if typed.is_empty() {
        return Found::default();
    }
    if let Some((name, relation)) = unfinished(typed) {
        let has = Expression::Has(Name { text: name.trim_matches('`').to_owned(), column: 1 });
        return found_by(&has, relation, model, attributes);
    }
    match query::parse(typed) {
        // Words alone are looked for everywhere.
        Ok(Expression::Has(_)) => found_anywhere(typed, model, attributes),
        Ok(Expression::Is(name, relation, literal)) => {
            found_by(&Expression::Is(name, relation, literal), relation, model, attributes)
        }
        Ok(expression) => found_by(&expression, Relation::Equal, model, attributes),
        Err(error) if says_relations(typed) => Found { why_none: format!("{error}."), ..Found::default() },
        Err(_) => found_anywhere(typed, model, attributes),
    }
}

/// Whether a text that is no expression was meant to be one.
fn says_relations(text: &str) -> bool {
    text.contains(['=', '<', '>', '`']) || text.contains("..")
}

/// The objects that have a text in their ids, types or values.
fn found_anywhere(text: &str, model: &CityModel, attributes: &[String]) -> Found {
    let text = text.to_lowercase();
    let all = 0..model.objects.len() as u32;
    let objects: Vec<_> = all.filter(|&object| has(model, object, &text)).map(|object| (object, None)).collect();
    let named = attributes.iter().find(|name| name.to_lowercase().contains(&text));
    let why_none = named.map_or_else(
        || "Nothing found.".to_owned(),
        |name| format!("\"{name}\" is an attribute: {name}> finds all that have it, {name}>5 and {name}=5 some."),
    );
    Found::of(objects, why_none)
}

/// The objects that an expression means, wholes in place of their parts, each with its value of the first name; in the order that a relation asks for, the extreme ones
/// first, numbers before texts, equal ones as they come.
fn found_by(expression: &Expression, relation: Relation, model: &CityModel, attributes: &[String]) -> Found {
    let bound = Bound::new(model, expression);
    if let Some(name) = bound.unknown().first() {
        let meant = did_you_mean(&name.text, attributes.iter().map(String::as_str));
        let end = if meant.is_empty() { "." } else { "" };
        let why_none = format!("No object has an attribute \"{}\"{meant}{end}", name.text);
        return Found { why_none, ..Found::default() };
    }
    let meant = bound.objects();
    let parent = |object: &u32| model.objects[*object as usize].parents.first().copied();
    let is_part = |object: u32| std::iter::successors(parent(&object), parent).any(|whole| meant[whole as usize]);
    let names = expression.names();
    let value = |object: u32| {
        let given = names.first().and_then(|name| bound.value(object, name));
        given.map_or_else(String::new, |given| given.written().into_owned())
    };
    let all = (0..model.objects.len() as u32).filter(|&object| meant[object as usize] && !is_part(object));
    let mut objects: Vec<(u32, String)> = all.map(|object| (object, value(object))).collect();
    let towards = |order: Ordering| match relation {
        Relation::Less | Relation::AtMost => order,
        Relation::More | Relation::AtLeast => order.reverse(),
        _ => Ordering::Equal,
    };
    let is_sorted = !matches!(relation, Relation::Equal | Relation::Other | Relation::Contains);
    objects.sort_by(|(_, a), (_, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => towards(a.total_cmp(&b)),
        (Ok(_), Err(_)) if is_sorted => Ordering::Less,
        (Err(_), Ok(_)) if is_sorted => Ordering::Greater,
        _ => towards(a.cmp(b)),
    });
    Found::of(objects.into_iter().map(|(object, value)| (object, Some(value))).collect(), "Nothing found.".to_owned())
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
    use crate::city::test_city::add_building;

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
        for (i, attributes) in objects.into_iter().enumerate() {
            add_building(&mut model, format!("house-{i}"), attributes);
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
            ("height > 5 and built < 1900", vec![3]),
            ("height in 3..7 or function contains chur", vec![0, 3]),
            ("not height and id != house-5", vec![2]),
            ("function = 'church'", vec![0]),
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
            (
                "height > 5 and",
                "column 15: a name is missing here: that of an attribute, \"type\", \"id\" or \"geometry.height\".",
            ),
            ("height > 5 built", "column 12: \"and\" or \"or\" is missing before this."),
            ("height > 5 and hight < 3", "No object has an attribute \"hight\"; did you mean \"height\"?"),
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
