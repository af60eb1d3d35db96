//! Objects chosen by their ids, their types or an attribute: which of them an effect or a lens means.

use std::collections::BTreeSet;

use rustc_hash::FxHashSet;

use crate::{
    city::{CityModel, StringId, Value},
    lens::{
        effect_use::{EffectUse, Parameter},
        nearest::did_you_mean,
        thematic::{ThematicError, attribute_names, category_of, number_of},
    },
    query::{self, Bound, Expression},
};

/// Values that a message names at most.
const SHOWN_VALUES: usize = 8;

/// A choice among the objects of a city.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// These objects and their parts; empty: the attribute chooses.
    pub ids: Vec<String>,
    /// Objects of these types, as their files call them, and their parts.
    pub types: Vec<String>,
    /// Objects that have this attribute; one without it takes its parent's. `None`, no ids and no types: all objects.
    pub attribute: Option<String>,
    /// Objects of which this expression is true ([`crate::query`]), and their parts.
    pub expression: Option<String>,
    /// Only where the attribute is one of these.
    pub values: Option<Vec<String>>,
    /// Only where it is a number of at least this.
    pub min: Option<f64>,
    /// Only where it is a number of at most this.
    pub max: Option<f64>,
    /// Turns the choice round, among objects.
    pub except: bool,
}

impl Choice {
    /// Whether it names objects, their types, or what is true of them: no attribute chooses.
    fn names(&self) -> bool {
        !(self.ids.is_empty() && self.types.is_empty() && self.expression.is_none())
    }

    /// The key by which it chooses.
    pub fn key(&self) -> &'static str {
        match (self.ids.is_empty(), self.types.is_empty(), &self.expression) {
            (false, ..) => "ids",
            (true, false, _) => "types",
            (true, true, Some(_)) => "where",
            (true, true, None) => "attribute",
        }
    }

    /// The choice that the parameters of an effect make.
    pub fn of_effect(used: &EffectUse) -> Self {
        let values = match used.parameters.get("values") {
            Some(Parameter::Texts(list)) => Some(list.clone()),
            _ => None,
        };
        Self {
            ids: Vec::new(),
            types: Vec::new(),
            expression: None,
            attribute: used.text("attribute").map(str::to_owned),
            values,
            min: used.number("min"),
            max: used.number("max"),
            except: used.boolean("except").unwrap_or(false),
        }
    }
}

/// Which objects of a city a choice means.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Whether it means what belongs to no object: the plain ground.
    pub without_object: bool,
    /// One per object of the city.
    pub objects: Vec<bool>,
}

/// Why nothing can be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChoiceError {
    /// No object of the city has the attribute.
    #[error("{0}")]
    Attribute(#[from] ThematicError),
    /// No object has the id.
    #[error("the city has no object \"{0}\"{1}")]
    Id(String, String),
}

/// The objects that a choice means. Without ids, types and attribute all; with `values` those whose value is one of them, with `min`
/// and `max` those whose number lies between, both included; with neither those that have a value. `except` turns it round,
/// among objects and never for what belongs to none.
pub fn chosen(model: &CityModel, choice: &Choice) -> Result<Chosen, ChoiceError> {
    let hint = |id: &str| did_you_mean(id, model.objects.iter().map(|o| &*o.id));
    if let Some(id) = choice.ids.iter().find(|id| model.find_object(id).is_none()) {
        return Err(ChoiceError::Id(id.clone(), hint(id)));
    }
    if let Some(name) = choice.attribute.as_ref().filter(|name| model.strings.find(name).is_none()) {
        let hint = did_you_mean(name, attribute_names(model));
        return Err(ThematicError::UnknownAttribute(name.to_owned(), hint).into());
    }
    let without_object = !choice.names() && choice.attribute.is_none();
    Ok(Chosen { without_object, objects: members(model, choice) })
}

/// As [`chosen`], one per object of the city; names that the city does not have mean nobody
/// ([`crate::scene::check_against`] says so).
pub fn members(model: &CityModel, choice: &Choice) -> Vec<bool> {
    let count = model.objects.len();
    if choice.names() {
        let mut objects = vec![choice.except; count];
        // In one go over the city, however many are named.
        let named: FxHashSet<&str> = choice.ids.iter().map(String::as_str).collect();
        let kinds: Vec<StringId> = choice.types.iter().filter_map(|name| model.strings.find(name)).collect();
        let is_named = |object: &u32| {
            let own = &model.objects[*object as usize];
            named.contains(&*own.id) || kinds.contains(&own.kind)
        };
        let meant = choice.expression.as_deref().and_then(|text| query::parse(text).ok());
        let meant = meant.map(|expression| Bound::new(model, &expression).objects()).unwrap_or_default();
        let is_meant = |object: &u32| is_named(object) || meant.get(*object as usize) == Some(&true);
        let mut next: Vec<u32> = (0..count as u32).filter(is_meant).collect();
        while let Some(object) = next.pop() {
            // Each once: parts may be named by several objects.
            if objects[object as usize] == choice.except {
                objects[object as usize] = !choice.except;
                next.extend(&model.objects[object as usize].children);
            }
        }
        return objects;
    }
    let Some(name) = &choice.attribute else { return vec![true; count] };
    let id = model.strings.find(name);
    let value = |object| id.and_then(|id| model.attribute(object, id));
    let is_meant = |value: Value| {
        let of = |list: &Vec<String>| category_of(value, &model.strings).is_some_and(|c| list.contains(&c));
        let by_value = choice.values.as_ref().is_none_or(of);
        let by_number = (choice.min.is_none() && choice.max.is_none())
            || number_of(value, &model.strings)
                .is_some_and(|n| choice.min.is_none_or(|min| n >= min) && choice.max.is_none_or(|max| n <= max));
        by_value && by_number
    };
    let of = |object: u32| value(object).filter(|v| *v != Value::Null).is_some_and(is_meant) != choice.except;
    (0..count as u32).map(of).collect()
}

