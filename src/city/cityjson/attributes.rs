//! Attribute values, and members that are not read.

use crate::city::{
    build::ModelBuilder,
    json::{self, Json, Kind, Number, Step},
    model::{Attribute, Value},
    warning::WarningCode,
};

/// Reads the value of `attributes` (an object, or null) and appends it to `attributes`.
pub fn read(
    json: &mut Json<'_>,
    builder: &mut ModelBuilder,
    object: &str,
    attributes: &mut Vec<Attribute>,
) -> Step<()> {
    let start = attributes.len();
    match json.peek()? {
        Kind::Object => json.object(|json, key| {
            let name = builder.intern(&key);
            let value = value(json, builder, object)?;
            attributes.push(Attribute { name, value });
            Ok(())
        })?,
        Kind::Null => json.skip()?,
        _ => {
            json.skip()?;
            builder.model.warnings.add(WarningCode::Malformed, object, || {
                format!("object {object}: \"attributes\" is no JSON object; it is ignored")
            });
        }
    }
    drop_repeated(attributes, start, builder, object);
    Ok(())
}

/// Keeps the last of attributes with one name, as other readers do; those from `start` on are one object's.
fn drop_repeated(attributes: &mut Vec<Attribute>, start: usize, builder: &mut ModelBuilder, object: &str) {
    let own = &attributes[start..];
    let has_few = own.len() <= 12;
    if has_few && own.iter().enumerate().all(|(i, a)| own[..i].iter().all(|b| a.name != b.name)) {
        return;
    }
    let mut seen = rustc_hash::FxHashSet::default();
    if own.iter().all(|a| seen.insert(a.name)) {
        return;
    }
    seen.clear();
    let mut kept: Vec<Attribute> = own.iter().rev().filter(|a| seen.insert(a.name)).copied().collect();
    kept.reverse();
    attributes.truncate(start);
    attributes.append(&mut kept);
    builder.model.warnings.add(WarningCode::Malformed, object, || {
        format!("object {object}: an attribute is given twice; the last one counts")
    });
}

/// Reads one value.
pub fn value(json: &mut Json<'_>, builder: &mut ModelBuilder, object: &str) -> Step<Value> {
    Ok(match json.peek()? {
        Kind::Null => {
            json.skip()?;
            Value::Null
        }
        Kind::Boolean => Value::Boolean(json.boolean()?),
        Kind::String => {
            let text = json.string()?;
            Value::String(builder.intern(&text))
        }
        Kind::Number => {
            let mut at = json.clone();
            let number = json.number()?;
            self::number(number, at.raw()?, builder, object)
        }
        kind @ (Kind::Array | Kind::Object) => nested(kind, json.raw()?, builder, object),
    })
}

fn number(number: Number, raw: &[u8], builder: &mut ModelBuilder, object: &str) -> Value {
    match number {
        Number::Integer(i) => return Value::Integer(i),
        Number::Real(r) if r.is_finite() && !is_rounded_integer(r, raw) => return Value::Number(r),
        Number::Real(r) if r.is_nan() => {
            builder.model.warnings.add(WarningCode::Malformed, object, || {
                format!("object {object}: NaN is no JSON; the attribute is read as null")
            });
            return Value::Null;
        }
        Number::Real(_) => {}
    }
    let text = String::from_utf8_lossy(raw);
    builder.model.warnings.add(WarningCode::AttributeRange, object, || {
        format!("object {object}: the number {text:.40} does not fit 64 bits; it is kept as text")
    });
    Value::String(builder.intern(&text))
}

/// Whether `raw` is a whole number without point and exponent that f64 does not hold exactly.
fn is_rounded_integer(value: f64, raw: &[u8]) -> bool {
    raw.iter().all(|b| b.is_ascii_digit() || *b == b'-') && format!("{value:.0}").as_bytes() != raw
}

/// A list or table, as JSON text; checked, because others will parse it again.
fn nested(kind: Kind, raw: &[u8], builder: &mut ModelBuilder, object: &str) -> Value {
    let text = json::compact(raw);
    match serde_json::from_str::<serde_json::Value>(&text) {
        Ok(_) => {
            let text = builder.intern(&text);
            if kind == Kind::Array { Value::Array(text) } else { Value::Object(text) }
        }
        Err(why) => {
            builder.model.warnings.add(WarningCode::AttributeRange, object, || {
                format!("object {object}: a nested attribute is no usable JSON ({why}); it is kept as text")
            });
            Value::String(builder.intern(&text))
        }
    }
}

/// Keeps a member that is not read as JSON text.
pub fn keep_unknown(json: &mut Json<'_>, builder: &mut ModelBuilder, place: String) -> Step<()> {
    let text = json::compact(json.raw()?);
    builder.model.unknown.push((place, text));
    Ok(())
}

/// A list of numbers; whatever else stands in it is NaN; empty for what is no list.
pub fn numbers(json: &mut Json<'_>) -> Step<Vec<f64>> {
    let mut list = Vec::new();
    if json.peek()? != Kind::Array {
        json.skip()?;
        return Ok(list);
    }
    json.array(|json| {
        list.push(match json.peek()? {
            Kind::Number => json.number()?.as_f64(),
            _ => {
                json.skip()?;
                f64::NAN
            }
        });
        Ok(())
    })?;
    Ok(list)
}
