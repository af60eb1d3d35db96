//! Objects chosen by an attribute: which of them an effect means.

use crate::{
    city::{CityModel, Value},
    lens::{
        EffectUse, Parameter,
        nearest::did_you_mean,
        thematic::{ThematicError, attribute_names, category_of, number_of},
    },
};

/// Which objects a use of an effect means.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Whether it means what belongs to no object: the plain ground.
    pub without_object: bool,
    /// One per object of the city.
    pub objects: Vec<bool>,
}

/// The objects that a use chooses. Without `attribute` all; with `values` those whose value is one of them, with `min` and
/// `max` those whose number lies between, both included; with neither those that have a value. `except` turns it round, among
/// objects and never for what belongs to none. An object without the attribute takes its parent's.
pub fn chosen(model: &CityModel, used: &EffectUse) -> Result<Chosen, ThematicError> {
    let count = model.objects.len();
    let Some(name) = used.text("attribute") else {
        return Ok(Chosen { without_object: true, objects: vec![true; count] });
    };
    let Some(id) = model.strings.find(name) else {
        return Err(ThematicError::UnknownAttribute(name.to_owned(), did_you_mean(name, attribute_names(model))));
    };
    let values = match used.parameters.get("values") {
        Some(Parameter::Texts(list)) => Some(list),
        _ => None,
    };
    let (min, max) = (used.number("min"), used.number("max"));
    let except = used.boolean("except").unwrap_or(false);
    let is_meant = |value: Value| {
        let by_value = values.is_none_or(|list| category_of(value, &model.strings).is_some_and(|c| list.contains(&c)));
        let by_number = (min.is_none() && max.is_none())
            || number_of(value, &model.strings)
                .is_some_and(|n| min.is_none_or(|min| n >= min) && max.is_none_or(|max| n <= max));
        by_value && by_number
    };
    let of = |object: u32| model.attribute(object, id).filter(|v| *v != Value::Null).is_some_and(is_meant) != except;
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

    fn choose(years: &[Option<i64>], parameters: &[(&str, Parameter)]) -> Result<Chosen, ThematicError> {
        let used = EffectUse {
            effect: "eraser".into(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: parameters.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect(),
        };
        chosen(&city(years), &used)
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
