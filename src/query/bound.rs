//! Expressions over the objects of a city.

use std::borrow::Cow;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    city::{CityModel, StringId, Value},
    query::{Expression, Given, Name},
};

/// Where a value of an object comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Source {
    /// Attributes of this name: as it is written, or in other letters.
    Attributes(Vec<StringId>),
    Id,
    Type,
    Height,
    /// No object has it.
    Nobody,
}

/// An expression whose names are found in a city.
#[derive(Debug)]
pub struct Bound<'a> {
    model: &'a CityModel,
    expression: &'a Expression,
    sources: FxHashMap<&'a str, Source>,
}

impl<'a> Bound<'a> {
    /// The expression over a city.
    pub fn new(model: &'a CityModel, expression: &'a Expression) -> Self {
        let has = |id: &StringId| model.attributes.par_iter().any(|attribute| attribute.name == *id);
        let source = |name: &'a Name| {
            let lower = name.text.to_lowercase();
            let found = match model.strings.find(&name.text).filter(has) {
                Some(id) => vec![id],
                None => named_like(model, &lower),
            };
            let own = match lower.as_str() {
                _ if !found.is_empty() => Source::Attributes(found),
                "id" => Source::Id,
                "type" => Source::Type,
                "geometry.height" => Source::Height,
                _ => Source::Nobody,
            };
            (name.text.as_str(), own)
        };
        Self { model, expression, sources: expression.names().into_iter().map(source).collect() }
    }

    /// The names in it that no object has, in their order.
    pub fn unknown(&self) -> Vec<&'a Name> {
        let is_unknown = |name: &&Name| self.sources.get(name.text.as_str()) == Some(&Source::Nobody);
        self.expression.names().into_iter().filter(is_unknown).collect()
    }

    /// What an object has of a name in it.
    pub fn value(&self, object: u32, name: &Name) -> Option<Given<'a>> {
        let (model, own) = (self.model, self.model.objects.get(object as usize)?);
        match self.sources.get(name.text.as_str())? {
            Source::Attributes(ids) => ids.iter().find_map(|id| given(model, model.attribute(object, *id)?)),
            Source::Id => Some(Given::Text(Cow::Borrowed(&own.id))),
            Source::Type => Some(Given::Text(Cow::Borrowed(model.strings.get(own.kind)))),
            Source::Height => {
                let bounds = model.family_bounds(object);
                (!bounds.is_empty()).then(|| Given::Number(bounds.size().z))
            }
            Source::Nobody => None,
        }
    }

    /// Whether an object is meant.
    pub fn means(&self, object: u32) -> bool {
        self.expression.holds(&|name| self.value(object, name))
    }

    /// One per object of the city, whether it is meant.
    pub fn objects(&self) -> Vec<bool> {
        (0..self.model.objects.len() as u32).into_par_iter().map(|object| self.means(object)).collect()
    }
}

/// The attributes that are called so, in whatever letters; lower case.
fn named_like(model: &CityModel, lower: &str) -> Vec<StringId> {
    let names: FxHashSet<StringId> = model.attributes.iter().map(|attribute| attribute.name).collect();
    let mut found: Vec<StringId> =
        names.into_iter().filter(|id| model.strings.get(*id).to_lowercase() == lower).collect();
    found.sort_unstable();
    found
}

fn given(model: &CityModel, value: Value) -> Option<Given<'_>> {
    Some(match value {
        Value::Null => return None,
        Value::Boolean(truth) => Given::Truth(truth),
        Value::Integer(number) => Given::Number(number as f64),
        Value::Number(number) => Given::Number(number),
        Value::String(id) | Value::Array(id) | Value::Object(id) => Given::Text(Cow::Borrowed(model.strings.get(id))),
    })
}
