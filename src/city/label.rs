//! What people call an object: a name, an address, an id that can be read, else its type and a number.

use crate::city::model::{CityModel, Value};

/// Attributes whose text is the name of an object, in lower case; the first that it has counts.
pub const NAMES: [&str; 10] =
    ["name", "gml:name", "gml_name", "naam", "nom", "nombre", "nome", "bezeichnung", "building:name", "title"];
/// Attributes that are a street, and a number in it, in lower case.
const STREETS: [&str; 8] =
    ["street", "streetname", "addr:street", "thoroughfare", "thoroughfarename", "straat", "straatnaam", "strasse"];
const NUMBERS: [&str; 7] =
    ["housenumber", "addr:housenumber", "thoroughfarenumber", "number", "huisnummer", "hausnummer", "streetnumber"];
/// An attribute with such fields in it, as CityJSON has it.
const ADDRESS: &str = "address";
/// An id is read by people up to this many characters, and with fewer digits than this.
const READABLE_CHARS: usize = 24;
const MOST_DIGITS: usize = 5;
/// A part of it of so many characters has letters or digits, not both.
const MIXED_CHARS: usize = 6;

/// What people call an object: its name, else its address, else its id where that can be read, else its type and its number among the objects of
/// that type, in the order of the city. Parts are called as what they are part of where they have nothing of their own. Never a part of an id.
pub fn label(model: &CityModel, object: u32) -> String {
    let root = model.root(object);
    let of = |ask: fn(&CityModel, u32) -> Option<String>| ask(model, object).or_else(|| ask(model, root));
    let id = &model.objects[object as usize].id;
    of(name).or_else(|| of(address)).or_else(|| is_readable(id).then(|| id.to_string())).unwrap_or_else(|| {
        let kind = model.objects[root as usize].kind;
        let before = model.objects[..=root as usize].iter().filter(|other| other.kind == kind).count();
        format!("{} {before}", model.strings.get(kind).trim_start_matches('+'))
    })
}

/// Whether an id is a word for people and not for programs.
pub fn is_readable(id: &str) -> bool {
    let digits = id.chars().filter(char::is_ascii_digit).count();
    // Letters and digits in one word, as in hexadecimal numbers.
    let is_mixed = |word: &str| {
        let has = |of: fn(&char) -> bool| word.chars().any(|c| of(&c));
        word.len() >= MIXED_CHARS && has(char::is_ascii_digit) && has(char::is_ascii_alphabetic)
    };
    let has_number = id.split(|c: char| !c.is_alphanumeric()).any(is_mixed);
    let is_plain = !id.contains(['{', '}', '\\', '#']) && id.chars().any(char::is_alphabetic);
    is_plain && !has_number && id.chars().count() <= READABLE_CHARS && digits < MOST_DIGITS
}

fn text(model: &CityModel, object: u32, names: &[&str]) -> Option<String> {
    let own = model.attributes_of(object);
    let found = names.iter().find_map(|name| {
        own.iter().find(|attribute| model.strings.get(attribute.name).eq_ignore_ascii_case(name)).map(|a| a.value)
    })?;
    let text = shown(model, found)?;
    (!text.trim().is_empty()).then(|| text.trim().to_owned())
}

fn name(model: &CityModel, object: u32) -> Option<String> {
    let is_name = |text: &String| text.chars().any(char::is_alphabetic) && *text != *model.objects[object as usize].id;
    text(model, object, &NAMES).filter(is_name)
}

fn address(model: &CityModel, object: u32) -> Option<String> {
    let own = text(model, object, &STREETS).map(|street| (street, text(model, object, &NUMBERS)));
    let (street, number) = own.or_else(|| {
        let whole = text(model, object, &[ADDRESS])?;
        let Ok(value) = serde_json::from_str::<serde_json::Value>(&whole) else { return Some((whole, None)) };
        let table = value.as_array().and_then(|list| list.first()).unwrap_or(&value).as_object()?.clone();
        let field = |names: &[&str]| {
            let found = table.iter().find(|(key, _)| names.contains(&key.to_lowercase().as_str()))?.1;
            found.as_str().map(str::to_owned).or_else(|| found.as_number().map(ToString::to_string))
        };
        Some((field(&STREETS)?, field(&NUMBERS)))
    })?;
    Some(match number {
        Some(number) => format!("{street} {number}"),
        None => street,
    })
}

/// An attribute of an object, or of what it is part of, as text; `None`: there is no such one, or it has no value.
pub fn attribute(model: &CityModel, object: u32, name: &str) -> Option<String> {
    shown(model, model.attribute(object, model.strings.find(name)?)?)
}

fn shown(model: &CityModel, value: Value) -> Option<String> {
    Some(match value {
        Value::Null => return None,
        Value::Boolean(own) => own.to_string(),
        Value::Integer(number) => number.to_string(),
        Value::Number(number) => number.to_string(),
        Value::String(text) | Value::Array(text) | Value::Object(text) => model.strings.get(text).to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::model::{Attribute, CityObject};

    fn add(model: &mut CityModel, id: &str, kind: &str, parents: Vec<u32>, attributes: &[(&str, &str)]) -> u32 {
        let start = model.attributes.len() as u32;
        for (name, text) in attributes {
            let [name, text] = [name, text].map(|text| model.strings.intern(text));
            model.attributes.push(Attribute { name, value: Value::String(text) });
        }
        let kind = model.strings.intern(kind);
        let (class, children, attributes) = (Default::default(), vec![], start..model.attributes.len() as u32);
        model.objects.push(CityObject { id: id.into(), kind, class, parents, children, attributes, geometries: 0..0 });
        model.objects.len() as u32 - 1
    }

    #[test]
    fn names_come_before_addresses_before_ids_before_numbers() {
        let mut model = CityModel::default();
        let long = |i: u32| format!("NL.IMBAG.Pand.050310000003131{i}");
        let named = add(&mut model, &long(0), "Building", vec![], &[("Name", "Oude Kerk"), ("street", "Plein")]);
        let street = [("straatnaam", "Heilige Geestkerkhof"), ("huisnummer", "25")];
        let addressed = add(&mut model, &long(1), "Building", vec![], &street);
        let json = [("address", r#"[{"ThoroughfareName": "Lijnmarkt", "ThoroughfareNumber": 12}]"#)];
        let of_table = add(&mut model, &long(2), "Building", vec![], &json);
        let readable = add(&mut model, "town-hall", "Building", vec![], &[("name", " ")]);
        let tree = add(&mut model, "GUID_8AEB4C1E-0B4C", "+Tree", vec![], &[]);
        let own_id = long(5);
        let none = add(&mut model, &own_id, "Building", vec![], &[("name", &own_id)]);
        let part = add(&mut model, &long(6), "BuildingPart", vec![named], &[]);
        let all = [named, addressed, of_table, readable, tree, none, part].map(|object| label(&model, object));
        assert_eq!(
            all,
            ["Oude Kerk", "Heilige Geestkerkhof 25", "Lijnmarkt 12", "town-hall", "Tree 1", "Building 5", "Oude Kerk"]
        );
    }

    #[test]
    fn ids_for_programs_are_told_from_words() {
        for id in ["GUID_8AEB4C1E", "{10A31B7E-8FC2}", "NL.IMBAG.Pand.0503100000031316", "102081", "DEBY_LOD2_4959457"]
        {
            assert!(!is_readable(id), "{id}");
        }
        for id in ["church", "Block 12", "Rathaus", "west wing"] {
            assert!(is_readable(id), "{id}");
        }
    }
}
