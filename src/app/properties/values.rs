//! Values of TOML as numbers, colours and text.

use toml::{Table as TomlTable, Value};

use crate::lens::Parameter;

/// A number as people write it: no more digits than it has.
pub fn trimmed(number: f64, most: usize) -> String {
    let text = format!("{number:.most$}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// A number of TOML; 0 for what is none.
pub fn number_of(value: &Value) -> f64 {
    value.as_float().or(value.as_integer().map(|n| n as f64)).unwrap_or(0.0)
}

/// A number as TOML, to the sixth digit where it is no whole one.
pub fn number_value(number: f64, is_whole: bool) -> Value {
    if is_whole { Value::Integer(number.round() as i64) } else { Value::Float((number * 1e6).round() / 1e6) }
}

/// Red, green and blue of `#rrggbb`.
pub fn hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([channel(0)?, channel(2)?, channel(4)?])
}

/// A value, of its TOML.
pub fn value_of(text: &str) -> Option<Value> {
    format!("v = {text}")
        .parse::<TomlTable>()
        .ok()
        .filter(|table| table.len() == 1)
        .and_then(|mut table| table.remove("v"))
}

/// The value of a parameter; `None`: it is none.
pub fn parameter_of(value: &Value) -> Option<Parameter> {
    match value {
        Value::Boolean(is) => Some(Parameter::Boolean(*is)),
        Value::Integer(_) | Value::Float(_) => Some(Parameter::Number(number_of(value))),
        Value::String(text) => Some(Parameter::Text(text.clone())),
        Value::Array(list) if list.iter().all(|own| own.is_integer() || own.is_float()) => {
            Some(Parameter::Numbers(list.iter().map(number_of).collect()))
        }
        Value::Array(list) => {
            let texts = list.iter().map(|own| own.as_str().map(str::to_owned));
            texts.collect::<Option<_>>().map(Parameter::Texts)
        }
        Value::Datetime(_) | Value::Table(_) => None,
    }
}

/// The name of a key as people read it.
pub fn title_of(name: &str) -> String {
    match name {
        "poi" => return "Point of interest".to_owned(),
        "fov_deg" => return "Field of view".to_owned(),
        _ => {}
    }
    // The widget shows degrees.
    let mut text = name.trim_end_matches("_deg").replace('_', " ");
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        for (number, text) in
            [(3.0, "3"), (0.42, "0.42"), (1.2345, "1.234"), (-0.0001, "0"), (1200.0, "1200"), (-7.5, "-7.5")]
        {
            assert_eq!(trimmed(number, 3), text);
        }
    }
}
