//! `extras` of nodes and meshes as attributes.

use gltf::json::extras::RawValue;
use serde_json::Value as Json;

use crate::city::{
    build::ModelBuilder,
    model::{Attribute, Value},
    warning::WarningCode,
};

/// The attributes that `extras` hold: its members, or itself as `extras` where it is no table.
pub(super) fn attributes(builder: &mut ModelBuilder, extras: &RawValue, object: &str) -> Vec<Attribute> {
    let members = match serde_json::from_str::<Json>(extras.get()) {
        Ok(Json::Object(members)) => members.into_iter().collect(),
        Ok(other) => vec![("extras".to_owned(), other)],
        Err(_) => {
            builder.model.warnings.add(WarningCode::AttributeRange, object, || {
                format!("the extras of {object:?} hold a number beyond what f64 holds; they are kept as text")
            });
            vec![("extras".to_owned(), Json::String(extras.get().to_owned()))]
        }
    };
    members
        .into_iter()
        .map(|(name, value)| Attribute { name: builder.intern(&name), value: attribute(builder, &value) })
        .collect()
}

fn attribute(builder: &mut ModelBuilder, value: &Json) -> Value {
    match value {
        Json::Null => Value::Null,
        Json::Bool(b) => Value::Boolean(*b),
        Json::Number(n) => match (n.as_i64(), n.as_f64()) {
            (Some(integer), _) => Value::Integer(integer),
            (None, Some(number)) => Value::Number(number),
            (None, None) => Value::String(builder.intern(&n.to_string())),
        },
        Json::String(text) => Value::String(builder.intern(text)),
        Json::Array(_) => Value::Array(builder.intern(&value.to_string())),
        Json::Object(_) => Value::Object(builder.intern(&value.to_string())),
    }
}
