//! Objects chosen by their ids or by an attribute: which of them an effect or a lens means.

use crate::{
    city::{CityModel, Value},
    lens::{
        EffectUse, Parameter,
        nearest::did_you_mean,
        thematic::{ThematicError, attribute_names, category_of, number_of},
    },
};

/// A choice among the objects of a city.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// These objects and their parts; empty: the attribute chooses.
    pub ids: Vec<String>,
    /// Objects that have this attribute; one without it takes its parent's. `None` and no ids: all objects.
    pub attribute: Option<String>,
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
    /// The choice that the parameters of an effect make.
    pub fn of_effect(used: &EffectUse) -> Self {
        let values = match used.parameters.get("values") {
            Some(Parameter::Texts(list)) => Some(list.clone()),
            _ => None,
        };
        Self {
            ids: Vec::new(),
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

/// The objects that a choice means. Without ids and attribute all; with `values` those whose value is one of them, with `min`
/// and `max` those whose number lies between, both included; with neither those that have a value. `except` turns it round,
/// among objects and never for what belongs to none.
pub fn chosen(model: &CityModel, choice: &Choice) -> Result<Chosen, ChoiceError> {
    let count = model.objects.len();
    if !choice.ids.is_empty() {
        let mut objects = vec![choice.except; count];
        for id in &choice.ids {
            let hint = || did_you_mean(id, model.objects.iter().map(|o| &*o.id));
            let mut next = vec![model.find_object(id).ok_or_else(|| ChoiceError::Id(id.clone(), hint()))?];
            while let Some(object) = next.pop() {
                // Each once: parts may be named by several objects.
                if objects[object as usize] == choice.except {
                    objects[object as usize] = !choice.except;
                    next.extend(&model.objects[object as usize].children);
                }
            }
        }
        return Ok(Chosen { without_object: false, objects });
    }
    let Some(name) = &choice.attribute else {
        return Ok(Chosen { without_object: true, objects: vec![true; count] });
    };
    let Some(id) = model.strings.find(name) else {
        let hint = did_you_mean(name, attribute_names(model));
        return Err(ThematicError::UnknownAttribute(name.to_owned(), hint).into());
    };
    let is_meant = |value: Value| {
        let of = |list: &Vec<String>| category_of(value, &model.strings).is_some_and(|c| list.contains(&c));
        let by_value = choice.values.as_ref().is_none_or(of);
        let by_number = (choice.min.is_none() && choice.max.is_none())
            || number_of(value, &model.strings)
                .is_some_and(|n| choice.min.is_none_or(|min| n >= min) && choice.max.is_none_or(|max| n <= max));
        by_value && by_number
    };
    let of =
        |object: u32| model.attribute(object, id).filter(|v| *v != Value::Null).is_some_and(is_meant) != choice.except;
    Ok(Chosen { without_object: false, objects: (0..count as u32).map(of).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::{Attribute, CityObject, ObjectClass},
        lens::Class,
    };

    /// A city of objects without geometry whose attribute `year` is this.
    fn city(years: &[Option<i64>]) -> CityModel {
        let mut model = CityModel::default();
        let (kind, name) = (model.strings.intern("Building"), model.strings.intern("year"));
        for (i, year) in years.iter().enumerate() {
            let start = model.attributes.len() as u32;
            model.attributes.extend(year.map(|y| Attribute { name, value: Value::Integer(y) }));
            let attributes = start..model.attributes.len() as u32;
            model.objects.push(CityObject {
                id: format!("o{i}").into(),
                kind,
                class: ObjectClass::Building,
                parents: vec![],
                children: vec![],
                attributes,
                geometries: 0..0,
            });
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
    fn an_attribute_that_nobody_has_is_named() {
        let found = choose(&[Some(1900)], &[("attribute", Parameter::Text("yaer".into()))]);
        assert!(found.is_err_and(|e| e.to_string().contains("\"yaer\"")));
    }
}