/// What a choice names and the city does not have, and why it means nobody: keys (`ids.1`, `attribute`, ...) and messages.
pub fn absent(model: &CityModel, choice: &Choice) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for (i, id) in choice.ids.iter().enumerate().filter(|(_, id)| model.find_object(id).is_none()) {
        let hint = did_you_mean(id, model.objects.iter().map(|o| &*o.id));
        found.push((format!("ids.{i}"), ChoiceError::Id(id.clone(), hint).to_string()));
    }
    found.extend(absent_types(model, &choice.types).into_iter().map(|(i, message)| (format!("types.{i}"), message)));
    let names = attribute_names(model);
    match choice.expression.as_deref().map(query::parse) {
        Some(Ok(expression)) => {
            found.extend(unknown_names(model, &expression).into_iter().map(|message| ("where".to_owned(), message)));
        }
        Some(Err(error)) => found.push(("where".into(), error.to_string())),
        None => {}
    }
    if let Some(name) = choice.attribute.as_deref().filter(|name| !names.contains(name)) {
        let hint = did_you_mean(name, names);
        found.push(("attribute".into(), format!("no object of the city has the attribute \"{name}\"{hint}")));
    }
    if found.is_empty() && !members(model, choice).contains(&true) {
        found.push(nobody(model, choice));
    }
    found
}

/// Messages about names of an expression that no object of the city has, with their columns.
pub fn unknown_names(model: &CityModel, expression: &Expression) -> Vec<String> {
    let bound = Bound::new(model, expression);
    let told = bound.unknown().into_iter().map(|name| {
        let hint = did_you_mean(&name.text, attribute_names(model));
        format!("column {}: no object of the city has the attribute \"{}\"{hint}", name.column, name.text)
    });
    told.collect()
}

/// Types that no object of the city has: their places, and messages.
pub fn absent_types(model: &CityModel, types: &[String]) -> Vec<(usize, String)> {
    let known: BTreeSet<&str> = model.objects.iter().map(|o| model.strings.get(o.kind)).collect();
    let absent = types.iter().enumerate().filter(|(_, name)| !known.contains(name.as_str()));
    let told = absent.map(|(i, name)| {
        let hint = did_you_mean(name, known.iter().copied());
        (i, format!("no object of the city is of the type \"{name}\"{hint}"))
    });
    told.collect()
}

/// Why a choice of known names means nobody, and what would mean somebody.
fn nobody(model: &CityModel, choice: &Choice) -> (String, String) {
    if choice.expression.is_some() && !choice.except {
        return ("where".into(), "is true of no object of the city".into());
    }
    let Some(name) = &choice.attribute else {
        return ("except".into(), "no object is left: all of the city are named".into());
    };
    let id = model.strings.find(name);
    let all = (0..model.objects.len() as u32).filter_map(|object| id.and_then(|id| model.attribute(object, id)));
    let limit = choice.min.map(|_| "min").or(choice.max.map(|_| "max"));
    match (&choice.values, limit) {
        _ if choice.except => ("except".into(), format!("no object is left: all have such a \"{name}\"")),
        (Some(values), _) => {
            let known: BTreeSet<String> = all.filter_map(|value| category_of(value, &model.strings)).collect();
            let hint = values.first().map_or_else(String::new, |v| did_you_mean(v, known.iter().map(String::as_str)));
            let some: Vec<String> = known.iter().take(SHOWN_VALUES).map(|v| format!("\"{v}\"")).collect();
            let more = if known.len() > some.len() { ", …" } else { "" };
            ("values".into(), format!("no object has such a \"{name}\"; there are {}{more}{hint}", some.join(", ")))
        }
        (None, Some(limit)) => {
            let numbers = all.filter_map(|value| number_of(value, &model.strings));
            let [low, high] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], n| [l.min(n), h.max(n)]);
            let range = if low <= high { format!("; it is {low} to {high}") } else { "; it is no number".into() };
            (limit.into(), format!("no object has such a \"{name}\"{range}"))
        }
        (None, None) => ("attribute".into(), format!("no object of the city has a \"{name}\" that is not empty")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{city::test_city::add_building, lens::class::Class};

    /// A city of objects without geometry whose attribute `year` is this.
    fn city(years: &[Option<i64>]) -> CityModel {
        let mut model = CityModel::default();
        let name = model.strings.intern("year");
        for (i, year) in years.iter().enumerate() {
            add_building(&mut model, format!("o{i}"), year.map(|y| (name, Value::Integer(y))));
        }
        model
    }

    fn choose(years: &[Option<i64>], parameters: &[(&str, Parameter)]) -> Result<Chosen, ChoiceError> {
        let used = EffectUse {
            effect: "eraser".into(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect(),
        };
        chosen(&city(years), &Choice::of_effect(&used))
    }

    #[test]
    fn an_expression_chooses_with_parts() {
        let mut model = city(&[Some(1900), Some(1950), None, Some(2001), None]);
        // The last is a part of the first.
        model.objects[0].children = vec![4];
        model.objects[4].parents = vec![0];
        let choice = |text: &str, except| Choice { expression: Some(text.into()), except, ..Choice::default() };
        for (text, except, expected) in [
            ("year < 1951", false, [true, true, false, false, true]),
            ("year < 1951", true, [false, false, true, true, false]),
            ("year in 1950..1999 or id = o3", false, [false, true, false, true, false]),
            ("id = o0", false, [true, false, false, false, true]),
            ("not year", false, [false, false, true, false, false]),
        ] {
            assert_eq!(members(&model, &choice(text, except)), expected, "{text} {except}");
            assert_eq!(absent(&model, &choice(text, except)), [], "{text}");
        }
        for (text, message) in [
            (
                "year > 1900 and yaer < 3",
                "column 17: no object of the city has the attribute \"yaer\"; did you mean \"year\"?",
            ),
            ("year > 3000", "is true of no object of the city"),
            ("year >", "column 7: a value is missing here: a number, a date or a \"text\""),
        ] {
            assert_eq!(absent(&model, &choice(text, false)), [("where".to_owned(), message.to_owned())], "{text}");
        }
    }

    #[test]
    fn an_attribute_chooses() {
        let years = [Some(1900), Some(1950), None, Some(2001)];
        assert_eq!(choose(&years, &[]), Ok(Chosen { without_object: true, objects: vec![true; 4] }));
        let (number, yes) = (Parameter::Number, Parameter::Boolean(true));
        let texts = |list: &[&str]| Parameter::Texts(list.iter().map(|t| (*t).to_owned()).collect());
        for (more, expected) in [
            (vec![], [true, true, false, true]),
            (vec![("min", number(1950.0))], [false, true, false, true]),
            (vec![("max", number(1950.0))], [true, true, false, false]),
            (vec![("min", number(1950.0)), ("max", number(1999.0))], [false, true, false, false]),
            (vec![("max", number(1950.0)), ("except", yes.clone())], [false, false, true, true]),
            (vec![("values", texts(&["1900", "2001"]))], [true, false, false, true]),
            (vec![("values", texts(&["1900"])), ("except", yes)], [false, true, true, true]),
        ] {
            let mut parameters = vec![("attribute", Parameter::Text("year".into()))];
            parameters.extend(more);
            let found = choose(&years, &parameters);
            assert_eq!(found, Ok(Chosen { without_object: false, objects: expected.to_vec() }), "{parameters:?}");
        }
    }

    #[test]
    fn types_choose_with_parts_and_never_what_belongs_to_none() {
        let mut model = city(&[None, None, None]);
        let part = model.strings.intern("BuildingPart");
        let road = model.strings.intern("Road");
        (model.objects[1].kind, model.objects[2].kind) = (part, road);
        model.objects[0].children = vec![1];
        model.objects[1].parents = vec![0];
        let of = |types: &[&str], except: bool| {
            let types = types.iter().map(|name| (*name).to_owned()).collect();
            chosen(&model, &Choice { types, except, ..Choice::default() }).unwrap()
        };
        for (types, except, expected) in [
            (&["Building"][..], false, [true, true, false]),
            (&["BuildingPart"], false, [false, true, false]),
            (&["Road", "Bridge"], false, [false, false, true]),
            (&["Building"], true, [false, false, true]),
        ] {
            let expected = Chosen { without_object: false, objects: expected.to_vec() };
            assert_eq!(of(types, except), expected, "{types:?} {except}");
        }
        let wrong = Choice { types: vec!["Building".into(), "building".into()], ..Choice::default() };
        let told = absent(&model, &wrong);
        assert_eq!(told.len(), 1);
        assert!(told[0].0 == "types.1" && told[0].1.contains("did you mean \"Building\"?"), "{told:?}");
    }

    #[test]
    fn an_attribute_that_nobody_has_is_named() {
        let found = choose(&[Some(1900)], &[("attribute", Parameter::Text("yaer".into()))]);
        assert!(found.is_err_and(|e| e.to_string().contains("\"yaer\"")));
    }
}
